# SPDX-License-Identifier: BSD-3-Clause
"""The ROS 2 node on DDS: the bytes on the wire are those that ROS 2 would send."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from effort import many
from hypothesis import given, settings
from hypothesis import strategies as st
from ros.nodes import PATIENCE_S, RIG, generated_node, node_here, store, until

from unitylink.errors import LinkNotFound
from unitylink.generate import write
from unitylink.ros import Topic, plan_interface
from unitylink.ros.dds import DdsPlane
from unitylink.ros.dds_types import DdsTypes
from unitylink.ros.node import RobotNode
from unitylink.ros.plane import SERVICE_FIELDS
from unitylink.ros.standard import STANDARD, definitions
from unitylink.simulate import Board
from unitylink.spec import load

MakeBoard = Callable[..., Board]


@pytest.fixture(scope="module")
def rosbags() -> Any:
    return store()


@pytest.fixture(scope="module")
def types() -> DdsTypes:
    return DdsTypes(definitions(plan_interface(load(RIG))))


def test_our_definitions_are_those_of_ros(rosbags: Any) -> None:
    for name, fields in STANDARD.items():
        theirs = rosbags.fielddefs[name.replace("/", "/msg/")][1]
        assert [field for field, _ in fields] == [field for field, _ in theirs], name


numbers = {
    "bool": st.booleans(),
    **{f"int{n}": st.integers(-(2 ** (n - 1)), 2 ** (n - 1) - 1) for n in (8, 16, 32, 64)},
    **{f"uint{n}": st.integers(0, 2**n - 1) for n in (8, 16, 32, 64)},
    "float32": st.floats(width=32, allow_nan=False),
    "float64": st.floats(allow_nan=False),
    "string": st.text(st.characters(blacklist_characters="\0", blacklist_categories=["Cs"]), max_size=9),
}


@settings(max_examples=many(60))
@given(data=st.data())
def test_cdr_is_that_of_rosbags(data: st.DataObject, types: DdsTypes, rosbags: Any) -> None:
    """For any message with any content, our bytes are those of rosbags' serialiser, and are read back."""
    all_fields = definitions(plan_interface(load(RIG)))
    name = data.draw(st.sampled_from(sorted(all_fields)))

    def value(kind: str) -> Any:
        found = re.fullmatch(r"(.*)\[(\d*)\]", kind)
        if found:
            length = int(found[2]) if found[2] else data.draw(st.integers(0, 3))
            return [value(found[1]) for _ in range(length)]
        if kind in numbers:
            return data.draw(numbers[kind])
        # rosbags reads ROS's `byte` as signed; levels of diagnostics are 0 to 3
        parts = (data.draw(st.integers(0, 3)) if f == "level" else value(k) for f, k in all_fields[kind])
        return types[kind](*parts)

    def theirs(message: Any, kind: str) -> Any:

        found = re.fullmatch(r"(.*)\[(\d*)\]", kind)
        if found:
            if found[1] in numbers and found[1] != "string":
                return np.array(message, dtype=found[1])
            return [theirs(one, found[1]) for one in message]
        if kind in numbers:
            return message
        made = rosbags.types[kind.replace("/", "/msg/")]
        return made(*(theirs(getattr(message, field), inner) for field, inner in all_fields[kind]))

    message = value(name)
    ours = bytes(message.serialize())
    expected = bytes(rosbags.serialize_cdr(theirs(message, name), name.replace("/", "/msg/")))
    assert ours.rstrip(b"\0") == expected.rstrip(b"\0") and abs(len(ours) - len(expected)) < 4
    assert types[name].deserialize(ours) == message


class Peer:
    """A participant that stands for another program. It keeps the messages of each topic."""

    def __init__(self, domain: int, types: DdsTypes) -> None:
        from cyclonedds.domain import DomainParticipant

        self.types = types
        self.participant = DomainParticipant(domain)

    def reader(self, topic: str, kind: Any) -> Any:
        from cyclonedds.core import Policy, Qos
        from cyclonedds.sub import DataReader
        from cyclonedds.topic import Topic

        qos = Qos(Policy.Reliability.Reliable(1_000_000_000), Policy.History.KeepLast(50))
        return DataReader(self.participant, Topic(self.participant, topic, kind), qos=qos)

    def writer(self, topic: str, kind: Any) -> Any:
        from cyclonedds.core import Policy, Qos
        from cyclonedds.pub import DataWriter
        from cyclonedds.topic import Topic

        qos = Qos(Policy.Reliability.Reliable(1_000_000_000), Policy.History.KeepLast(50))
        made = DataWriter(self.participant, Topic(self.participant, topic, kind), qos=qos)
        until(made.get_matched_subscriptions)
        return made

    def next(self, reader: Any) -> Any:
        from cyclonedds.internal import InvalidSample

        found: list[Any] = []

        def come() -> bool:
            found.extend(m for m in reader.take(50) if not isinstance(m, InvalidSample))
            return bool(found)

        until(come)
        return found[-1]


