# SPDX-License-Identifier: BSD-3-Clause
"""The 18-DOF walker walks.

Each set of 18 set-points is one burst and one commit, and all joints are published.

    python examples/walker18/run.py                                # the published language, a virtual board
    python examples/walker18/run.py --spec walker18_si.ul          # the same robot in engineering units
    python examples/walker18/run.py --link "serial:/dev/ttyUSB0?baud=3000000"

Where MuJoCo is installed, the virtual board has a model with masses and contacts: the feet push, and the body
moves. The exit code is 1 if the walker did not get as far as its steps should have brought it.
"""

from __future__ import annotations

import argparse
import importlib.util
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from gait import LIFT, STRIDE, Array, angles, feet_at, foot_of, grounded, travelled

from unitylink import Link, LinkTimeout, connect
from unitylink.layer4_data import Node, Snapshot, ValueGroup, load_spec_objects
from unitylink.program import run_program
from unitylink.spec import load

HERE = Path(__file__).resolve().parent
PERIOD_S = 0.02  # time from one set-point to the next
CYCLE_S = 1.2
RISE_STEPS = 10
SETTLE_S = 0.6
JOINTS = ("hip", "knee", "foot")
MOST_SLIP = 0.1  # of the way that the body of a model should have come


@dataclass(frozen=True)
class Run:
    """The set-points and the published values: angles (n, 6, 3) in rad, times (n,) in s from the start."""

    legs: tuple[str, ...]
    asked_s: Array
    asked: Array
    measured_s: Array
    measured: Array
    cycles: int
    lost: int
    body_m: float | None  # how far the body of a model came, None without one

    @property
    def feet(self) -> Array:
        return foot_of(self.measured)

    @property
    def distance_m(self) -> float:
        return float(travelled(self.feet)[-1])

    @property
    def expected_m(self) -> float:
        return 2 * STRIDE * self.cycles

    def tracking_error(self) -> Array:
        """Return measured minus set-point at each publish, (n, 6, 3)."""
        index = np.maximum(np.searchsorted(self.asked_s, self.measured_s, side="right") - 1, 0)
        error: Array = self.measured - self.asked[index]
        return error


class Walker:
    """The robot in radians, whatever unit the spec has. A spec without units counts milliradians."""

    def __init__(self, node: Node) -> None:
        set_points, positions = node["sp"], node["pos"]
        assert isinstance(set_points, ValueGroup) and isinstance(positions, ValueGroup)
        self.set_points, self.positions = set_points, positions
        self.legs = tuple(dict.fromkeys(path.rpartition(".")[0] for path in positions.values))
        units = {value.unit for value in node}
        if len(self.legs) != 6 or units not in ({""}, {"rad"}):
            raise SystemExit(
                f"the spec has {len(self.legs)} legs in units {units}; six in rad or counts are meant"
            )
        self.counts = units == {""}

    def write(self, joints: Array) -> None:
        """Send (6, 3) set-points: one burst, one commit. So no leg is ever half a step ahead."""
        targets: dict[str, float] = {}
        for leg, of_leg in zip(self.legs, joints, strict=True):
            for joint, angle in zip(JOINTS, of_leg, strict=True):
                targets[f"{leg}.{joint}_sp"] = round(angle * 1000) if self.counts else angle
        self.set_points.write(targets)

    def angles_in(self, snapshot: Snapshot) -> Array:
        """Return the (6, 3) positions of one publish."""
        found = np.array([[snapshot[f"{leg}.{joint}"] for joint in JOINTS] for leg in self.legs], float)
        return found / 1000 if self.counts else found


def walk(node: Node, link: Link, cycles: int) -> Run:
    """Stand up, walk, stand. Keep everything that is published."""
    walker = Walker(node)
    samples: list[tuple[float, Snapshot]] = []
    asked_s: list[float] = []
    asked: list[Array] = []
    with node.publishing():
        walker.positions.on_publish(lambda time_s, values: samples.append((time_s, values)))
        walker.write(angles(feet_at(0.25, lift=0.0)))  # the phase at which all feet are below their hips
        start = link.now_s() + SETTLE_S
        link.sleep_until(start)
        samples.clear()
        began = body_of(link)
        due = start
        steps = round(cycles * CYCLE_S / PERIOD_S)
        for step in range(steps + round(SETTLE_S / PERIOD_S)):
            due = max(due + PERIOD_S, link.now_s())  # a late program walks slower, but does not jump
            link.sleep_until(due)
            at = min(step + 1, steps)
            # at both ends of the walk, all six feet are on the ground
            lift = LIFT * min(1.0, at / RISE_STEPS, (steps - at) / RISE_STEPS)
            joints = angles(feet_at(0.25 + at * PERIOD_S / CYCLE_S, lift=lift))
            walker.write(joints)
            asked_s.append(link.now_s() - start)
            asked.append(joints)
        lost = sum(report.lost for report in node.publisher.reports())
        ended = body_of(link)
    if len(samples) < 2:
        raise LinkTimeout(f"{len(samples)} publishes came in {asked_s[-1]:.1f} s", item="walker18")
    return Run(
        legs=walker.legs,
        asked_s=np.array(asked_s),
        asked=np.array(asked),
        measured_s=np.array([time_s for time_s, _ in samples]) - start,
        measured=np.array([walker.angles_in(values) for _, values in samples]),
        cycles=cycles,
        lost=lost,
        body_m=None if began is None or ended is None else float(ended[0] - began[0]),
    )


