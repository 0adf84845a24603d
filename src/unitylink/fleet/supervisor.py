# SPDX-License-Identifier: BSD-3-Clause
"""Runs a fleet: the router if it has none, a bridge process for each robot, and what is told of them."""

from __future__ import annotations

import contextlib
import json
import threading
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from unitylink.errors import LinkBusy, LinkNotFound

from .bridge_process import START_S, BridgeProcess, Running
from .description import ROBOT_PREFIX, Fleet, FleetRobot
from .report import RobotReport, report_of
from .roll_call import RollCall
from .specs import SpecStore

if TYPE_CHECKING:
    import zenoh

Start = Callable[[Sequence[str], Path], Running]
TICK_S = 0.1  # how often processes are looked at
ASK_S = 1.0  # how often bridges are asked for their states
_OTHERS_S = 0.5  # how long another program that runs this fleet has to answer


class Supervisor:
    """Runs `fleet` until `close`. `say` gets what happens, with the name of the robot.

    `start` starts `unitylink WORDS` in a folder; the words are those of `unitylink bridge zenoh`.

    Raises LinkBusy if another program runs a fleet of this name on the network, and what the session raises.
    """

    def __init__(self, fleet: Fleet, say: Callable[[str, str], None], start: Start) -> None:
        self.fleet = fleet
        self._start = start
        self._say = say
        self._ended = threading.Event()
        # The keys of boards that have come or gone since their bridges were asked.
        self._news: set[str] = set()
        self._lock = threading.Lock()  # guards the processes
        with contextlib.ExitStack() as stack:
            self._specs = stack.enter_context(SpecStore(fleet))
            self._router = stack.enter_context(self._opened_router()) if fleet.is_router else None
            self._session: zenoh.Session = self._router or stack.enter_context(fleet.network().opened())
            self._refuse_second(self._session)
            told = self._session.declare_queryable(state_key(fleet.name), self._tell)
            stack.callback(told.undeclare)
            self._call = RollCall(self._session, [one.key for one in fleet.robots], self._heard)
            stack.callback(self._call.close)
            self.robots = {one.name: one for one in fleet.robots}
            self._up = dict.fromkeys(self.robots, False)
            self._words = {one.name: self.words(one) for one in fleet.robots}
            self._processes = {one.name: self._process(one) for one in fleet.robots}
            self._thread = threading.Thread(target=self._govern, name="fleet", daemon=True)
            self._thread.start()
            stack.callback(self._end)
            self._closing = stack.pop_all()

    def __enter__(self) -> Supervisor:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End all bridges in order, then the router."""
        self._closing.close()

    def reports(self) -> list[RobotReport]:
        """Return what is known of all robots now, in the order of the description."""
        now_s = time.monotonic()
        with self._lock:
            processes = {name: self._told(name, now_s) for name in self.robots}
        return [
            report_of(robot, self._call.of(robot.key), processes[name]) for name, robot in self.robots.items()
        ]

    def state(self) -> dict[str, Any]:
        """Return what only this program knows: its processes, by the name of the robot."""
        now_s = time.monotonic()
        with self._lock:
            processes = {name: self._told(name, now_s) for name in self.robots}
        return {"fleet": self.fleet.name, "robots": processes}

    def wait_up(self, timeout_s: float) -> bool:
        """Wait until all boards answer and their bridges have told their states. Return whether they have."""
        limit_s = time.monotonic() + timeout_s
        while not all(
            (one := self._call.of(robot.key)).reachable and one.known for robot in self.robots.values()
        ):
            if time.monotonic() > limit_s or self._ended.wait(TICK_S):
                return False
        return True

    # ---- processes

    def _process(self, robot: FleetRobot) -> BridgeProcess:
        words = self._words[robot.name]
        return BridgeProcess(
            lambda: self._start(words, self.fleet.folder), lambda text: self._say(robot.name, text)
        )

    def differs(self, robot: FleetRobot) -> bool:
        """Whether the bridge of a robot would be started with other words now. Raises FleetError."""
        return self.words(robot) != self._words[robot.name]

    def wanted_hash(self, robot: FleetRobot) -> str:
        """Return the hash of the spec that the file of a robot has now. Raises FleetError."""
        return self._specs.hash(robot)

    def change(self, robot: FleetRobot) -> list[str]:
        """Start the bridge of a robot anew, as described. Return the words that it had. Raises FleetError."""
        old = self._words[robot.name]
        self.change_back(robot, self.words(robot))
        return old

    def change_back(self, robot: FleetRobot, words: list[str]) -> None:
        """Start the bridge of a robot anew, with these words."""
        with self._lock:
            self.robots[robot.name], self._words[robot.name] = robot, words
            self._processes[robot.name].replace(lambda: self._start(words, self.fleet.folder))

    def words(self, robot: FleetRobot) -> list[str]:
        """Return the words that start the bridge of a robot as described now. Raises FleetError."""
        fleet = self.fleet
        link, spec = self._specs.taken(robot)
        words = ["bridge", "zenoh", link, *([spec] if spec else []), "--key", robot.key]
        if robot.root:
            words += ["--root", robot.root]
        if fleet.security:
            words += ["--zenoh-config", fleet.secret(f"{ROBOT_PREFIX}{robot.name}")]
        elif fleet.zenoh_config:
            words += ["--zenoh-config", str(fleet.place(fleet.zenoh_config))]
        else:
            words += ["--connect", fleet.network().connect]
        for scope in robot.may:
            words += ["--may", scope]
        stops = fleet.place(fleet.stops) if fleet.stops else self._specs.folder
        stops.mkdir(parents=True, exist_ok=True)
        words += ["--stop-file", str(stops / f"{robot.name}.stop")]
        if fleet.audit:
            folder = fleet.place(fleet.audit)
            folder.mkdir(parents=True, exist_ok=True)
            words += ["--audit", str(folder / f"{robot.name}.log")]
        return words

    def _govern(self) -> None:
        asked_s = 0.0
        while not self._ended.wait(TICK_S):
            now_s = time.monotonic()
            # Without a router, this program hears nobody. That is no fault of the bridges.
            deaf = self._router is None and not self._session.info.routers_zid()
            with self._lock:
                for name, process in self._processes.items():
                    bridges = self._call.of(self.robots[name].key).bridges
                    process.look(now_s, on_network=deaf or bool(bridges), may_kill=self._may_kill(now_s))
            if now_s - asked_s >= ASK_S:
                asked_s = now_s
                self._call.ask(ASK_S)
            elif self._news:
                news, self._news = self._news, set()
                self._call.ask(ASK_S, news)

    def _may_kill(self, now_s: float) -> bool:
        """Whether no bridge that was killed is on its way back. If many are silent, it is not their fault."""
        killed = (process.killed_s for process in self._processes.values())
        return all(at_s is None or now_s > at_s + START_S for at_s in killed)

    def _end(self) -> None:
        self._ended.set()
        self._thread.join()
        for process in self._processes.values():
            process.ask_to_end()  # all at once, then wait for each
        for process in self._processes.values():
            process.end()

    def _told(self, name: str, now_s: float) -> dict[str, Any]:
        process = self._processes[name]
        return {
            "restarts": process.restarts,
            "pid": process.pid,
            "uptime_s": round(process.uptime_s(now_s), 1),
            "trouble": process.trouble,
            "spec": self.robots[name].spec,
        }

    # ---- the network

    def _opened_router(self) -> zenoh.Session:
        """Be the router. If the place is taken, tell whether a fleet of this name has it."""
        fleet = self.fleet
        try:
            return fleet.router_network().opened()
        except LinkNotFound as error:
            if not fleet.security:  # else only somebody with a name could ask
                with contextlib.suppress(LinkNotFound), fleet.network().opened() as session:
                    self._refuse_second(session)
            remedy = f"end what is there, or change router below [fleet] in {fleet.file}"
            if fleet.security:
                remedy = f"are the certificates there (make_certificates.sh)? If so, {remedy}"
            raise LinkNotFound(f"{error}; {remedy}") from None

    def _refuse_second(self, session: zenoh.Session) -> None:
        for reply in session.get(state_key(self.fleet.name), timeout=_OTHERS_S):
            if reply.ok is not None:
                raise LinkBusy(
                    f"another program runs the fleet {self.fleet.name} on this network; end it, or give this "
                    f"fleet another name below [fleet] in {self.fleet.file}"
                )

    def _tell(self, query: zenoh.Query) -> None:
        query.reply(state_key(self.fleet.name), json.dumps(self.state()))

    def _heard(self, key: str) -> None:
        """Say when a board comes or goes. A thread of Zenoh calls this."""
        for name, robot in getattr(self, "robots", {}).items():
            if robot.key == key:
                up = self._call.of(key).reachable
                if up != self._up[name] and not self._ended.is_set():
                    self._up[name] = up
                    self._news.add(key)
                    self._say(name, "up" if up else "gone from the network")


def state_key(fleet: str) -> str:
    """Return the key at which the program that runs a fleet tells its processes.

    No robot's key has an `@`, and no wildcard of Zenoh matches it.
    """
    return f"{fleet}/@fleet/state"