@pytest.fixture
def node(tmp_path: Path, board: MakeBoard, domain: int, monkeypatch: pytest.MonkeyPatch) -> Iterator[Board]:
    """The board of the rig behind its generated node."""
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    device = board("rig", "still")
    with generated_node(tmp_path, device, "--dds"):
        yield device


def test_generated_node_on_dds(node: Board, domain: int, types: DdsTypes, rosbags: Any) -> None:
    device = node
    device.registers[0x10], device.registers[0x11], device.registers[0x1] = 500, 0xFF9C, 0b1011
    peer = Peer(domain, types)
    captured: list[bytes] = []
    kind = types["sensor_msgs/JointState"]
    wire = type("JointState_", (kind,), {})  # the same type, but its bytes are kept as they come
    wire.__idl__ = kind.__idl__
    wire.deserialize = classmethod(
        lambda cls, data, **_: captured.append(bytes(data)) or kind.deserialize(data)
    )
    states = peer.reader("rt/rig/joint_states", wire)
    until(lambda: (m := peer.next(states)).position[0] == 0.5 and m.velocity[0] == -1.0)
    known = rosbags.deserialize_cdr(captured[-1], "sensor_msgs/msg/JointState")
    assert known.name == ["j_0", "j_1"] and list(known.position) == [0.5, 0.0]
    assert abs(known.header.stamp.sec - time.time()) < 60 and known.header.frame_id == "base"
    again = bytes(rosbags.serialize_cdr(known, "sensor_msgs/msg/JointState"))
    assert again.rstrip(b"\0") == captured[-1].rstrip(b"\0")

    feedback = peer.next(peer.reader("rt/rig/feedback_100hz", types["rig_unitylink/RigFeedback100Hz"]))
    assert (feedback.flags.on, feedback.flags.heat, feedback.mode) == (True, 2.5, 1)

    commands = peer.writer("rt/rig/joint_commands", kind)
    header = types["std_msgs/Header"](types["builtin_interfaces/Time"](0, 0), "")
    for position in range(1, 101):
        commands.write(kind(header, ["j_1"], [position / 100], [], []))
    until(lambda: device.registers[0x1A] == 1000)
    # the two come at once, and neither replaces the other
    for joint, position in (("j_0", 0.7), ("j_1", 0.8)):
        commands.write(kind(header, [joint], [position], [], []))
    until(lambda: (device.registers[0x12], device.registers[0x1A]) == (700, 800))

    name = "rig_unitylink/Read"
    asked = types.service(name, "Request", SERVICE_FIELDS["Read"][0])
    answered = types.service(name, "Response", SERVICE_FIELDS["Read"][1])
    replies = peer.reader("rr/rig/readReply", answered)
    requests = peer.writer("rq/rig/readRequest", asked)
    until(replies.get_matched_publications)
    requests.write(asked(7, 1, ["j[0].pos", "mode"]))
    reply = peer.next(replies)
    assert (reply.guid, reply.number, reply.success) == (7, 1, True)
    assert reply.values == [0.5, 1.0] and reply.texts == ["0.5 rad", "run"]

    status = peer.next(peer.reader("rt/diagnostics", types["diagnostic_msgs/DiagnosticArray"])).status[0]
    assert status.level == 0 and status.hardware_id.startswith(device.url)


@pytest.fixture(name="node_here")
def node_on_dds(board: MakeBoard, domain: int) -> Iterator[tuple[RobotNode, Board]]:
    device = board("rig", "still")
    plane = DdsPlane(plan_interface(load(RIG)), "rig", domain)
    node = node_here(plane, device)
    plane.start()
    until(node.keeper.up.is_set)
    yield node, device
    node.close()
    plane.close()


