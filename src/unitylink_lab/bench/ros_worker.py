# SPDX-License-Identifier: BSD-3-Clause
"""One end of a ROS figure, in a process of its own: `python -m unitylink_lab.bench.ros_worker PLANE ROLE`.

PLANE is ros1 or dds. A line on standard input is a number of seconds. The worker counts for so long and
answers "COUNT SECONDS CPU_SECONDS". A node that takes commands counts the writes that its board has answered.
The roles: `bare-out` and `source` publish as fast as they can. `joints-source` publishes 1000 times a second,
all the time. `node-out`, `node-in` and `joints` are nodes with the twin in their process. `bare-ping`
publishes the current time 500 times a second. In `node-ping` the gateware does this, and its thread takes the
time. `pong` receives these, and answers with the median delay in us, too.
"""

from __future__ import annotations

import os
import sys
import threading
import time
from collections.abc import Callable
from statistics import median
from typing import Any

from unitylink.layer2_message import Link
from unitylink.layer4_data import Node, load_spec_objects
from unitylink.ros import Interface, Topic, plan_interface
from unitylink.ros.node import RobotNode
from unitylink.ros.plane import Port
from unitylink.simulate import Board, BoardConfiguration, Plant, Registers
from unitylink.spec import compile_text
from unitylink.spec.model import Spec

BASE_HZ = {"ros1": 40_000, "dds": 200_000}  # more than the plane can take, even on an idle machine
OUT = Topic("out", "std_msgs/Int32", "scalar", ("out",), queue=4096)  # no message is dropped
IN = Topic("in", "std_msgs/Int32", "scalar", ("in",))
WORDS = """public bench() {
   @ros(type="Int32", queue=4096) @out = 0x0: i32 READ(PUBLISH(1,1));
   @in = 0x1: i32 WRITE();
}"""
PING = "public bench() { @out = 0x0: u32 READ(PUBLISH(on tick)); }"
PING_S = 0.002
JOINTS = """public bench() { j[18]: joint() @ (0x10+i*2, 0x11+i*2); }
joint(): @ (p,s) { @p: i16 READ(UNIT="rad", SCALE=0.001, PUBLISH(1,1));
                   @s: i16 WRITE(UNIT="rad", SCALE=0.001); }"""


def spec_of(text: str) -> Spec:
    """Compile a spec of the bench."""
    found = compile_text(text, "bench.ul").spec
    assert found is not None
    return found


def plane_of(name: str, interface: Interface, *, bare: bool) -> Any:
    """Return a front end to ROS 1 or DDS."""
    if name == "ros1":
        os.environ["ROS_NAMESPACE"] = "/bench"
        from unitylink.ros.ros1 import RospyPlane

        ros1 = RospyPlane("bench")
        ros1.rospy.init_node("bench", anonymous=True, disable_signals=True)
        return ros1
    from unitylink.ros.cdr_plane import Matched
    from unitylink.ros.dds import DdsPlane

    class Bare(DdsPlane):
        """A program that uses cyclonedds alone: it calls its DataWriter's `write` for each message."""

        def advertise(self, topic: Topic) -> Port:
            name = f"rt/{self.name(topic.name)}"
            writer = self._writer(name, self.types[topic.type], topic.queue, topic.reliable)
            return Port(writer.write, Matched(writer.get_matched_subscriptions))

    return (Bare if bare else DdsPlane)(interface, "bench", int(os.environ["ROS_DOMAIN_ID"]))


class Ping:
    """A plant that writes the time into a register at each step, and then makes an event."""

    period_s = PING_S

    def attach(self, spec: Spec | None, registers: Registers) -> None:
        self._registers = registers

    def step(self, time_s: float) -> None:
        self._registers[0x0] = now_us()
        self._registers.event(0)


def node(plane: Any, spec: Spec, base_hz: int, plant: Plant | None = None) -> RobotNode:
    """Return a node, connected to a twin in this process."""
    settings = BoardConfiguration.for_spec(spec, base_hz=base_hz, baud_hz=50_000_000)
    board = Board(spec, configuration=settings, plant=plant)

    def build(link: Link) -> Node:
        return load_spec_objects(spec, link)

    made = RobotNode(
        plan_interface(spec, standard=True), plane, lambda: Link(board.url), build, services=False
    )
    made.keeper.up.wait(30)
    return made


