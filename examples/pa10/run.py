# SPDX-License-Identifier: BSD-3-Clause
"""Two PA10 arms, each on its own link, move as one robot: hand in hand around a loop.

    python examples/pa10/run.py                                    # our language: one spec, two links
    python examples/pa10/run.py --spec pa10.ul                     # the published one: a spec for each arm
    python examples/pa10/run.py --left tcp://192.168.1.10:5555 --right tcp://192.168.1.11:5555

The set-points of all fourteen joints are one write: a burst and a commit on each link, at the same time.
Where MuJoCo is installed, both virtual boards move one model, and the arms carry a box around the loop
between their hands. The exit code is 1 if an arm did not get home, the hands did not stay together, or the
box fell.
"""

from __future__ import annotations

import argparse
import importlib.util
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from arm import HANDS_APART, REST, Array, demonstration, hands_apart

from unitylink import Link, LinkTimeout, connect
from unitylink.layer4_data import Node, Snapshot, Value, ValueGroup, load_spec_objects
from unitylink.program import run_program
from unitylink.spec import load
from unitylink.spec.model import Spec

HERE = Path(__file__).resolve().parent
MODEL = HERE / "pa10_pair.toml"
PERIOD_S = 0.02  # time from one set-point to the next
SETTLE_S = 2.0
COUNT = 0.0001  # rad for each count of pa10.ul
SIDES = ("left", "right")
LIFTED_M, BACK_M = 0.25, 0.08  # how high the box comes at least, and how far from its place it stands at most


@dataclass(frozen=True)
class Run:
    """The set-points and the published values: angles (n, 2, 7) in rad, times (n,) in s from the start."""

    asked_s: Array
    asked: Array
    measured_s: Array
    measured: Array
    home: Array  # (2, 7), read at the end, because publishes may still wait for their callback then
    lost: int
    apart_us: float  # time between the two links' parts of one snapshot
    box: Array | None  # where the box of a model was at each set-point and at the end, None without one

    def asked_at_publishes(self) -> Array:
        """Return the set-points in force at each publish, (n, 2, 7)."""
        index = np.searchsorted(self.asked_s, self.measured_s, side="right") - 1
        asked: Array = self.asked[np.maximum(index, 0)]
        return asked


class Pair:
    """Both arms in radians, with either of the two specs."""

    def __init__(self, spec: Spec, links: dict[str, Link]) -> None:
        self.link = links[SIDES[0]]  # this link gives the time
        self.nodes: list[Node] = []
        for side in SIDES:
            root = f"{side}_arm" if len(spec.roots) == 2 else None
            self.nodes.append(load_spec_objects(spec, links[side], root=root))
        ours = len(spec.roots) == 2
        self.scale = 1.0 if ours else COUNT
        names = ("arm.pos", "arm.target") if ours else ("positions", "set_points")
        self.positions, self.set_points = (self._both(name) for name in names)
        limits = [v for node in self.nodes for v in node if v.path.endswith((".limit", ".spd_sp"))]
        self.limits = ValueGroup({f"{n}": value for n, value in enumerate(limits)}, "speed limits")

    def _both(self, name: str) -> ValueGroup:
        """Return a group with one value of every joint of both arms."""
        values: dict[str, Value[float]] = {}
        for side, node in zip(SIDES, self.nodes, strict=True):
            group = node[name]
            assert isinstance(group, ValueGroup)
            values |= {f"{side}.{path}": value for path, value in group.values.items()}
        return ValueGroup(values, name)

    def write(self, group: ValueGroup, angles: Array) -> None:
        """Write angles in rad or speeds in rad/s. Counts are rounded to whole numbers."""
        flat = angles.ravel() / self.scale
        group.write([float(v) if self.scale == 1.0 else round(v) for v in flat])

    def angles_in(self, snapshot: Snapshot) -> Array:
        """Return the (2, 7) positions of one publish."""
        return np.array(list(snapshot.values()), float).reshape(2, 7) * self.scale


def drive(pair: Pair, pace: float) -> Run:
    """Stream the demonstration's set-points, and keep the published values."""
    samples: list[tuple[float, Snapshot]] = []
    asked_s: list[float] = []
    asked: list[Array] = []
    box: list[Array] = []
    pair.write(pair.limits, np.full(14, 3.0))
    pair.write(pair.set_points, np.stack([REST, REST]))
    wait_until(pair, np.stack([REST, REST]))
    pair.positions.on_publish(lambda time_s, values: samples.append((time_s, values)))
    start = due = pair.link.now_s()
    for joints in demonstration(PERIOD_S, pace):
        due = max(due + PERIOD_S, pair.link.now_s())  # a late program moves slower, but does not jump
        pair.link.sleep_until(due)
        pair.write(pair.set_points, joints)
        asked_s.append(pair.link.now_s() - start)
        asked.append(joints)
        box += box_of(pair.link)
    snapshot = wait_until(pair, asked[-1])
    box += box_of(pair.link)
    reports = [report for node in pair.nodes for report in node.publisher.reports()]
    for node in pair.nodes:
        node.stop_publishing()
    if len(samples) < 2:
        raise LinkTimeout(f"{len(samples)} publishes came in {asked_s[-1]:.1f} s", item="pa10")
    times_s = list(snapshot.times_s.values())
    return Run(
        asked_s=np.array(asked_s),
        asked=np.array(asked),
        measured_s=np.array([time_s for time_s, _ in samples]) - start,
        measured=np.array([pair.angles_in(values) for _, values in samples]),
        home=pair.angles_in(snapshot),
        lost=sum(report.lost for report in reports),
        apart_us=(max(times_s) - min(times_s)) * 1e6,
        box=np.array(box) if box else None,
    )


