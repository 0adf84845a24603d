# SPDX-License-Identifier: BSD-3-Clause
"""Two PA10 arms, each on its own link, as one robot: the same pose to both, one snapshot of both.

python examples/pa10/run.py
python examples/pa10/run.py --left tcp://192.168.1.10:5555 --right tcp://192.168.1.11:5555
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from unitylink import UnityLinkError, connect
from unitylink.layer4_data import Node, Value, ValueGroup, load_spec_objects
from unitylink.spec import load

SPEC = Path(__file__).resolve().with_name("pa10.ul")
JOINTS = ("s1", "s2", "s3", "e1", "e2", "w1", "w2")
POSE = (100, -450, 0, 900, 0, 450, -100)  # counts


def both(left: Node, right: Node, name: str) -> ValueGroup:
    """Return a group of one value of every joint of both arms."""
    values: dict[str, Value] = {}
    for side, arm in (("left", left), ("right", right)):
        for joint in JOINTS:
            value = arm[f"{joint}.{name}"]
            assert isinstance(value, Value)
            values[f"{side}.{joint}"] = value
    return ValueGroup(values, name)


def main() -> int:
    simulated = f"sim:{SPEC}?plant=loopback"
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--left", default=simulated, metavar="URL", help="board of the left arm")
    parser.add_argument("--right", default=simulated, metavar="URL", help="board of the right arm")
    options = parser.parse_args()
    spec = load(SPEC)
    try:
        with connect(options.left) as link_left, connect(options.right) as link_right:
            left, right = load_spec_objects(spec, link_left), load_spec_objects(spec, link_right)
            both(left, right, "pos_sp").write([*POSE, *(-count for count in POSE)])
            snapshot = both(left, right, "cpos").snapshot()
    except UnityLinkError as error:
        print(f"pa10: {error}", file=sys.stderr)
        return 1
    print("joint   left  right")
    for joint in JOINTS:
        print(f"{joint:<5} {snapshot[f'left.{joint}']:6d} {snapshot[f'right.{joint}']:6d}")
    apart_us = (max(snapshot.times_s.values()) - min(snapshot.times_s.values())) * 1e6
    print(f"{len(snapshot)} positions; the two links were read {apart_us:.0f} us apart")
    return 0


if __name__ == "__main__":
    sys.exit(main())
