# SPDX-License-Identifier: BSD-3-Clause
"""The node of ROS 2 over Zenoh, within this process: its thread hangs, and its router comes late."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

import pytest
import zenoh
from ros.conftest import free_port
from ros.nodes import PATIENCE_S, RIG, node_here, store, until

from unitylink.ros import plan_interface
from unitylink.ros.rmw_zenoh import Attachment
from unitylink.ros.zenoh_plane import ZenohPlane
from unitylink.simulate import Board
from unitylink.spec import load
from unitylink.zenoh.session import Network


def test_a_node_without_a_router_works_when_one_comes_and_is_safe_when_its_thread_hangs(
    board: Callable[..., Board], monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    router = f"tcp/127.0.0.1:{free_port()}"
    monkeypatch.setenv("ZENOH_CONFIG_OVERRIDE", f'connect/endpoints=["{router}"]')
    device = board("rig", "still")
    plane = ZenohPlane(plan_interface(load(RIG)), "rig", 7)
    node = node_here(plane, device)
    plane.start()
    held = threading.Event()
    try:
        until(node.keeper.up.is_set)
        with Network(listen=router).opened() as peer:
            messages = store()
            mode = f"7/rig/mode/std_msgs::msg::dds_::UInt8_/{messages.hash_rihs01('std_msgs/msg/UInt8')}"
            mine = Attachment(1, time.time_ns(), bytes(16)).packed()
            commands = peer.declare_publisher(mode, congestion_control=zenoh.CongestionControl.BLOCK)
            until(lambda: bool(commands.matching_status))  # the node has found the router
            commands.put(b"\0\1\0\0\1", attachment=mine)
            until(lambda: device.registers[0x0] == 1)

            refused = node.refused
            commands.put(b"\0\1\0\0\2" + bytes(1 << 21), attachment=mine)
            until(lambda: node.refused > refused)
            assert device.registers[0x0] == 1 and "expected at most 1048576" in caplog.text

            session = node.session
            assert session is not None
            session.inbox.put = lambda numbers: held.wait(PATIENCE_S)  # type: ignore[method-assign]
            node.make_safe_when_hanging = lambda _: None  # type: ignore[method-assign]  # only the gateware
            commands.put(b"\0\1\0\0\1", attachment=mine)
            until(lambda: "the thread that takes messages has not moved on" in node.hanging)
            found = peer.get("7/rig/arm/**", payload=b"\0\1\0\0\1", attachment=mine, timeout=20)
            (reply,) = [one.ok for one in found if one.ok is not None]
            assert reply.payload.to_bytes()[4] == 0 and b"has not moved on" in reply.payload.to_bytes()
            until(lambda: device.registers[0x0] == 0)  # the gateware has written the SAFE value
            del session.inbox.put
            held.set()
            until(node.keeper.up.is_set)
            until(lambda: not node.hanging)

            storm = [
                peer.get(
                    "7/rig/arm/**", zenoh.handlers.FifoChannel(4), payload=b"\0\1\0\0\1", attachment=mine
                )
                for _ in range(200)
            ]
            assert sum(len(list(replies)) for replies in storm) >= 1  # each ends, answered or not
            commands.put(b"\0\1\0\0\1", attachment=mine)
            until(lambda: device.registers[0x0] == 1)
    finally:
        held.set()
        node.close()
        plane.close()
