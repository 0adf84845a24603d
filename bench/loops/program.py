# SPDX-License-Identifier: BSD-3-Clause
"""A program that sets an output of the board to an input of it:  python bench/loops/program.py WAY URL

WAY is `event` (a callback of a publish), `cycle` (exchanges without a pause), `node` (a ROS node on DDS) or
`controller` (a program behind DDS topics, which has no URL).
"""

from __future__ import annotations

import os
import sys
import threading
from pathlib import Path
from typing import Any

from unitylink import connect
from unitylink.layer2_message import Link
from unitylink.layer4_data import load_spec_objects
from unitylink.ros import plan_interface
from unitylink.ros.dds import DdsPlane
from unitylink.ros.node import RobotNode
from unitylink.spec import load

SPEC = Path(__file__).with_name("board.ul")
TOPICS = "loops"
LEVELS, OUTPUTS = 0, 1  # addresses of board.ul


def ready() -> None:
    """Tell that the loop runs."""
    print("ready", flush=True)


def prepare(link: Link) -> Any:
    """Make pin 1 an output, watch pin 0, and return the objects of the board."""
    board = load_spec_objects(load(str(SPEC)), link)
    board["pad.direction"].write(2)
    board["pad.watch"].write(1)
    return board


def on_events(url: str) -> None:
    """Answer each publish of a change with a write."""
    with connect(url) as link:
        board = prepare(link)
        outputs = board["pad.outputs"]
        board["pad.levels"].on_change(lambda levels: outputs.write((levels & 1) << 1))
        ready()
        threading.Event().wait()


def in_cycles(url: str) -> None:
    """Exchange the input and the output without a pause."""
    with connect(url) as link:
        prepare(link)
        group = link.exchange_group(writes=[OUTPUTS], reads=[LEVELS])
        ready()
        levels = 0
        while True:
            (levels,) = group.exchange([(levels & 1) << 1])


def as_node(url: str) -> None:
    """Be the ROS node of the board."""
    spec = load(str(SPEC))
    interface = plan_interface(spec, standard=True)
    plane = DdsPlane(interface, TOPICS, int(os.environ["ROS_DOMAIN_ID"]))
    made = RobotNode(interface, plane, lambda: Link(url), prepare, services=False)
    made.keeper.up.wait(30)
    plane.start()
    ready()
    threading.Event().wait()


def as_controller() -> None:
    """Answer each message of the input's topic with one to the output's."""
    interface = plan_interface(load(str(SPEC)), standard=True)
    plane = DdsPlane(interface, TOPICS, int(os.environ["ROS_DOMAIN_ID"]))
    (levels,) = (one for one in interface.published if one.paths == ("pad.levels",))
    (outputs,) = (one for one in interface.commanded if one.paths == ("pad.outputs",))
    port, make = plane.advertise(outputs), plane.maker(outputs.type, ("data",))
    plane.subscribe(levels, lambda message: port.send(make((message.data & 1) << 1)), depth=10)
    plane.start()
    ready()
    threading.Event().wait()


if __name__ == "__main__":
    way, *urls = sys.argv[1:]
    {"event": on_events, "cycle": in_cycles, "node": as_node, "controller": as_controller}[way](*urls)
