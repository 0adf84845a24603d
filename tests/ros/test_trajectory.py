# SPDX-License-Identifier: BSD-3-Clause
"""The trajectories of `examples/ros` go through their points without a jump. Wrong ones are refused."""

from __future__ import annotations

import math
import runpy
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

FOLLOWING = runpy.run_path(str(Path(__file__).parents[2] / "examples" / "ros" / "follow_trajectory.py"))
Point, Trajectory = FOLLOWING["Point"], FOLLOWING["Trajectory"]


def speeds(path: Any, end_s: float) -> list[float]:
    """Return the speed of the first joint every millisecond."""
    places = [path.sample(n / 1000)[0] for n in range(round(end_s * 1000))]
    return [1000 * (b - a) for a, b in pairwise(places)]


def test_a_trajectory_goes_through_its_points_and_rests_at_the_end() -> None:
    points = [Point(1.0, (1.0, -2.0)), Point(3.0, (0.0, 0.0))]
    path = Trajectory([0.5, 0.0], points)
    assert path.sample(0.0) == (0.5, 0.0) and path.sample(0.5) == (0.75, -1.0)
    assert [path.sample(point.time_s) for point in points] == [point.positions for point in points]
    assert path.sample(99.0) == path.goal == (0.0, 0.0) and path.duration_s == 3.0
    assert max(map(abs, speeds(path, 4.0))) == pytest.approx(0.5)


def test_with_velocities_the_speed_has_no_jump() -> None:
    path = Trajectory([0.0], [Point(1.0, (1.0,), (0.5,)), Point(2.0, (1.0,), (0.0,))])
    found = speeds(path, 2.5)
    assert path.sample(1.0) == (1.0,) and found[1000] == pytest.approx(0.5, abs=0.01)
    assert max(abs(b - a) for a, b in pairwise(found)) < 0.01
    assert abs(found[0]) < 0.01 and found[-1] == 0.0


@pytest.mark.parametrize(
    ("points", "why"),
    [
        ([], "without points"),
        ([Point(1.0, (0.0,)), Point(1.0, (1.0,))], "point 1 is not later"),
        ([Point(-1.0, (0.0,))], "point 0 is not later"),
        ([Point(1.0, (0.0, 1.0))], "2 numbers for 1 joints"),
        ([Point(1.0, (0.0,), (0.0, 0.0))], "2 numbers for 1 joints"),
        ([Point(1.0, ())], "missing or not finite"),
        ([Point(1.0, (math.nan,))], "missing or not finite"),
    ],
)
def test_what_no_robot_can_follow_is_refused(points: list[Any], why: str) -> None:
    with pytest.raises(ValueError, match=why):
        Trajectory([0.0], points)


@pytest.mark.parametrize(
    ("joints", "why"),
    [
        (["a", "b", "a"], "twice: a; name each once"),
        (["a", "c"], "not in joint_states: c"),
        ([], "none is named"),
    ],
)
def test_a_goal_names_each_of_its_joints_once(joints: list[str], why: str) -> None:
    follower = object.__new__(FOLLOWING["Follower"])  # its plan needs no node
    follower._measured = {"a": 0.0, "b": 0.0}
    goal = SimpleNamespace(trajectory=SimpleNamespace(joint_names=joints, points=[]))
    with pytest.raises(FOLLOWING["Refused"], match=why) as refused:
        follower._plan(goal)
    assert refused.value.code == -2, "INVALID_JOINTS"


def test_who_does_not_know_where_a_joint_is_does_not_move_it() -> None:
    """Between NaN and a goal there is nothing to command, and then the goal would come as a jump."""
    with pytest.raises(ValueError, match="no known position"):
        Trajectory([0.0, math.nan], [Point(1.0, (1.0, 1.0))])
