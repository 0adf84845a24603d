# SPDX-License-Identifier: BSD-3-Clause
"""A SCARA behind a dashboard. It moves by itself, and people can watch it, stop it and take control of it.

    python examples/dashboard/run.py
    python examples/dashboard/run.py --listen 8080 --link "serial:/dev/ttyUSB0?baud=3000000"

The program is one user of the robot among others. It takes control, sends a set-point every 20 ms, and gives
signs of life. If somebody takes control away, it waits until the robot is free again.
"""

from __future__ import annotations

import argparse
import math
import threading
import time
from pathlib import Path

from unitylink import connect
from unitylink.dashboard.body.joint_values import with_values
from unitylink.dashboard.body.urdf import read_urdf
from unitylink.dashboard.desk import Desk, now
from unitylink.dashboard.extras import Extras
from unitylink.dashboard.opening import open_dashboard
from unitylink.dashboard.place import read_place
from unitylink.errors import AccessRefused, LeaseHeld, LinkError
from unitylink.program import run_program, stopped_by_signals
from unitylink.server.gate import Client
from unitylink.server.scopes import Rights
from unitylink.server.tokens import Tokens, User, digest, new_token
from unitylink.spec import load

SPEC = Path(__file__).resolve().parent / "arm.ul"
PERIOD_S = 0.02  # from one set-point to the next
POLITE_S = 5.0  # how long the robot is left to others after they have had it
SPEED = 200.0  # deg/s and mm/s
WAYS = {  # item: middle, half of the way, seconds of one cycle
    "j1.pos_sp": (0.0, 60.0, 8.0),
    "j2.pos_sp": (40.0, 50.0, 5.0),
    "j3.pos_sp": (60.0, 40.0, 6.0),
    "j4.pos_sp": (0.0, 170.0, 12.0),
}


def place_at(time_s: float) -> dict[str, float]:
    """Return the set-points of a moment."""
    return {
        path: middle + half * math.sin(2 * math.pi * time_s / cycle_s)
        for path, (middle, half, cycle_s) in WAYS.items()
    }


class Mover:
    """Moves the robot while it has control."""

    def __init__(self, desk: Desk, client: Client) -> None:
        self._desk, self._client = desk, client
        self._moved_s = 0.0  # how far it is on its way, which stands still while others have the robot

    def step(self) -> float:
        """Send one set of set-points. Return how long to wait until the next one."""
        try:
            if not self._holds():
                with self._desk.gate() as gate:
                    gate.take(self._client, "", 1.0, now())
                self._desk.write(self._client, {f"j{joint}.spd_sp": SPEED for joint in (1, 2, 3, 4)})
            with self._desk.gate() as gate:
                gate.renew(self._client, now())
            self._desk.write(self._client, place_at(self._moved_s))
        except (LeaseHeld, AccessRefused):  # others have it, or somebody has stopped it
            return POLITE_S
        except LinkError as error:
            print(f"the board does not answer: {error}")
            return POLITE_S
        self._moved_s += PERIOD_S
        return PERIOD_S

    def _holds(self) -> bool:
        with self._desk.gate() as gate:
            return gate.leases.may_write(self._client.number, "j1.pos_sp", now().steady_s)


def move(desk: Desk, token: str, stop: threading.Event) -> None:
    """Move the robot until `stop`."""
    with desk.gate() as gate:
        client = gate.login(token, "this program", now())
    mover = Mover(desk, client)
    due_s = time.monotonic()
    while not stop.wait(max(0.0, due_s - time.monotonic())):
        due_s = max(due_s, time.monotonic() - PERIOD_S) + mover.step()
    with desk.gate() as gate:
        gate.logout(client, now())


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--link", default=f"sim:{SPEC}?plant=scara", metavar="URL", help="board to serve")
    parser.add_argument("--listen", default="127.0.0.1:0", metavar="[HOST:]PORT", help="where (%(default)s)")
    parser.add_argument("--seconds", type=float, metavar="S", help="end after this time")
    options = parser.parse_args()
    person, program = new_token(), new_token()
    tokens = Tokens(
        [
            (digest(person), User("you", Rights.of(["admin"]))),
            (digest(program), User("demo", Rights.of(["read", "write"]))),
        ]
    )
    spec, place = load(SPEC), read_place(options.listen)
    body = with_values(read_urdf(SPEC.with_suffix(".urdf")), spec.root())
    extras = Extras(text=SPEC.read_text("utf-8"), body=body)
    with (
        stopped_by_signals() as stop,
        connect(options.link) as link,
        open_dashboard(link, spec, tokens, lambda _: None, place=place, extras=extras) as page,
    ):
        print(
            f"The SCARA moves. Open this page, with Ctrl-C as the end:\n\n  {page.url}/#token={person}\n",
            flush=True,
        )
        mover = threading.Thread(target=move, args=(page.station.desk, program, stop))
        mover.start()
        stop.wait(options.seconds)
        stop.set()
        mover.join()
        for report in page.station.feed.reports():
            print(f"{report['paths'][0]} and {len(report['paths']) - 1} more: {report['received']} received")
    return 0


if __name__ == "__main__":
    run_program(main, name="dashboard")