def box_of(link: Link) -> list[Array]:
    """Return where the box of a model in MuJoCo is, x, y and z; nothing without a model."""
    data = getattr(getattr(link.board, "plant", None), "data", None)
    return [] if data is None else [np.array(data.sensor("box_at").data)]


def wait_until(pair: Pair, target: Array) -> Snapshot:
    """Return a snapshot of both arms when all joints are at `target`, or when the time is over."""
    deadline = pair.link.now_s() + SETTLE_S
    while True:
        snapshot = pair.positions.snapshot()
        if np.abs(pair.angles_in(snapshot) - target).max() < 0.002 or pair.link.now_s() >= deadline:
            return snapshot
        pair.link.sleep_until(pair.link.now_s() + PERIOD_S)


def tell(run: Run) -> bool:
    """Print what happened. Return whether both arms are home and the hands stayed together."""
    asked = run.asked_at_publishes()
    on_loop = np.abs(hands_apart(asked) - HANDS_APART) < 1e-3
    if not on_loop.any():
        raise LinkTimeout(f"none of {len(asked)} publishes came while the hands went around", item="pa10")
    gap_mm = 1e3 * hands_apart(run.measured)[on_loop]
    rate_hz = (len(run.measured_s) - 1) / (run.measured_s[-1] - run.measured_s[0])
    final_mrad = 1e3 * np.abs(run.home - run.asked[-1]).max()
    error_mrad = 1e3 * np.sqrt(np.mean((run.measured - asked) ** 2))
    print(f"  set-points: {len(run.asked_s)} of 14 joints, a burst and a commit on each link")
    print(f"  publishes: {len(run.measured_s)} sets of 14 positions at {rate_hz:.1f} Hz, {run.lost} lost")
    print(f"  joints: {error_mrad:.0f} mrad rms behind on the way, {final_mrad:.1f} mrad at the end")
    print(f"  hands: {gap_mm.min():.0f} to {gap_mm.max():.0f} mm apart on the loop (asked 100)")
    print(f"  snapshot: the two links were read {run.apart_us:.0f} us apart")
    carried, off_mm = True, 20  # the publishes of the two links are not of quite the same moment
    if run.box is not None:
        lifted_m = float(run.box[:, 2].max() - run.box[0, 2])
        off_m = float(np.linalg.norm(run.box[-1] - run.box[0]))
        print(f"  box: lifted by {lifted_m * 1e3:.0f} mm, put down {off_m * 1e3:.0f} mm from its place")
        carried, off_mm = (
            lifted_m > LIFTED_M and off_m < BACK_M,
            35,
        )  # it is between the hands, and keeps them apart
    together = 100 - off_mm < gap_mm.min() and gap_mm.max() < 100 + off_mm
    return bool(final_mrad < 5 and together and carried)


def has_mujoco() -> bool:
    return importlib.util.find_spec("mujoco") is not None


def told(link: Link) -> str:
    """Say what moves behind a link."""
    plant = type(getattr(link.board, "plant", None)).__name__
    return {
        "MujocoPlant": "both in one model in MuJoCo",
        "Plant": "joints without masses" + ("" if has_mujoco() else " (MuJoCo is not installed)"),
    }.get(plant, "hardware")


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--spec", type=Path, default=Path("pa10_pair.ul"), metavar="FILE", help="which spec")
    for side in SIDES:
        parser.add_argument(f"--{side}", metavar="URL", help=f"board of the {side} arm (a virtual one)")
    parser.add_argument("--rtl", action="store_true", help="the virtual boards are the VHDL, compiled")
    parser.add_argument(
        "--simple", action="store_true", help="move without MuJoCo, also where it is installed"
    )
    parser.add_argument("--pace", type=float, default=1.0, metavar="X", help="2 is twice as fast")
    parser.add_argument("--picture", type=Path, metavar="PNG", help="save the motion there")
    options = parser.parse_args()
    file = options.spec if options.spec.exists() else HERE / options.spec
    spec = load(file)
    urls = {}
    for side in SIDES:
        one = f"&root={side}_arm" if len(spec.roots) == 2 else ""
        plant = HERE / "plant.py" if options.simple or not one or not has_mujoco() else f"mujoco:{MODEL}"
        virtual = f"{'rtl' if options.rtl else 'sim'}:{file}?plant={plant}{one}&timeout=1"
        urls[side] = getattr(options, side) or virtual
    with connect(urls["left"]) as left, connect(urls["right"]) as right:
        print(f"{file.name}: {sum(1 for _ in spec.walk())} words; {told(left)}; moving:")
        run = drive(Pair(spec, {"left": left, "right": right}), options.pace)
    there = tell(run)
    if options.picture:
        from picture import save  # imported only here, because moving does not need matplotlib

        save(run, options.picture)
        print(f"  picture: {options.picture}")
    print("\nBoth arms are home again." if there else "\nThe arms did not do what they were asked.")
    return 0 if there else 1


if __name__ == "__main__":
    run_program(main, name="pa10")
