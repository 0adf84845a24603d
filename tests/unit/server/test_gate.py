# SPDX-License-Identifier: BSD-3-Clause
import json

import pytest

from unitylink.errors import AccessRefused, LeaseHeld, UnknownName
from unitylink.server.audit import Audit
from unitylink.server.gate import LEASE_S, Gate, Now
from unitylink.server.scopes import Rights
from unitylink.server.tokens import Tokens, User, digest
from unitylink.spec import compile_text

ROBOT = """
public arm() { j1: joint() @ (0x10, 0x11, 0x12); j2: joint() @ (0x20, 0x21, 0x22); }
joint(): @ (target, limit, angle) { @target: WRITE(); @limit: READWRITE(); @angle: READ(); }
"""
USERS = {
    "ana": ["read", "write"],
    "ben": ["write j1.target"],
    "cem": ["read"],
    "root": ["admin"],
}
START = Now(10.0, 1e9)


@pytest.fixture
def robot():
    log = []
    entries = [(digest(name), User(name, Rights.of(texts))) for name, texts in USERS.items()]
    entries.append((digest("day"), User("day", Rights.of(["write"]), expires_s=START.wall_s + 5)))
    gate = Gate("arm", compile_text(ROBOT, "arm.ul").spec.root(), Tokens(entries), Audit(log.append))
    gate.log = log
    return gate


def enter(gate, name, now=START):
    return gate.login(name, "127.0.0.1:1", now)


def events(gate):
    return [json.loads(line)["event"] for line in gate.log]


def later(seconds):
    return Now(START.steady_s + seconds, START.wall_s + seconds)


def test_after_a_stop_nobody_writes_before_it_is_armed(robot):
    ana, cem, root = enter(robot, "ana"), enter(robot, "cem"), enter(robot, "root")
    robot.take(ana, "j1", 60.0, START)
    robot.stopped(cem, START)  # who may only read may stop
    for part in robot.unsafe():
        robot.made_safe(part, START)
    for client in (ana, root):
        with pytest.raises(AccessRefused, match="cem has stopped the robot"):
            robot.check_write(client, "j1.target", START)
        with pytest.raises(AccessRefused, match="cem has stopped the robot"):
            robot.take(client, "j2", 1.0, START)
    with pytest.raises(AccessRefused, match="ana may not arm"):
        robot.armed(ana, START)
    robot.armed(root, START)
    robot.check_write(ana, "j1.target", START)
    assert events(robot)[-2:] == ["arm", "lease"]


def test_an_unknown_token_is_refused_and_told(robot):
    with pytest.raises(AccessRefused, match="arm: the server does not know this token"):
        enter(robot, "a-wrong-token")
    assert events(robot) == ["refused"]
    assert "wrong" not in robot.log[0]


def test_a_storm_of_wrong_tokens_is_counted_but_fills_no_disk(robot):
    for _ in range(1000):
        with pytest.raises(AccessRefused):
            enter(robot, "a-wrong-token")
    assert robot.refused == 1000
    assert len(robot.log) == 20
    assert enter(robot, "ana").name == "ana"


def test_a_write_takes_a_lease_of_the_part_below_the_root(robot):
    ana, ben = enter(robot, "ana"), enter(robot, "ben")
    robot.check_write(ana, "j1.target", START)
    assert [lease.part for lease in robot.leases.of(ana.number)] == ["j1"]
    with pytest.raises(LeaseHeld, match="ana holds the write lease of j1"):
        robot.check_write(ben, "j1.target", START)


def test_a_small_scope_takes_a_small_lease(robot):
    ana, ben = enter(robot, "ana"), enter(robot, "ben")
    robot.check_write(ben, "j1.target", START)
    with pytest.raises(LeaseHeld):
        robot.check_write(ana, "j1.limit", START)  # ana's would be all of j1
    robot.take(ana, "j1.limit", 1.0, START)
    robot.check_write(ana, "j1.limit", START)