def test_a_message_that_cannot_be_read_ends_nothing(
    node_here: tuple[RobotNode, Board], domain: int, types: DdsTypes
) -> None:
    """Any participant may send a name that is not UTF-8. It is refused, and the next message is taken."""
    node, device = node_here
    kind = types["sensor_msgs/JointState"]
    commands = Peer(domain, types).writer("rt/rig/joint_commands", kind)
    header = types["std_msgs/Header"](types["builtin_interfaces/Time"](0, 0), "")

    def command(position: float) -> Any:
        return kind(header, ["j_1"], [position], [], [])

    whole = bytes(command(0.5).serialize())
    names = (b"\xff\xfe1", b"\xed\xa0\x80", b"\xc3(1", b"\x80\x80\x80")
    hostile = [whole.replace(b"j_1", name) for name in names]
    for number, data in enumerate(hostile):
        refused = node.refused
        message = command(0.5)
        message.serialize = lambda data=data, **_: data
        commands.write(message)
        commands.write(command(0.1 * number))
        until(lambda number=number: device.registers[0x1A] == 100 * number)
        until(lambda refused=refused: node.refused > refused)
    assert not node.hanging and node.health().level == 1


@pytest.mark.parametrize("wrong", [float("nan"), float("inf"), -float("inf"), 1e308])
def test_a_number_that_a_word_cannot_hold_is_refused_whole(
    node_here: tuple[RobotNode, Board], domain: int, types: DdsTypes, wrong: float
) -> None:
    """x and yaw of the cart are f32 without limits.

    If one of them is not a finite f32, neither is written.
    """
    node, device = node_here
    twist, vector = types["geometry_msgs/Twist"], types["geometry_msgs/Vector3"]
    commands = Peer(domain, types).writer("rt/rig/cart/cmd_vel", twist)

    def command(x: float, yaw: float) -> None:
        commands.write(twist(vector(x, 0.0, 0.0), vector(0.0, 0.0, yaw)))

    command(1.5, -2.0)
    until(lambda: (device.registers[0x8], device.registers[0x9]) == (0x3FC00000, 0xC0000000))
    for x, yaw in ((wrong, 0.0), (0.0, wrong)):
        refused = node.refused
        command(x, yaw)
        until(lambda refused=refused: node.refused > refused)
    assert (device.registers[0x8], device.registers[0x9]) == (0x3FC00000, 0xC0000000)
    command(-2.0, 1.5)
    until(lambda: (device.registers[0x8], device.registers[0x9]) == (0xC0000000, 0x3FC00000))


def test_a_thread_that_hangs_is_noticed_by_the_gateware_and_services_are_answered(
    node_here: tuple[RobotNode, Board], domain: int, types: DdsTypes
) -> None:
    node, device = node_here
    peer = Peer(domain, types)
    commands = peer.writer("rt/rig/mode", types["std_msgs/UInt8"])
    commands.write(types["std_msgs/UInt8"](1))
    until(lambda: device.registers[0x0] == 1)
    held, session = threading.Event(), node.session
    assert session is not None
    session.inbox.put = lambda numbers: held.wait(PATIENCE_S)  # type: ignore[method-assign]
    node.make_safe_when_hanging = lambda _: None  # type: ignore[method-assign]  # only the gateware does
    commands.write(types["std_msgs/UInt8"](1))
    until(lambda: "the thread that takes messages has not moved on" in node.hanging)
    asked, answered = (
        types.service("std_srvs/SetBool", part, SERVICE_FIELDS["std_srvs/SetBool"][n])
        for n, part in enumerate(("Request", "Response"))
    )
    replies = peer.reader("rr/rig/armReply", answered)
    requests = peer.writer("rq/rig/armRequest", asked)
    until(replies.get_matched_publications)
    requests.write(asked(7, 1, True))
    reply = peer.next(replies)
    assert not reply.success and "has not moved on" in reply.message
    health = node.health()
    assert health.level == 2 and "has not moved on" in health.message
    until(lambda: device.registers[0x0] == 0)  # the gateware has written the SAFE value
    del session.inbox.put
    held.set()
    until(node.keeper.up.is_set)
    until(lambda: not node.hanging)
    commands.write(types["std_msgs/UInt8"](1))
    until(lambda: device.registers[0x0] == 1)