def now_us() -> int:
    """Return a word with the time of a clock that all processes share."""
    return time.monotonic_ns() // 1000 & 0xFFFFFFFF


def every(period_s: float, act: Callable[[], None]) -> None:
    """Call `act` once every `period_s`, in a thread of its own."""

    def run() -> None:
        due = time.perf_counter()
        while True:
            # after a long gap, the calls that were missed are left out
            due = max(due + period_s, time.perf_counter() - 0.1)
            time.sleep(max(0.0, due - time.perf_counter()))
            act()

    threading.Thread(target=run, daemon=True).start()


def main() -> None:
    """Play the role that the command line names."""
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # rospy logs to stdout, where the answers go
    name, role = sys.argv[1:3]
    joints = role.startswith("joints")
    timed = role in ("bare-ping", "node-ping", "pong")
    spec = spec_of(JOINTS if joints else PING if timed else WORDS)
    interface = plan_interface(spec, standard=True)
    nodes = ("node-out", "node-in", "node-ping", "joints")
    plane = plane_of(name, interface, bare=role not in nodes)
    counted, advertise = [0], plane.advertise

    def counting(topic: Topic) -> Port:
        port = advertise(topic)

        def send(message: Any) -> None:
            port.send(message)
            counted[0] += 1

        return Port(send, port.wanted) if topic.name == "out" else port

    plane.advertise = counting

    def count(_: Any) -> None:
        counted[0] += 1

    read: Callable[[], int] = lambda: counted[0]  # noqa: E731
    delays_us: list[int] = []
    if role == "pong":
        plane.subscribe(
            interface.published[0], lambda m: delays_us.append(now_us() - m.data & 0xFFFFFFFF), depth=10
        )
        read = lambda: len(delays_us)  # noqa: E731
    elif role == "bare-ping":
        topic = interface.published[0]
        port, make = advertise(topic), plane.maker(topic.type, ("data",))
        every(PING_S, lambda: port.send(make(now_us())))
    elif role == "node-ping":
        node(plane, spec, 1000, Ping())
    elif role in ("bare-out", "source", "joints-source"):
        topic = {"bare-out": OUT, "source": IN, "joints-source": interface.commanded[-1]}[role]
        threading.Thread(target=_flood, args=(plane, topic, joints), daemon=True).start()
    elif role == "sink":
        plane.subscribe(OUT, count, depth=4096)
    elif role == "bare-in":
        plane.subscribe(IN, count)  # its queue is as deep as the node's
    elif role == "joints-sink":
        plane.subscribe(interface.published[-1], count, depth=4096)
    else:
        made = node(plane, spec, {"node-out": BASE_HZ[name], "node-in": 100}.get(role, 1000))
        if role != "node-out":  # `node-out` counts what it sends
            read = lambda: int(made.health().facts["writes"])  # noqa: E731
    if name == "dds":
        plane.start()
    print("ready", file=answers, flush=True)
    for line in sys.stdin:
        before, wall, cpu = read(), time.perf_counter(), time.process_time()
        time.sleep(float(line))
        wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
        told = (median(delays_us[before:] or [0]),) if role == "pong" else ()
        print(read() - before, wall, cpu, *told, file=answers, flush=True)
    os._exit(0)


def _flood(plane: Any, topic: Topic, joints: bool) -> None:
    port = plane.advertise(topic)
    if joints:
        make = plane.maker(topic.type, ("header", "name", "position", "velocity", "effort"))
        names = [joint.name for joint in topic.joints]
    else:
        make = plane.maker(topic.type, ("data",))
    number, due = 0, time.perf_counter()
    while True:
        number += 1
        if not port.wanted():
            time.sleep(0.01)
        elif joints:
            due += 0.001
            time.sleep(max(0.0, due - time.perf_counter()))
            header = plane.header(time.monotonic(), "")
            port.send(make(header, names, [number % 1000 / 1000] * len(names), [], []))
        else:
            port.send(make(number & 0xFFFF))


if __name__ == "__main__":
    main()
