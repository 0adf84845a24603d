# SPDX-License-Identifier: BSD-3-Clause
"""The action FollowJointTrajectory, which MoveIt uses, for a robot whose node runs (Python, C++, or on DDS).

python3 examples/ros/follow_trajectory.py --ros-args -r __ns:=/arm -p goal_tolerance:=0.02

It needs ROS 2 with rclpy, sensor_msgs and control_msgs. It follows `joint_states` and sets `joint_commands`.
The host paces it: the gateware gets each set-point, and not the trajectory. A robot with ros2_control
has this by its joint_trajectory_controller.
"""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parent))

from trajectory import Point, Trajectory

PERIOD_S = 0.01  # from one set-point to the next
FEEDBACK_S = 0.1
SILENT_S = 0.5  # without joint_states for so long, the robot has lost its link


class Refused(Exception):
    """Why a goal ends early: the error code of the action, and the reason."""

    def __init__(self, code: int, why: str) -> None:
        super().__init__(why)
        self.code = code


class Follower:
    """One goal at a time. A new one takes over from where the joints are then."""

    def __init__(self, node: Any) -> None:
        actions = import_module("rclpy.action")
        state = import_module("sensor_msgs.msg").JointState
        self._action = import_module("control_msgs.action").FollowJointTrajectory
        self._response = actions.GoalResponse
        self._make = state
        self._node = node
        self._tolerance = node.declare_parameter("goal_tolerance", 0.05).value
        self._measured: dict[str, float] = {}
        self._came_s = 0.0
        self._current: Any = None
        self._lock = threading.Lock()  # one goal is followed at a time
        together = import_module("rclpy.callback_groups").ReentrantCallbackGroup()
        node.create_subscription(state, "joint_states", self._measure, 10, callback_group=together)
        self._commands = node.create_publisher(state, "joint_commands", 1)
        self._server = actions.ActionServer(
            node,
            self._action,
            "follow_joint_trajectory",
            execute_callback=self._execute,
            goal_callback=self._consider,
            cancel_callback=lambda _: actions.CancelResponse.ACCEPT,
            callback_group=together,
        )

    def _measure(self, message: Any) -> None:
        self._measured.update(zip(message.name, message.position, strict=False))
        self._came_s = time.monotonic()

    def _consider(self, goal: Any) -> Any:
        try:
            self._plan(goal)
        except (Refused, ValueError) as error:
            self._node.get_logger().error(f"a trajectory is refused: {error}")
            return self._response.REJECT
        return self._response.ACCEPT

    def _plan(self, goal: Any) -> Trajectory:
        names = list(goal.trajectory.joint_names)
        unknown = [name for name in names if name not in self._measured]
        if unknown or not names:
            raise Refused(
                -2, f"these joints are not in joint_states: {', '.join(unknown) or 'none is named'}"
            )
        if twice := sorted({name for name in names if names.count(name) > 1}):
            raise Refused(-2, f"the trajectory names these joints twice: {', '.join(twice)}; name each once")
        points = [
            Point(_seconds(one.time_from_start), tuple(one.positions), tuple(one.velocities))
            for one in goal.trajectory.points
        ]
        start = [self._measured[name] for name in names]
        trajectory = Trajectory(start, points)
        for name, found, first in zip(names, start, trajectory.sample(0.0), strict=True):
            if abs(first - found) > self._tolerance:  # from there the robot would jump
                raise Refused(-1, f"{name} is at {found:.3f}, and the trajectory begins at {first:.3f}")
        return trajectory

    def _execute(self, goal: Any) -> Any:
        self._current = goal
        result = self._action.Result()
        names = list(goal.request.trajectory.joint_names)
        with self._lock:  # the goal before this one sees that it is not the current one, and ends
            try:
                done = self._follow(goal, names)
            except (Refused, ValueError) as error:
                result.error_code = getattr(error, "code", -1)
                result.error_string = str(error)
                self._command(names, [self._measured[name] for name in names])  # stay
                goal.abort()
                return result
            if done:
                goal.succeed()
            else:
                self._command(names, [self._measured[name] for name in names])
                goal.canceled()
        return result

    def _follow(self, goal: Any, names: Sequence[str]) -> bool:
        """Follow a trajectory to its end. Return False if it was cancelled."""
        trajectory = self._plan(goal.request)
        path = _tolerances(goal.request.path_tolerance, names, 0.0)
        last = _tolerances(goal.request.goal_tolerance, names, self._tolerance)
        late_s = trajectory.duration_s + (_seconds(goal.request.goal_time_tolerance) or 1.0)
        clock = self._node.get_clock()
        begun = clock.now()
        told_s = 0.0
        while True:
            if goal.is_cancel_requested:
                return False
            if self._current is not goal:
                raise Refused(-1, "another trajectory has taken over")
            if time.monotonic() - self._came_s > SILENT_S:
                raise Refused(-4, "joint_states are silent: the robot has no link")
            time_s = (clock.now() - begun).nanoseconds / 1e9
            wanted = trajectory.sample(time_s)
            self._command(names, wanted)
            measured = [self._measured[name] for name in names]
            errors = [b - a for a, b in zip(measured, wanted, strict=True)]
            for name, error, most in zip(names, errors, path, strict=True):
                if most > 0 and not abs(error) <= most:  # nor NaN
                    raise Refused(-4, f"{name} is {error:+.3f} from its path")
            if time_s - told_s >= FEEDBACK_S:
                told_s = time_s
                self._tell(goal, names, wanted, measured)
            if time_s >= trajectory.duration_s:
                off = [
                    f"{name} is {error:+.3f} from its goal"
                    for name, error, most in zip(names, errors, last, strict=True)
                    if most > 0 and not abs(error) <= most
                ]
                if not off:
                    return True
                if time_s > late_s:
                    raise Refused(-5, ", ".join(off))
            time.sleep(PERIOD_S)

    def _command(self, names: Sequence[str], positions: Sequence[float]) -> None:
        self._commands.publish(self._make(name=list(names), position=list(positions)))

    def _tell(self, goal: Any, names: Sequence[str], wanted: Sequence[float], found: Sequence[float]) -> None:
        feedback = self._action.Feedback()
        feedback.header.stamp = self._node.get_clock().now().to_msg()
        feedback.joint_names = list(names)
        feedback.desired.positions = list(wanted)
        feedback.actual.positions = list(found)
        feedback.error.positions = [b - a for a, b in zip(found, wanted, strict=True)]
        goal.publish_feedback(feedback)


def _seconds(duration: Any) -> float:
    return float(duration.sec) + float(duration.nanosec) / 1e9


def _tolerances(given: Sequence[Any], names: Sequence[str], standard: float) -> list[float]:
    """Return one for each joint. In the message 0 is the standard, and -1 none; here none is 0."""
    told = {one.name: one.position for one in given}
    return [max(0.0, told.get(name, 0.0) or standard) for name in names]


def main() -> None:
    rclpy = import_module("rclpy")
    rclpy.init()
    node = rclpy.create_node("follow_trajectory")
    Follower(node)
    executor = import_module("rclpy.executors").MultiThreadedExecutor(num_threads=4)
    executor.add_node(node)
    try:
        executor.spin()
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