def test_what_is_gathered_arrives_whole_and_in_order(domain: int, types: DdsTypes) -> None:
    """Many messages travel in few packets.

    A single one goes at once, and so does what another thread publishes.
    """
    plane = DdsPlane(plan_interface(load(RIG)), "rig", domain)
    port = plane.advertise(Topic("out", "std_msgs/Int32", "scalar", ("out",), queue=4096))
    kind, peer = plane.types["std_msgs/Int32"], Peer(domain, types)
    reader = peer.reader("rt/rig/out", types["std_msgs/Int32"])
    until(port.wanted)
    until(reader.get_matched_publications)
    port.send(kind(-1))
    assert peer.next(reader).data == -1
    got: list[int] = []

    def come(count: int) -> bool:
        got.extend(message.data for message in reader.take(50))
        return len(got) == count

    with plane.gathered():
        for number in range(40):
            port.send(kind(number))
    until(lambda: come(40))
    assert got == list(range(40))
    with plane.gathered():
        other = threading.Thread(target=port.send, args=(kind(40),))
        other.start()
        other.join()
        until(lambda: come(41))
    plane.close()
    until(lambda: not reader.get_matched_publications())  # it has left, though its objects still exist here


def test_bridge_needs_nothing_generated(board: MakeBoard, domain: int, types: DdsTypes) -> None:
    """Only standard messages, both ways."""
    device = board("rig", "still")
    device.registers[0x3] = 7
    command = [
        sys.executable,
        "-m",
        "unitylink",
        "bridge",
        "ros2",
        f"{device.url}?timeout=2",
        RIG,
        "--namespace",
        "left",
    ]
    process = subprocess.Popen(command, env=os.environ | {"ROS_DOMAIN_ID": str(domain)})
    try:
        peer = Peer(domain, types)
        assert peer.next(peer.reader("rt/left/slow", types["std_msgs/UInt16"])).data == 7
        assert peer.next(peer.reader("rt/left/flags", types["std_msgs/UInt8"])).data == 0
        peer.writer("rt/left/j_0/pos_sp", types["std_msgs/Float64"]).write(types["std_msgs/Float64"](0.5))
        until(lambda: device.registers[0x12] == 500)
    finally:
        process.send_signal(signal.SIGTERM)
        assert process.wait(timeout=PATIENCE_S) == 0
    assert device.registers[0x12] == 250, "safe at the end"


@pytest.mark.parametrize(
    ("arguments", "code", "says"),
    [
        (("ros2", "tcp://127.0.0.1:1"), 2, "--spec FILE.ul"),
        (("ros2", "tcp://127.0.0.1:1", "PAIR"), 1, "--root"),
        (("ros2", "nonsense:", "RIG"), 1, "nonsense:"),
        (("ros1", "tcp://127.0.0.1:1", "RIG"), 1, "--system-site-packages"),
    ],
)
def test_bridge_says_what_is_wrong(arguments: tuple[str, ...], code: int, says: str, domain: int) -> None:
    files = {"RIG": str(RIG), "PAIR": str(RIG.parents[2] / "examples" / "pa10" / "pa10_pair.ul")}
    done = subprocess.run(
        [sys.executable, "-m", "unitylink", "bridge", *(files.get(word, word) for word in arguments)],
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        env=os.environ | {"ROS_DOMAIN_ID": str(domain)},
        check=False,
    )
    assert done.returncode == code and says in done.stderr and "Traceback" not in done.stderr, done.stderr


def test_wrong_parameters_are_said(tmp_path: Path) -> None:
    write(load(RIG), tmp_path, "ros2")
    package = tmp_path / "ros2" / "rig_unitylink"
    for arguments, says in (
        ([], "no link"),
        (["-p", "lnk:=x"], "expected -p NAME:=VALUE of link, command_timeout"),
        (["-p", "link:=x", "-p", "armed:=perhaps"], "expected true or false"),
    ):
        done = subprocess.run(
            [sys.executable, package / "scripts" / "node.py", "--dds", "--ros-args", *arguments],
            env=os.environ | {"PYTHONPATH": str(package)},
            capture_output=True,
            text=True,
            timeout=PATIENCE_S,
            check=False,
        )
        assert done.returncode == 1 and says in done.stderr, done.stderr


def test_security_without_its_plugins_is_an_error_that_names_the_configuration(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """docs/ros.md says so: DDS Security is never left out in silence."""
    parts = {
        "Authentication": "<IdentityCertificate/><IdentityCA/><PrivateKey/>",
        "Cryptographic": "",
        "AccessControl": "<Governance/><PermissionsCA/><Permissions/>",
    }
    inside = "".join(f'<{one}><Library path="absent"/>{rest}</{one}>' for one, rest in parts.items())
    monkeypatch.setenv(
        "CYCLONEDDS_URI", f"<CycloneDDS><Domain><Security>{inside}</Security></Domain></CycloneDDS>"
    )
    with pytest.raises(LinkNotFound, match="CYCLONEDDS_URI"):
        DdsPlane(plan_interface(load(RIG)), "rig", 201)
