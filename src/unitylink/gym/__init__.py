# SPDX-License-Identifier: BSD-3-Clause
"""A robot as an environment of Gymnasium. See docs/gym.md.

>>> import unitylink.gym
>>> env = unitylink.gym.make("sim:cart.ul?plant=cart.py", dt_s=0.02, reward=upright)  # doctest: +SKIP
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from unitylink.optional import absent

if TYPE_CHECKING:
    from .environment import RobotEnvironment
    from .vector import RobotVector

__all__ = ["make", "make_vector"]


def make(
    url: str,
    *,
    dt_s: float,
    reward: Callable[[Mapping[str, Any], Mapping[str, Any]], float],
    spec: str | None = None,
    observed: Sequence[str] | None = None,
    commanded: Sequence[str] | None = None,
    done: Callable[[Mapping[str, Any]], bool] | None = None,
    home: Callable[[Any], object] | None = None,
    most_steps: int | None = None,
    render_mode: str | None = None,
) -> RobotEnvironment:
    """Return an environment of Gymnasium whose spaces come from the spec.

    `url` is a link URL. A virtual board goes in steps (docs/lockstep.md), and begins each episode anew. On
    hardware, steps keep the pace of `dt_s`, and `home(robot)` brings the robot to its start. `spec` is the
    file of the spec, for URLs that do not name it.

    `observed` and `commanded` are paths of values. By default, these are all numbers that the PC reads and
    does not write, and all numbers that it writes. `reward(observation, action)` and `done(observation)` get
    values by path, in the units of the spec. An episode is truncated after `most_steps`. With `render_mode`
    "rgb_array", `render()` returns a picture of a plant of MuJoCo.

    Raises UnityLinkError (a wrong argument, or a value without limits), UrlError, SpecError, LinkError, and
    ToolError if gymnasium is absent.
    """
    try:
        import gymnasium  # noqa: F401
    except ImportError:
        raise absent("gymnasium", "an environment for learning") from None
    from .environment import RobotEnvironment, Task

    task = Task(dt_s, reward, done, home, most_steps)
    return RobotEnvironment(
        url, task, spec=spec, observed=observed, commanded=commanded, render_mode=render_mode
    )


def make_vector(url: str, count: int, **more: Any) -> RobotVector:
    """Return `count` environments of virtual boards in this process, as one of Gymnasium's vectors.

    `more` is as for `make`. A period passes for all boards together.

    Raises UnityLinkError, and what `make` raises.
    """
    made: list[RobotEnvironment] = []
    try:
        while len(made) < count:
            made.append(make(url, **more))
        from .vector import RobotVector

        return RobotVector(made)
    except BaseException:
        for each in made:
            each.close()
        raise
