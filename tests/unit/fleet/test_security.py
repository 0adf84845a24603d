# SPDX-License-Identifier: BSD-3-Clause
"""The files for an encrypted network, tried with a real router: who is not named in them does nothing."""

from __future__ import annotations

import json
import re
import socket
import subprocess
import time
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
import zenoh

from unitylink.errors import FleetError, LinkNotFound
from unitylink.fleet.description import Fleet
from unitylink.fleet.reader import parse_fleet
from unitylink.fleet.security import SCRIPT, security_files
from unitylink.zenoh.session import Network

TEXT = """
[fleet]
name = "lab"
router = "tls/127.0.0.1:PORT"
security = "secrets"
spec = "arm.ul"
[[robot]]
name = "a"
link = "tcp://10.0.0.1:5555"
writers = ["ana"]
readers = ["ben"]
[[robot]]
name = "b"
link = "tcp://10.0.0.2:5555"
writers = ["cleo"]
"""


def described(folder: Path, text: str = TEXT) -> Fleet:
    with socket.create_server(("127.0.0.1", 0)) as one:
        port = one.getsockname()[1]
    (folder / "arm.ul").write_text("public arm() { @x = 0x10: READ(); }\n")
    return parse_fleet(text.replace("PORT", str(port)), folder / "fleet.toml")


@dataclass
class Lab:
    """The router, and robot `a` as a bare session that notes what reaches it."""

    fleet: Fleet
    stack: ExitStack
    reached: list[str]

    def session(self, who: str) -> Any:
        return self.stack.enter_context(self.fleet.network(who).opened())

    def answered(self, session: Any, key: str) -> list[str]:
        found = session.get(
            key,
            payload=b"{}",
            timeout=2.0,
            target=zenoh.QueryTarget.ALL,
            consolidation=zenoh.ConsolidationMode.NONE,
        )
        return [one.ok.payload.to_string() for one in found if one.ok is not None]


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Lab]:
    folder = tmp_path_factory.mktemp("security")
    fleet = described(folder)
    (folder / "secrets").mkdir()
    for name, text in security_files(fleet, str(folder / "secrets")).items():
        (folder / "secrets" / name).write_text(text)
    subprocess.run(["sh", folder / "secrets" / SCRIPT], check=True, capture_output=True)
    with ExitStack() as stack:
        stack.enter_context(fleet.router_network().opened())
        lab = Lab(fleet, stack, [])
        robot = lab.session("robot-a")
        for what in ("hello", "hello_read", "state", "value/j1", "stop"):
            key = f"lab/a/{what}"
            stack.callback(
                robot.declare_queryable(key, lambda query, key=key: query.reply(key, "robot-a")).undeclare
            )
        for key in ("lab/a/set/**", "lab/a/stop"):
            heard = robot.declare_subscriber(key, lambda sample: lab.reached.append(str(sample.key_expr)))
            stack.callback(heard.undeclare)
        stack.callback(robot.liveliness().declare_token("lab/a/board/1").undeclare)
        time.sleep(0.2)
        yield lab


def test_who_may_write_reaches_all_of_the_robot(lab: Lab) -> None:
    ana = lab.session("ana")
    assert lab.answered(ana, "lab/a/hello") == lab.answered(ana, "lab/a/state") == ["robot-a"]
    ana.put("lab/a/set/j1", b"1")
    limit_s = time.monotonic() + 5
    while "lab/a/set/j1" not in lab.reached and time.monotonic() < limit_s:
        time.sleep(0.01)
    assert "lab/a/set/j1" in lab.reached
    assert [str(one.ok.key_expr) for one in ana.liveliness().get("lab/a/board/*", timeout=2.0)] == [
        "lab/a/board/1"
    ]


