# SPDX-License-Identifier: BSD-3-Clause
"""The time of a virtual board in steps, on the topic /clock. Nodes with use_sim_time follow it."""

from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING

from unitylink.errors import LinkError

from .interface import Topic

if TYPE_CHECKING:
    from unitylink.layer2_message import Link

    from .plane import Plane, Port

CLOCK = Topic("/clock", "rosgraph_msgs/Clock", "record", (), queue=1, reliable=False)
STEP_S = 0.01  # of robot time, from one message to the next
MOST_LATE_S = 0.2  # a machine that is later does not try to catch up


class SimClock:
    """Lets the time of a board pass, `speed` times as fast as real time, and publishes it, until `close`.

    With a speed of 0 it passes as fast as the machine can. The callbacks of the link are called here.
    """

    def __init__(self, link: Link, plane: Plane, port: Port, speed: float) -> None:
        self._link, self._plane, self._port, self._speed = link, plane, port, speed
        self._stop = threading.Event()
        self._make = plane.maker(CLOCK.type, ("clock",))
        plane.stamps.follow(link.now_s)
        self._thread = threading.Thread(target=self._run, name="unitylink-ros-clock", daemon=True)

    def start(self) -> None:
        self._thread.start()

    def close(self) -> None:
        """Let no more time pass. Stamps are those of this computer again."""
        self._stop.set()
        if self._thread.is_alive() and self._thread is not threading.current_thread():
            self._thread.join()
        self._plane.stamps.follow(None)

    def _run(self) -> None:
        due_s = time.monotonic()
        try:
            while not self._stop.is_set():
                self._link.step(STEP_S)
                self._port.send(self._make(self._plane.time(self._link.now_s())))
                self._plane.life.beat("the thread of the simulated time")
                if self._speed:
                    due_s = max(due_s + STEP_S / self._speed, time.monotonic() - MOST_LATE_S)
                    self._stop.wait(max(0.0, due_s - time.monotonic()))
        except LinkError:  # the keeper sees that the link has ended, and says why
            return
        finally:
            self._plane.life.rest()
