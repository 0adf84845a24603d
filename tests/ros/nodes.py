# SPDX-License-Identifier: BSD-3-Clause
"""Nodes of the rig where no ROS 2 is installed: the generated program, and one within this process."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from unitylink import connect
from unitylink.generate import write
from unitylink.layer4_data import load_spec_objects
from unitylink.ros import plan_interface
from unitylink.ros.definitions import definition
from unitylink.ros.node import Options, RobotNode
from unitylink.simulate import Board
from unitylink.spec import load

RIG = Path(__file__).with_name("rig.ul")
PATIENCE_S = 120.0


def until(holds: Callable[[], Any]) -> None:
    deadline = time.monotonic() + PATIENCE_S
    while not holds():
        assert time.monotonic() < deadline, "waited in vain"
        time.sleep(0.01)


def store() -> Any:
    """Return rosbags' own store of ROS 2's messages, with those of the rig's package."""
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    known = get_typestore(Stores.ROS2_HUMBLE)
    interface = plan_interface(load(RIG))
    for message in interface.messages:
        known.register(get_types_from_msg(definition(message), f"{interface.package}/msg/{message.name}"))
    return known


@contextmanager
def generated_node(folder: Path, device: Board, flag: str) -> Iterator[Callable[[], str]]:
    """Run the generated node with a flag such as `--dds`, in the environment of this process.

    After the block, what it yields returns the output.
    """
    write(load(RIG), folder, "ros2")
    package = folder / "ros2" / "rig_unitylink"
    process = subprocess.Popen(
        [
            sys.executable,
            package / "scripts" / "node.py",
            flag,
            "--ros-args",
            "-p",
            f"link:={device.url}?timeout=2",
        ],
        env=os.environ | {"PYTHONPATH": str(package)},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    out = ""
    yield lambda: out
    process.send_signal(signal.SIGINT)
    try:
        out, _ = process.communicate(timeout=PATIENCE_S)
    except subprocess.TimeoutExpired:
        process.kill()
        out, _ = process.communicate()
    print(out)
    assert process.returncode == 0, out


def node_here(plane: Any, device: Board) -> RobotNode:
    """Return a node on a plane in this process, whose threads a test can reach. Start the plane then."""
    plane.life.patience_s = 0.5
    return RobotNode(
        plan_interface(load(RIG)),
        plane,
        lambda: connect(f"{device.url}?timeout=5", reconnect="auto"),
        lambda link: load_spec_objects(load(RIG), link),
        Options(deadman_s=0.5),
    )