def body_of(link: Link) -> Array | None:
    """Return where the body of a model in MuJoCo is, x, y and z, or None without one."""
    data = getattr(getattr(link.board, "plant", None), "data", None)
    return None if data is None else np.array(data.sensor("body_at").data)


def has_mujoco() -> bool:
    return importlib.util.find_spec("mujoco") is not None


def told(link: Link) -> str:
    """Say what moves behind the link."""
    if link.board is None:
        return "hardware"
    if body_of(link) is not None:
        return "in MuJoCo, with the masses and contacts of walker18.xml"
    return "servos without a body" + ("" if has_mujoco() else " (MuJoCo is not installed)")


def tell(run: Run) -> bool:
    """Print what happened. Return whether the walker got there."""
    error_mrad = 1e3 * run.tracking_error()
    rate_hz = (len(run.measured_s) - 1) / (run.measured_s[-1] - run.measured_s[0])
    print(f"  set-points: {len(run.asked_s)}, each of 18 servos in one burst and one commit")
    print(f"  publishes: {len(run.measured_s)} of 18 positions at {rate_hz:.1f} Hz, {run.lost} lost")
    print(f"  joints: {np.sqrt(np.mean(error_mrad**2)):.0f} mrad rms behind their set-points while walking")
    carrying = grounded(run.feet).sum(axis=1)
    print(f"  feet on the ground: at least {carrying.min()}")
    print(f"  walked {run.distance_m * 1e3:.0f} mm, asked {run.expected_m * 1e3:.0f} mm")
    there = abs(run.distance_m - run.expected_m) < 0.6 * STRIDE  # the first and the last step are short
    if run.body_m is not None:
        slip = 1 - run.body_m / run.distance_m
        print(
            f"  the body came {run.body_m * 1e3:.0f} mm in MuJoCo; the feet slipped {slip:.1%} of their way"
        )
        there = there and abs(slip) < MOST_SLIP
    still = np.abs(run.measured[-1] - run.asked[-1]).max() < 0.02
    return bool(there and still and carrying.min() >= 3)


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--spec", type=Path, default=Path("walker18.ul"), metavar="FILE", help="which spec")
    parser.add_argument("--link", metavar="URL", help="board to drive (a virtual one)")
    parser.add_argument("--rtl", action="store_true", help="the virtual board is the VHDL, compiled")
    parser.add_argument(
        "--simple", action="store_true", help="walk without MuJoCo, also where it is installed"
    )
    parser.add_argument("--cycles", type=int, default=4, metavar="N", help="how far: N times two steps")
    parser.add_argument("--picture", type=Path, metavar="PNG", help="save the walk there")
    options = parser.parse_args()
    file = options.spec if options.spec.exists() else HERE / options.spec
    model = HERE / f"{file.stem}.toml"
    with_model = has_mujoco() and model.is_file() and not options.simple
    plant = f"mujoco:{model}" if with_model else str(HERE / "plant.py")
    url = options.link or f"{'rtl' if options.rtl else 'sim'}:{file}?plant={plant}&timeout=1"
    spec = load(file)
    with connect(url) as link:
        print(f"{file.name}: {sum(1 for _ in spec.walk())} words; {told(link)}; walking:")
        run = walk(load_spec_objects(spec, link), link, options.cycles)
    there = tell(run)
    if options.picture:
        from picture import save  # imported only here, because walking does not need matplotlib

        save(run, options.picture)
        print(f"  picture: {options.picture}")
    print("\nThe walker is there." if there else "\nThe walker did not get there.")
    return 0 if there else 1


if __name__ == "__main__":
    run_program(main, name="walker18")