@pytest.mark.parametrize("path", ["j1.limit", "j2.target"])
def test_nobody_writes_without_the_scope(robot, path):
    ben = enter(robot, "ben")
    with pytest.raises(AccessRefused, match=rf"{path}: ben may not write it; .* `write {path}\.\*`"):
        robot.check_write(ben, path, START)


def test_nobody_reads_without_the_scope(robot):
    ben = enter(robot, "ben")
    robot.check_read(ben, "j1.target", START)
    with pytest.raises(AccessRefused):
        robot.check_read(ben, "j1.angle", START)


def test_after_a_logout_the_part_is_free_and_safe_needs_nothing(robot):
    ana, ben = enter(robot, "ana"), enter(robot, "ben")
    robot.check_write(ana, "j1.target", START)
    robot.logout(ana, START)
    assert robot.unsafe() == ()
    robot.check_write(ben, "j1.target", START)


def test_after_a_loss_the_part_is_made_safe_first(robot):
    ana, ben = enter(robot, "ana"), enter(robot, "ben")
    robot.check_write(ana, "j1.target", START)
    robot.gone(ana, START)
    assert robot.unsafe() == ("j1",)
    with pytest.raises(LeaseHeld, match="is being made safe"):
        robot.check_write(ben, "j1.target", START)
    robot.made_safe("j1", START)
    robot.check_write(ben, "j1.target", START)
    assert events(robot) == ["login", "login", "lease", "lost", "logout", "safe", "lease"]


def test_a_silent_holder_loses_its_lease(robot):
    ana = enter(robot, "ana")
    robot.check_write(ana, "j1.target", START)
    robot.renew(ana, later(LEASE_S * 0.9))
    robot.expire(later(LEASE_S * 1.8))
    assert robot.unsafe() == ()
    robot.expire(later(LEASE_S * 1.9))
    robot.expire(later(LEASE_S * 2))
    assert robot.unsafe() == ("j1",)
    assert events(robot).count("lost") == 1
    with pytest.raises(LeaseHeld):  # even the holder waits until its outputs are safe
        robot.check_write(ana, "j1.target", later(LEASE_S * 2))


def test_an_expired_token_ends_what_is_open(robot):
    day = enter(robot, "day")
    robot.take(day, "*", 60.0, START)
    assert robot.expire(later(4.9)) == ()
    with pytest.raises(AccessRefused, match="has expired"):
        robot.check_write(day, "j1.target", later(5))
    assert robot.unsafe() == ("",)
    assert robot.clients() == ()


def test_a_client_that_is_gone_can_do_nothing(robot):
    ana = enter(robot, "ana")
    robot.logout(ana, START)
    with pytest.raises(AccessRefused, match="not logged in any more"):
        robot.check_read(ana, "j1.angle", START)


def test_only_an_administrator_breaks_a_lease(robot):
    ana, root = enter(robot, "ana"), enter(robot, "root")
    robot.take(ana, "j1", 60.0, START)
    with pytest.raises(AccessRefused, match="needs the scope `admin`"):
        robot.break_up(ana, "j1", START)
    robot.break_up(root, "j1.target", START)
    assert robot.unsafe() == ("j1",)


def test_who_may_only_read_may_stop_but_not_arm(robot):
    ana, cem = enter(robot, "ana"), enter(robot, "cem")
    robot.check_write(ana, "j2.target", START)
    robot.stopped(cem, START)
    assert robot.unsafe() == ("j2",)
    with pytest.raises(AccessRefused, match="needs the scope `arm`"):
        robot.check_arm(cem, START)


def test_a_lease_is_handed_only_to_who_may_write(robot):
    ana, cem, root = enter(robot, "ana"), enter(robot, "cem"), enter(robot, "root")
    robot.take(ana, "j1", 60.0, START)
    with pytest.raises(AccessRefused):
        robot.hand_over(ana, "j1", cem, START)
    robot.hand_over(ana, "j1", root, START)
    robot.check_write(root, "j1.target", START)
    assert robot.unsafe() == ()


def test_a_part_that_the_robot_lacks(robot):
    ana = enter(robot, "ana")
    with pytest.raises(UnknownName, match="did you mean j1"):
        robot.take(ana, "j11", 1.0, START)
