# SPDX-License-Identifier: BSD-3-Clause
"""The 18-DOF walker steps on the spot: two tripods of three legs in turn, 18 servos in one commit.

python examples/walker18/run.py
python examples/walker18/run.py --link "serial:/dev/ttyUSB0?baud=3000000"
"""

from __future__ import annotations

import argparse
import math
import sys
from pathlib import Path

from unitylink import UnityLinkError, connect
from unitylink.layer4_data import ReadValue, ValueGroup, load_spec_objects
from unitylink.spec import load

SPEC = Path(__file__).resolve().with_name("walker18.ul")
TRIPODS = ({"front.l", "middle.r", "rear.l"}, {"front.r", "middle.l", "rear.r"})
LIFT, SWING = 300, 200  # counts
STEPS, POINTS = 2, 16


def gait(leg: str, phase: float) -> dict[str, int]:
    """Return the set-points of a leg: in the first half of its cycle it is lifted and swings forward."""
    shifted = 2 * math.pi * (phase + (0.5 if leg in TRIPODS[1] else 0.0))
    lift = max(0.0, math.sin(shifted))
    return {
        f"{leg}.hip_sp": round(-SWING * math.cos(shifted)),
        f"{leg}.knee_sp": round(LIFT * lift),
        f"{leg}.foot_sp": round(-LIFT * lift / 2),
    }


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--link", default=f"sim:{SPEC}?plant=loopback", metavar="URL", help="board to drive")
    options = parser.parse_args()
    try:
        with connect(options.link) as link:
            walker = load_spec_objects(load(SPEC), link)
            set_points, positions = walker["sp"], walker["pos"]
            assert isinstance(set_points, ValueGroup) and isinstance(positions, ValueGroup)
            legs = sorted({path.rpartition(".")[0] for path in set_points.values})
            print(f"{len(set_points)} servos in {len(legs)} legs: {', '.join(legs)}")
            for point in range(STEPS * POINTS):
                targets: dict[str, int] = {}
                for leg in legs:
                    targets |= gait(leg, point / POINTS)
                set_points.write(targets)  # one burst, one commit: no leg is ever half a step ahead
                if point % (POINTS // 4) == 0:
                    lifted = [leg for leg in legs if targets[f"{leg}.knee_sp"] > LIFT // 2]
                    print(f"step {point / POINTS:4.2f}: in the air {', '.join(lifted) or 'none'}")
            front = walker["front.l.hip"]
            assert isinstance(front, ReadValue)
            print(f"{front.display} is at {front.read()}, all at {list(positions.snapshot().values())}")
    except UnityLinkError as error:
        print(f"walker18: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
