# SPDX-License-Identifier: BSD-3-Clause
"""The paper's SCARA robot moves: from the spec to measured joint paths, with a virtual board or a real one.

    python examples/scara/run.py                                             # a virtual board, in process
    python examples/scara/run.py --rtl                                       # the gateware's VHDL, compiled
    python examples/scara/run.py --link "serial:/dev/ttyUSB0?baud=3000000"   # the robot itself

Four joints follow a path. Each set-point is one burst and one commit on the TosNet network. The positions
come back as isochronous publishes at 100 Hz. Where MuJoCo is installed, the arm of a virtual board has the
masses of a model. The exit code is 1 if the robot did not reach its target.
"""

from __future__ import annotations

import argparse
import importlib.util
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from kinematics import JOINTS, Array, Joint
from path import demonstration

from unitylink import Link, LinkTimeout, connect
from unitylink.generate import write
from unitylink.layer3_hardware import TosNetProxy
from unitylink.layer4_data import Snapshot, ValueGroup
from unitylink.program import run_program
from unitylink.spec import load

if TYPE_CHECKING:
    from scara import Scara

    from unitylink.simulate import Board

HERE = Path(__file__).resolve().parent
SPEC = HERE / "scara.ul"
MODEL = HERE / "scara.toml"
PERIOD_S = 0.02  # time from one set-point to the next
SPEED_LIMIT = (180.0, 240.0, 250.0, 400.0)  # per joint, in its unit per second
SETTLE_S = 2.0  # time to reach the last set-point
TOLERANCE = 0.1  # deg or mm; within this, the robot is there


@dataclass(frozen=True)
class Run:
    """The set-points and the measured values.

    Times are in s from the start, positions in deg, deg, mm, deg.
    """

    phases: tuple[tuple[str, float], ...]  # (name, time at which it began)
    asked_s: Array
    asked: Array
    measured_s: Array
    measured: Array
    lost: int
    rate_hz: float
    snapshot: Array

    def asked_at(self, times_s: Array) -> Array:
        """Return the set-points in force at these times, shape (n, 4)."""
        index = np.searchsorted(self.asked_s, times_s, side="right") - 1
        return np.where(index[:, None] < 0, self.asked[0], self.asked[np.maximum(index, 0)])

    def tracking_error(self) -> Array:
        """Return measured minus set-point at each publish, shape (n, 4)."""
        error: Array = self.measured - self.asked_at(self.measured_s)
        return error

    def final_error(self) -> Array:
        error: Array = self.snapshot - self.asked[-1]
        return error


def make_robot(link: Link, folder: Path) -> Scara:
    """Compile the spec, generate the proxies into `folder`, and make the robot's object from them."""
    spec = load(SPEC)
    write(spec, folder)
    file = folder / "scara.py"
    found = importlib.util.spec_from_file_location("scara", file)
    assert found is not None and found.loader is not None
    module = importlib.util.module_from_spec(found)
    found.loader.exec_module(module)
    words = sum(1 for _ in spec.walk())
    print(f"compiled {SPEC.name} ({words} words), generated {file.name} (spec {spec.hash})")
    robot: Scara = module.Scara(link)
    return robot


def drive(robot: Scara, link: Link) -> Run:
    """Stream the demonstration's set-points, and keep the published values."""
    parts = (robot.j1, robot.j2, robot.j3, robot.j4)
    set_points = ValueGroup([part.pos_sp for part in parts], "set-points")
    ValueGroup([part.spd_sp for part in parts], "speed limits").write(
        [joint.counts(limit) for joint, limit in zip(JOINTS, SPEED_LIMIT, strict=True)]
    )
    asked_s: list[float] = []
    asked: list[Array] = []
    phases: list[tuple[str, float]] = []
    samples: list[tuple[float, Snapshot]] = []
    with robot.publishing():
        robot.on_publish(lambda time_s, values: samples.append((time_s, values)))
        start = due = link.now_s()
        for phase, positions in demonstration(PERIOD_S):
            phases.append((phase, link.now_s() - start))
            print(f"  {phases[-1][1]:5.2f} s  {phase}", flush=True)
            for position in positions:
                due += PERIOD_S
                link.sleep_until(due)
                set_points.write([j.counts(p) for j, p in zip(JOINTS, position, strict=True)])
                asked_s.append(link.now_s() - start)
                asked.append(position)
        snapshot = wait_until_there(robot, link, asked[-1])
        reports = robot.publisher.reports()
    if len(samples) < 2:
        raise LinkTimeout(f"{len(samples)} publishes came in {asked_s[-1]:.1f} s", item="scara")
    return Run(
        phases=tuple(phases),
        asked_s=np.array(asked_s),
        asked=np.array(asked),
        measured_s=np.array([time_s for time_s, _ in samples]) - start,
        measured=np.array([positions_in(values) for _, values in samples]),
        lost=sum(report.lost for report in reports),
        rate_hz=reports[0].rate_hz,
        snapshot=snapshot,
    )


def positions_in(values: Snapshot) -> Array:
    """Return the four joint positions of one snapshot, in deg, deg, mm, deg."""
    return np.array([values[f"{joint.name}.cpos"] / joint.counts_per_unit for joint in JOINTS])


