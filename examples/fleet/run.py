# SPDX-License-Identifier: BSD-3-Clause
"""Eight SCARAs on one network, in one table. The bridge of one is killed, and comes back.

python examples/fleet/run.py
python examples/fleet/run.py --seconds 15
"""

from __future__ import annotations

import argparse
import math
import os
import signal
import threading
import time
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

from unitylink import connect
from unitylink.commands.fleet_bridges import start_bridge
from unitylink.commands.fleet_table import News, rows, show
from unitylink.commands.output import plain_table
from unitylink.errors import LinkError, ToolError
from unitylink.fleet.description import Fleet
from unitylink.fleet.reader import read_fleet
from unitylink.fleet.report import HEADERS, RIGHT
from unitylink.fleet.supervisor import Supervisor
from unitylink.program import run_program, stopped_by_signals
from unitylink.zenoh.link import ZenohLink

FLEET = Path(__file__).resolve().parent / "fleet.toml"
KILLED = "arm3"
LEAST_S = 8.0
UP_S = 60.0  # how long all arms have to come
PERIOD_S = 0.05
HALF_WAY, CYCLE_S = 300.0, 6.0  # of joint 1: counts and seconds


class Arm:
    """One arm as a client on the network sees it. It follows a sine."""

    def __init__(self, link: ZenohLink) -> None:
        self._link, self._robot = link, link.robot()
        self._ready = False
        self.moves = self.missed = 0

    def move(self, time_s: float) -> None:
        """Write the set-point of a moment; count it if the arm is away."""
        try:
            if not self._ready:
                self._robot["j1.spd_sp"].write(2000)
                self._ready = True
            self._robot["j1.pos_sp"].write(round(HALF_WAY * math.sin(2 * math.pi * time_s / CYCLE_S)))
            self.moves += 1
        except LinkError:
            self._ready = False
            self.missed += 1


def move(arm: Arm, stop: threading.Event) -> None:
    """Move one arm until `stop`. Each arm has a thread, so that none waits for another."""
    began_s = time.monotonic()
    while not stop.wait(PERIOD_S):
        arm.move(time.monotonic() - began_s)


def kill(fleet: Supervisor, news: News, name: str) -> None:
    """Kill the bridge of an arm, and say how long it was away."""
    pid = next(one.pid for one in fleet.reports() if one.name == name)
    if pid is None:
        news.say(name, "its bridge does not run: nothing to kill")
        return
    news.say(name, f"kill -9 {pid}, its bridge")
    began_s = time.monotonic()
    os.kill(pid, signal.SIGKILL)
    gone_s = _wait(fleet, name, False, began_s)
    back_s = _wait(fleet, name, True, began_s)
    news.say(name, f"its token was gone after {gone_s:.2f} s, and it was back after {back_s:.2f} s")


def _wait(fleet: Supervisor, name: str, reachable: bool, since_s: float) -> float:
    """Wait until an arm is there, or is not. Return how long it took."""
    while next(one.reachable for one in fleet.reports() if one.name == name) != reachable:
        if time.monotonic() - since_s > UP_S:
            raise ToolError(f"{name} is {'not ' if reachable else ''}there after {UP_S:.0f} s")
        time.sleep(0.005)
    return time.monotonic() - since_s


def play(fleet: Supervisor, news: News, *, seconds: float, began_s: float, stop: threading.Event) -> None:
    """Move all arms, kill one, and tell what came of it."""
    if not fleet.wait_up(UP_S):
        raise ToolError("not all arms came: their states are in the table")
    news.say(fleet.fleet.name, f"{len(fleet.robots)} arms are up after {time.monotonic() - began_s:.1f} s")
    with ExitStack() as stack:
        arms = {name: Arm(_opened(stack, fleet.fleet, name)) for name in fleet.robots}
        done = threading.Event()
        threads = [threading.Thread(target=move, args=(arm, done)) for arm in arms.values()]
        for thread in threads:
            thread.start()
        stop.wait(seconds / 3)
        if not stop.is_set():
            kill(fleet, news, KILLED)
            stop.wait(max(1.0, began_s + seconds - time.monotonic()))
        done.set()
        for thread in threads:
            thread.join()
    others = [arm for name, arm in arms.items() if name != KILLED]
    news.say(
        KILLED, f"{arms[KILLED].moves} set-points written, {arms[KILLED].missed} missed while it was away"
    )
    news.say(
        "the others",
        f"{sum(arm.moves for arm in others)} written, {sum(arm.missed for arm in others)} missed",
    )


def _opened(stack: ExitStack, fleet: Fleet, name: str) -> ZenohLink:
    key = next(robot.key for robot in fleet.robots if robot.name == name)
    link = stack.enter_context(connect(f"zenoh:{key}?name=demo&connect={fleet.network().connect}"))
    assert isinstance(link, ZenohLink)
    return link


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--seconds", type=float, default=60.0, metavar="S", help="in all (%(default)g)")
    parser.add_argument("--router", metavar="LOCATOR", help="where the network's router listens")
    options = parser.parse_args()
    fleet = read_fleet(FLEET)
    if options.router is not None:
        fleet = replace(fleet, router=options.router)
    news = News()
    began_s = time.monotonic()
    print("Eight SCARAs, each on a virtual board behind a bridge of its own.", flush=True)
    failed: list[ToolError] = []
    with stopped_by_signals() as stop, Supervisor(fleet, news.say, start_bridge) as supervisor:

        def work() -> None:
            try:
                play(supervisor, news, seconds=max(options.seconds, LEAST_S), began_s=began_s, stop=stop)
            except ToolError as error:
                failed.append(error)
            stop.set()

        worker = threading.Thread(target=work)
        worker.start()
        show(supervisor, news, stop)
        worker.join()
        table = supervisor.reports()
    for error in failed:
        raise error
    for line in () if news.quiet else plain_table(HEADERS, rows(table), right=RIGHT):
        print(line)
    return 0


if __name__ == "__main__":
    run_program(main, name="fleet")
