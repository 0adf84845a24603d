# SPDX-License-Identifier: BSD-3-Clause
"""RobotVector: many virtual boards in one process, whose periods pass together."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space

from unitylink.errors import UnityLinkError

from .environment import EnvironmentState, Numbers, RobotEnvironment

Flags = npt.NDArray[np.bool_]


class RobotVector(gymnasium.vector.VectorEnv[Numbers, Numbers, npt.NDArray[Any]]):
    """Environments of virtual boards. `unitylink.gym.make_vector` makes it.

    An environment whose episode has ended is reset in the next step, and its action is ignored there.
    """

    metadata: dict[str, Any] = {"autoreset_mode": AutoresetMode.NEXT_STEP}  # noqa: RUF012  as in VectorEnv

    def __init__(self, environments: Sequence[RobotEnvironment]) -> None:
        if not environments:
            raise UnityLinkError("a vector needs an environment; expected a count from 1")
        if not all(each.virtual for each in environments):
            raise UnityLinkError(
                "a vector is for virtual boards (sim:, rtl:, bit:), whose time goes in steps"
            )
        self.environments = tuple(environments)
        self.num_envs = len(environments)
        self.single_observation_space = environments[0].observation_space
        self.single_action_space = environments[0].action_space
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self._over = np.zeros(self.num_envs, dtype=np.bool_)

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Numbers, dict[str, Any]]:
        """Begin all episodes. With one seed, each environment gets the next number."""
        if seed is None or isinstance(seed, int):
            seeds = [None if seed is None else seed + index for index in range(self.num_envs)]
        else:
            seeds = list(seed)
        if len(seeds) != self.num_envs:
            raise UnityLinkError(f"{len(seeds)} seeds for {self.num_envs} environments")
        self._over[:] = False
        facts: dict[str, Any] = {}
        seen = []
        for index, (each, own) in enumerate(zip(self.environments, seeds, strict=True)):
            numbers, told = each.reset(seed=own, options=options)
            seen.append(numbers)
            facts = self._add_info(facts, told, index)
        return np.array(seen), facts

    def step(self, actions: Numbers) -> tuple[Numbers, npt.NDArray[np.float64], Flags, Flags, dict[str, Any]]:
        """Write all actions, let one period pass for all, and look at all."""
        again = self._over.copy()
        going = [each for each, over in zip(self.environments, again, strict=True) if not over]
        for each, action, over in zip(self.environments, actions, again, strict=True):
            if not over:
                each.begin(action)
        for each in going:
            each.wait()  # the first lets the time pass, and for the others it has passed
        facts: dict[str, Any] = {}
        seen, rewards = [], np.zeros(self.num_envs)
        done, truncated = np.zeros(self.num_envs, dtype=np.bool_), np.zeros(self.num_envs, dtype=np.bool_)
        for index, (each, over) in enumerate(zip(self.environments, again, strict=True)):
            if over:
                numbers, told = each.reset()
            else:
                numbers, rewards[index], done[index], truncated[index], told = each.finish()
            seen.append(numbers)
            facts = self._add_info(facts, told, index)
        self._over = done | truncated
        return np.array(seen), rewards, done, truncated, facts

    def save(self) -> list[EnvironmentState]:
        """Return this moment of all episodes."""
        return [each.save() for each in self.environments]

    def restore(self, states: Sequence[EnvironmentState]) -> Numbers:
        """Go on from a moment of as many environments. Return what was seen there."""
        if len(states) != self.num_envs:
            raise UnityLinkError(f"{len(states)} states for {self.num_envs} environments")
        self._over[:] = False
        return np.array(
            [each.restore(state)[0] for each, state in zip(self.environments, states, strict=True)]
        )

    def close_extras(self, **_: Any) -> None:
        """Close all links."""
        for each in self.environments:
            each.close()