def wait_until_there(robot: Scara, link: Link, target: Array) -> Array:
    """Wait until all joints are there or the time is over. Return their positions, from one snapshot."""
    deadline = link.now_s() + SETTLE_S
    while True:
        there = positions_in(robot.snapshot())
        if np.all(np.abs(there - target) <= TOLERANCE) or link.now_s() >= deadline:
            return there
        link.sleep_until(link.now_s() + PERIOD_S)


def tell(run: Run) -> bool:
    """Print what happened in terms of the robot. Return whether it reached its target."""
    error = run.tracking_error()
    print("\n  joint          set-point   reached     error    on the way: rms, largest")
    for column, joint in enumerate(JOINTS):
        rms, largest = np.sqrt(np.mean(error[:, column] ** 2)), np.max(np.abs(error[:, column]))
        print(
            f"  {joint.name} {joint.role:<9} {run.asked[-1, column]:9.2f} {run.snapshot[column]:9.2f} "
            f"{run.final_error()[column]:+9.3f}    {rms:6.2f}, {largest:6.2f} {joint.unit}"
        )
    gaps_ms = np.diff(run.measured_s) * 1e3
    print(
        f"\n  publishes: {len(run.measured_s)} received at {1e3 / np.mean(gaps_ms):.1f} Hz "
        f"(asked {run.rate_hz:g} Hz), {run.lost} lost, arrival jitter {np.std(gaps_ms):.2f} ms"
    )
    print(f"  set-points: {len(run.asked_s)}, each of 4 joints in one burst and one commit")
    late = [describe(j, e) for j, e in zip(JOINTS, run.final_error(), strict=True) if abs(e) > TOLERANCE]
    moved = np.ptp(run.measured, axis=0)
    still = [joint.name for joint, way in zip(JOINTS, moved, strict=True) if way < 1.0]
    for trouble in [*late, *(f"{name} never moved" for name in still)]:
        print(f"  {trouble}", file=sys.stderr)
    return not late and not still


def tell_times(board: Board, real_s: float) -> None:
    """Print the robot's time, which is the board's own, beside real time."""
    clock_hz, time_s = board.configuration.clock_hz, board.time_s
    clocks = f"{time_s * clock_hz:,.0f} clocks of {clock_hz / 1e6:g} MHz"
    print(f"  robot time {time_s:.2f} s ({clocks}), real time {real_s:.2f} s")


def describe(joint: Joint, error: float) -> str:
    return f"{joint.name} ({joint.role}) is {abs(error):.2f} {joint.unit} from its set-point"


def has_mujoco() -> bool:
    return importlib.util.find_spec("mujoco") is not None


def told(link: Link) -> str:
    """Say what moves behind the link."""
    plant = type(getattr(link.board, "plant", None)).__name__
    return {
        "MujocoPlant": "in MuJoCo, with the masses of examples/dashboard/arm.xml",
        "ScaraPlant": "four joints with inertia" + ("" if has_mujoco() else " (MuJoCo is not installed)"),
    }.get(plant, "hardware")


def main() -> int:
    parser = argparse.ArgumentParser(
        description=(__doc__ or "").partition("\n")[0],
        epilog='example: run.py --link "tcp://192.168.1.10:5555" --picture scara.png',
    )
    parser.add_argument("--link", metavar="URL", help="board to drive (a virtual one)")
    parser.add_argument(
        "--rtl", action="store_true", help="drive the VHDL itself, compiled: half a minute the first time"
    )
    parser.add_argument(
        "--simple", action="store_true", help="move without MuJoCo, also where it is installed"
    )
    parser.add_argument("--classic", action="store_true", help="speak the classic protocol, not frames")
    parser.add_argument("--picture", type=Path, metavar="PNG", help="save the joint paths there")
    parser.add_argument(
        "--build",
        type=Path,
        default=Path("build") / "scara",
        metavar="DIR",
        help="where the proxies are generated (%(default)s)",
    )
    options = parser.parse_args()
    plant = f"mujoco:{MODEL}" if has_mujoco() and not options.simple else "scara"
    url = options.link or f"{'rtl' if options.rtl else 'sim'}:{SPEC}?plant={plant}"
    if options.classic:
        url += ("&" if "?" in url else "?") + "protocol=classic"
    with connect(url) as link:
        started = time.monotonic()
        robot = make_robot(link, options.build)
        network = robot.j1.pos_sp.hardware
        assert isinstance(network, TosNetProxy)  # the spec says TOSNET
        nodes = ", ".join(str(node.node_id) for node in network.nodes())
        print(f"protocol: {link.protocol}")
        print(f"TosNet: {network.status()}; nodes in the ring: {nodes}")
        print(f"moving, {told(link)}:")
        run = drive(robot, link)
        if link.board is not None:
            tell_times(link.board, time.monotonic() - started)
    there = tell(run)
    if options.picture:
        from picture import save  # imported only here, because moving a robot does not need matplotlib

        save(run, options.picture)
        print(f"  picture: {options.picture}")
    print("\nThe robot is home again." if there else "\nThe robot did not get there.")
    return 0 if there else 1


if __name__ == "__main__":
    run_program(main, name="scara")
