# SPDX-License-Identifier: BSD-3-Clause
"""The node of ROS 2 over Zenoh. A peer of plain Zenoh and rosbags stands for a node with rmw_zenoh_cpp."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import zenoh
from ros.conftest import free_port
from ros.nodes import RIG, generated_node, store, until

from unitylink.ros.rmw_zenoh import Attachment, gid_of, read_attachment
from unitylink.ros.zenoh_session import RosSession
from unitylink.simulate import Board

JOINTS, TIME = "sensor_msgs/msg/JointState", "builtin_interfaces/msg/Time"


class Peer:
    """A router, a session as that of a node with rmw_zenoh_cpp, and the messages of rosbags."""

    def __init__(self, router: str) -> None:
        settings = {"mode": '"router"', "listen/endpoints": f'["{router}"]'}
        settings |= {"scouting/multicast/enabled": "false"}
        configuration = zenoh.Config()
        for key, value in settings.items():
            configuration.insert_json5(key, value)
        self.router = zenoh.open(configuration)
        self.session = RosSession().opened()
        self.store = store()
        self._tokens: set[str] = set()
        self._watch = self.session.liveliness().declare_subscriber("@ros2_lv/7/**", self._heard, history=True)

    def _heard(self, sample: zenoh.Sample) -> None:
        known = sample.kind == zenoh.SampleKind.PUT
        (self._tokens.add if known else self._tokens.discard)(str(sample.key_expr))

    def tokens(self) -> list[str]:
        return sorted(self._tokens)

    def token(self, kind: str, name: str) -> list[str]:
        """Return the parts of the token of an endpoint, as `ros2 topic info` reads them."""
        (found,) = [one.split("/") for one in self.tokens() if f"/{kind}/" in one and f"/{name}/" in one]
        return found

    def key(self, kind: str, name: str) -> str:
        """Return the key that belongs to a token."""
        parts = self.token(kind, name)
        return "/".join((parts[1], parts[9].replace("%", "/").strip("/"), *parts[10:12]))

    def joints(self, name: str, position: float) -> bytes:
        made = self.store.types
        header = made["std_msgs/msg/Header"](made[TIME](0, 0), "")
        message = made[JOINTS](header, [name], *(np.array(x) for x in ([position], [], [])))
        return bytes(self.store.serialize_cdr(message, JOINTS))


@pytest.fixture
def peer(monkeypatch: pytest.MonkeyPatch) -> Iterator[Peer]:
    router = f"tcp/127.0.0.1:{free_port()}"
    monkeypatch.setenv("ZENOH_CONFIG_OVERRIDE", f'connect/endpoints=["{router}"]')
    monkeypatch.setenv("ROS_DOMAIN_ID", "7")
    made = Peer(router)
    yield made
    made.session.close()
    made.router.close()


@pytest.fixture
def device(tmp_path: Path, board: Callable[..., Board], peer: Peer) -> Iterator[Board]:
    """The board of the rig behind its generated node."""
    made = board("rig", "still")
    with generated_node(tmp_path, made, "--zenoh") as output:
        yield made
    said = output()
    assert "the message does not have its type" in said and "Traceback" not in said, said
    until(lambda: not peer.tokens())  # it has left


def test_a_peer_lists_the_node_and_talks_to_it(device: Board, peer: Peer) -> None:
    device.registers[0x10], device.registers[0x11] = 500, 0xFF9C
    until(lambda: any("/SS/" in token and "%read/" in token for token in peer.tokens()))
    (node,) = [token for token in peer.tokens() if "/NN/" in token]
    assert node.endswith("/0/0/NN/%/%rig/unitylink")
    assert all(len(token.split("/")) in (9, 13) and "//" not in token for token in peer.tokens())

    seen: list[zenoh.Sample] = []
    hashed = peer.store.hash_rihs01(JOINTS)
    key = f"7/rig/joint_states/sensor_msgs::msg::dds_::JointState_/{hashed}"
    with peer.session.declare_subscriber(key, seen.append):
        until(lambda: len(seen) > 3)
    state = peer.store.deserialize_cdr(seen[-1].payload.to_bytes(), JOINTS)
    assert state.name == ["j_0", "j_1"] and list(state.position) == [0.5, 0.0]
    beside = [read_attachment(sample.attachment.to_bytes()) for sample in seen]
    numbers = [one.sequence for one in beside]
    assert numbers == list(range(numbers[0], numbers[0] + len(numbers)))
    assert abs(beside[-1].time_ns / 1e9 - time.time()) < 60
    assert {one.gid for one in beside} == {gid_of("/".join(peer.token("MP", "%rig%joint_states")))}

    commands = peer.session.declare_publisher(peer.key("MS", "%rig%joint_commands"))
    mine = Attachment(1, time.time_ns(), bytes(16)).packed()
    commands.put(peer.joints("j_1", 0.5), attachment=mine)
    until(lambda: device.registers[0x1A] == 500)
    chance, whole = random.Random(3), peer.joints("j_1", 0.9)
    hostile: list[tuple[bytes, bytes | None]] = [(whole, None), (whole, mine[:-1]), (whole, mine + b"\0")]
    hostile += [(whole, mine[:16] + b"\x11" + mine[17:]), (whole[:20], mine), (b"", mine)]
    hostile += [(chance.randbytes(chance.randrange(60)), mine) for _ in range(200)]
    for payload, attachment in hostile:
        commands.put(payload, attachment=attachment)
    commands.put(peer.joints("j_1", -0.25), attachment=mine)
    until(lambda: device.registers[0x1A] == 0xFF06)
    assert device.registers[0x12] == 0  # the other joint was not touched

    def call(name: str, request: bytes, attachment: bytes | None) -> Any:
        key = peer.key("SS", name)
        replies = list(peer.session.get(key, payload=request, attachment=attachment, timeout=20))
        return replies[0].ok if replies and replies[0].ok is not None else None

    asked = Attachment(3, time.time_ns(), bytes(range(16)))
    off = call("%rig%arm", b"\0\1\0\0\0", asked.packed())
    answered = read_attachment(off.attachment.to_bytes())
    assert (answered.sequence, answered.gid) == (3, asked.gid)
    assert off.payload.to_bytes()[4] == 1  # success
    assert call("%rig%arm", b"\0\1\0\0\1", None) is None
    assert call("%rig%arm", b"\0\1", asked.packed()) is None
    assert call("%rig%arm", b"\0\1\0\0\1", asked.packed()) is not None


def test_the_variable_of_ros_2_chooses_zenoh(
    board: Callable[..., Board], peer: Peer, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And the bridge is a client of the router, not a peer."""
    monkeypatch.setenv("RMW_IMPLEMENTATION", "rmw_zenoh_cpp")
    override = f'{os.environ["ZENOH_CONFIG_OVERRIDE"]};mode="client"'
    monkeypatch.setenv("ZENOH_CONFIG_OVERRIDE", override)
    device = board("rig", "still")
    link = f"{device.url}?timeout=2"
    command = [sys.executable, "-m", "unitylink", "bridge", "ros2", link, RIG, "--namespace", "left"]
    with subprocess.Popen(command) as process:
        try:
            until(lambda: any("/MS/" in token and "%left%j_0%pos_sp" in token for token in peer.tokens()))
            mine = Attachment(1, time.time_ns(), bytes(16)).packed()
            key = peer.key("MS", "%left%j_0%pos_sp")
            number = peer.store.types["std_msgs/msg/Float64"](0.5)
            payload = bytes(peer.store.serialize_cdr(number, "std_msgs/msg/Float64"))
            peer.session.put(key, payload, attachment=mine)
            until(lambda: device.registers[0x12] == 500)
        finally:
            process.send_signal(signal.SIGTERM)
    assert process.returncode == 0 and device.registers[0x12] == 250  # safe at the end
