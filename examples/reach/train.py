# SPDX-License-Identifier: BSD-3-Clause
"""Training by the cross-entropy method: try policies around the best ones so far, and keep the best again."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path

import numpy as np
from policy import COMMANDED, NUMBERS, OBSERVED, Array, draw_targets, hand, torques

import unitylink.gym
from unitylink.gym.vector import RobotVector

HERE = Path(__file__).resolve().parent
TWIN = f"sim:{HERE / 'reach.ul'}?plant=mujoco:{HERE / 'reach.xml'}"
DT_S = 0.02
STEPS_A_TARGET = 40


@dataclass(frozen=True)
class Effort:
    """How much is tried. All of it follows from the seed, and from nothing else."""

    generations: int = 30
    policies: int = 32  # in each generation
    best: int = 8  # of them are kept
    targets: int = 5  # for each of them, one after another
    boards: int = 16  # that step together
    seed: int = 1


@dataclass(frozen=True)
class Learned:
    numbers: Array
    curve: Array  # (generations, 3): the best score, that of the kept ones, that of all
    steps: int  # of robots


def thrift(seen: object, written: dict[str, float]) -> float:
    """Return the part of the reward that does not depend on the target, which is the program's."""
    return -0.02 * sum(torque * torque for torque in written.values())


def scores(vector: RobotVector, policies: Array, targets: Array) -> Array:
    """Return the score of each policy: how near the hand is in the mean, and with how little torque."""
    seen, _ = vector.reset(seed=1)
    total = np.zeros(len(policies))
    for target in targets:
        for _ in range(STEPS_A_TARGET):
            seen, rewards, *_ = vector.step(torques(policies, seen, target))
            total += rewards - np.linalg.norm(target - hand(seen), axis=-1)
    return total / (len(targets) * STEPS_A_TARGET)


def _score_part(policies: Array, targets: Array) -> Array:
    """Score a part of a generation, in a process of its own. Each part has boards of its own."""
    vector = unitylink.gym.make_vector(
        TWIN, len(policies), dt_s=DT_S, reward=thrift, observed=OBSERVED, commanded=COMMANDED
    )
    try:
        return scores(vector, policies, targets)
    finally:
        vector.close()


def train(effort: Effort, *, processes: int = 2, say: Callable[[str], None] = print) -> Learned:
    """Return what was learned. The same effort gives the same numbers, with any number of processes."""
    source = np.random.default_rng(effort.seed)
    mean, spread = np.zeros(NUMBERS), np.full(NUMBERS, 1.5)
    targets = draw_targets(source, effort.targets)
    curve = []
    with _pool(processes) as pool:
        for number in range(effort.generations):
            policies = mean + spread * source.standard_normal((effort.policies, NUMBERS))
            parts = [policies[at : at + effort.boards] for at in range(0, effort.policies, effort.boards)]
            found = np.concatenate(list(pool.map(_score_part, parts, [targets] * len(parts))))
            kept = np.argsort(-found)[: effort.best]
            mean = policies[kept].mean(axis=0)
            spread = policies[kept].std(axis=0) + 0.5 * 0.85**number  # so that it does not settle too early
            curve.append((found[kept[0]], found[kept].mean(), found.mean()))
            say(f"generation {number + 1:2}: best {curve[-1][0]:.3f}, all {curve[-1][2]:.3f}")
    steps = effort.generations * effort.policies * effort.targets * STEPS_A_TARGET
    return Learned(mean, np.array(curve), steps)


@contextmanager
def _pool(processes: int) -> Iterator[Executor | type[_Here]]:
    if processes <= 1:
        yield _Here
        return
    with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as pool:
        yield pool


class _Here:
    """In place of other processes: this one."""

    map = staticmethod(map)
