# SPDX-License-Identifier: BSD-3-Clause
"""The steps in Python. steps.cpp and steps.c do the same and print the same lines."""

from __future__ import annotations

import queue
import sys
from collections.abc import Callable
from itertools import count
from typing import Any

import unitylink
from unitylink.errors import UnexpectedValue, ValueRangeError
from unitylink.layer4_data import load_spec_objects
from unitylink.spec import load

IDLE, RUN, STOP = 0, 1, 3  # mode
HIGH = 15  # level

_numbers = count(1)


def say(name: str, text: str) -> None:
    print(f"{next(_numbers):02d} {name}: {text}")


def refused(name: str, call: Callable[[], Any]) -> None:
    try:
        call()
    except ValueRangeError:
        say(name, "refused")
    except UnexpectedValue:
        say(name, "unexpected")
    else:
        say(name, "done")


def text_of(status: Any) -> str:
    return f"{int(status.ready)} {int(status.mode)} {status.heat:.1f}"


def whole(robot: Any) -> None:
    robot.count.write(123456)
    say("count", f"{robot.count.read()}")
    robot.count.write(4294967295)
    say("count", f"{robot.count.read()}")
    robot.small.write(-100)
    say("small", f"{robot.small.read()}")
    refused("small 101", lambda: robot.small.write(101))
    refused("small -101", lambda: robot.small.write(-101))
    say("small", f"{robot.small.read()}")
    robot.big.write(18446744073709551615)
    say("big", f"{robot.big.read()}")
    robot.big.write(81985529216486895)
    say("big", f"{robot.big.read()}")


def real(robot: Any) -> None:
    robot.gain.write(2.5)
    say("gain", f"{robot.gain.read():.6f}")
    refused("gain 10.5", lambda: robot.gain.write(10.5))
    refused("gain NaN", lambda: robot.gain.write(float("nan")))
    robot.exact.write(-0.1)
    say("exact", f"{robot.exact.read():.17g}")
    refused("exact infinite", lambda: robot.exact.write(float("inf")))
    robot.j[0].torque.write(1.503)
    say("torque", f"{robot.j[0].torque.read():.8f}")
    robot.j[1].torque.write(99.0)
    say("torque", f"{robot.j[1].torque.read():.8f}")
    robot.j[1].torque.write(-99.0)
    say("torque", f"{robot.j[1].torque.read():.8f}")
    robot.j[0].target.write(-1.2345)
    refused("target 3.5", lambda: robot.j[0].target.write(3.5))
    say("pos", f"{robot.j[0].pos.read():.3f} {robot.j[1].pos.read():.3f}")


def named(robot: Any) -> None:
    robot.j[0].mode.write(STOP)
    say("mode", f"{int(robot.j[0].mode.read())}")
    refused("mode 2", lambda: robot.j[0].mode.write(2))
    refused("mode of the board", robot.j[1].mode.read)
    robot.level.write(HIGH)
    say("level", f"{int(robot.level.read())}")
    robot.level.write(200)
    say("level", f"{int(robot.level.read())}")
    robot.status.write({"ready": True, "mode": RUN, "heat": -12.5})
    say("status", text_of(robot.status.read()))
    refused("status hot", lambda: robot.status.write({"ready": True, "mode": RUN, "heat": 64.0}))
    for item, lamp in enumerate((True, False, True)):
        robot.lamps[item].write(lamp)
    say("lamps", " ".join(str(int(lamp.read())) for lamp in robot.lamps))


def special(robot: Any) -> None:
    say("faults", f"{robot.faults.read()}")
    robot.faults.clear(4)
    say("faults", f"{robot.faults.read()}")
    say("lost", f"{robot.lost.read()}")
    robot.reset.pulse(3)
    say("reset", "pulsed")
    refused("reset 16", lambda: robot.reset.pulse(16))
    robot.net.a.write(-7)
    say("net", f"{robot.net.a.read()} {robot.net.b.read():.1f}")
    robot.net.b.write(12.3)
    say("net", f"{robot.net.a.read()} {robot.net.b.read():.1f}")
    robot.net.a.write(8)
    say("net", f"{robot.net.a.read()} {robot.net.b.read():.1f}")


def together(robot: Any) -> None:
    robot.targets.write([0.25, -0.25])
    say("limit", f"{robot.limit.read()}")
    robot.j[1].mode.write(IDLE)
    with robot.j[0].cycle() as cycle:
        state = cycle(target=1.5, mode=RUN, torque=-2.25)
        say("cycle", f"{state['pos']:.3f} {int(state['mode'])} {state['torque']:.3f}")
        refused("cycle 4", lambda: cycle(target=4.0, mode=IDLE, torque=0.0))
        state = cycle(target=-1.5, mode=STOP, torque=50.0)
        say("cycle", f"{state['pos']:.3f} {int(state['mode'])} {state['torque']:.3f}")
    shot = robot.snapshot()
    numbers = f"{shot['count']} {shot['small']} {shot['big']} {shot['gain']:.3f} {shot['j[1].torque']:.3f}"
    say("snapshot", numbers)
    published: queue.Queue[float] = queue.Queue()
    stop = robot.j[1].pos.on_publish(lambda _, value: published.put(value))
    say("published", f"{published.get(timeout=10):.3f}")
    stop()


def main() -> int:
    with unitylink.connect(sys.argv[1]) as link:
        robot = load_spec_objects(load(sys.argv[2]), link)
        for part in (whole, real, named, special, together):
            part(robot)
    return 0


if __name__ == "__main__":
    sys.exit(main())