def test_who_may_read_gets_no_right_to_write_and_may_stop(lab: Lab) -> None:
    ben = lab.session("ben")
    assert lab.answered(ben, "lab/a/hello") == []
    for key in ("hello_read", "state", "value/j1"):
        assert lab.answered(ben, f"lab/a/{key}") == ["robot-a"], key
    lab.reached.clear()
    ben.put("lab/a/set/ben", b"1")
    ben.put("lab/a/stop", b"")
    limit_s = time.monotonic() + 5
    while not lab.reached and time.monotonic() < limit_s:
        time.sleep(0.01)
    assert lab.reached == ["lab/a/stop"], "what was put before it did not come"


def test_who_is_not_named_sees_nothing(lab: Lab) -> None:
    cleo = lab.session("cleo")
    assert lab.answered(cleo, "lab/a/**") == lab.answered(cleo, "lab/a/state") == []
    assert not list(cleo.liveliness().get("lab/a/**", timeout=2.0))


def test_a_robot_cannot_answer_for_another(lab: Lab) -> None:
    other = lab.session("robot-b")
    with other.declare_queryable("lab/a/state", lambda query: query.reply("lab/a/state", "robot-b")):
        time.sleep(0.1)
        assert lab.answered(lab.session("ana"), "lab/a/state") == ["robot-a"]


def test_without_a_certificate_nobody_comes_in(lab: Lab, tmp_path: Path) -> None:
    file = Path(lab.fleet.secret("ana"))
    told = json.loads(file.read_text().partition("\n")[2])
    del told["transport"]["link"]["tls"]["connect_certificate"]
    del told["transport"]["link"]["tls"]["connect_private_key"]
    told["transport"]["link"]["tls"]["enable_mtls"] = False
    told["connect"]["timeout_ms"] = 300
    (tmp_path / "nobody.json5").write_text(json.dumps(told))
    try:
        nobody = lab.stack.enter_context(Network(config=str(tmp_path / "nobody.json5")).opened())
    except LinkNotFound:
        return
    assert lab.answered(nobody, "lab/a/state") == []


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('writers = ["ana"]\n', "", 'a: who may write it? Add writers = ["ana"] there'),
        ("tls/127", "tcp/127", "is not encrypted; with TLS, write router ="),
        ('["ben"]', '["robot-b"]', "a: 'robot-b' is no name for a certificate"),
        ('["ben"]', '["a b"]', "a: 'a b' is no name for a certificate"),
        ('["ben"]', '["router"]', "a: 'router' is no name for a certificate"),
    ],
)
def test_what_cannot_be_secured_is_said(tmp_path: Path, old: str, new: str, message: str) -> None:
    fleet = described(tmp_path, TEXT.replace(old, new))
    with pytest.raises(FleetError, match=re.escape(message)):
        security_files(fleet, "secrets")


def test_the_keys_are_for_their_owner_only(lab: Lab) -> None:
    keys = [*lab.fleet.place("secrets").glob("*-key.pem")]
    assert len(keys) == 7 and {one.stat().st_mode & 0o777 for one in keys} == {0o600}


def test_the_script_makes_no_second_authority_where_the_key_of_the_first_is_not(
    lab: Lab, tmp_path: Path
) -> None:
    secrets = lab.fleet.place("secrets")
    (tmp_path / SCRIPT).write_text((secrets / SCRIPT).read_text())
    (tmp_path / "authority.pem").write_bytes((secrets / "authority.pem").read_bytes())
    assert subprocess.run(["sh", tmp_path / SCRIPT], capture_output=True, check=False).returncode != 0
    assert (tmp_path / "authority.pem").read_bytes() == (secrets / "authority.pem").read_bytes()


def test_a_folder_with_odd_letters(tmp_path: Path) -> None:
    text = security_files(described(tmp_path), 'a "b" \\ c')["ana.json5"].partition("\n")[2]
    told = json.loads(text)["transport"]["link"]["tls"]
    assert told["connect_private_key"] == 'a "b" \\ c/ana-key.pem'


def test_who_one_is_has_to_be_said(tmp_path: Path) -> None:
    fleet = described(tmp_path)
    with pytest.raises(FleetError, match="the network is encrypted; say who you are: --as NAME"):
        fleet.network()
    with pytest.raises(FleetError, match=r"ana\.json5 is not there: unitylink fleet security"):
        fleet.network("ana")
