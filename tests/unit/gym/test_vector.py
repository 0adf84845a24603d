# SPDX-License-Identifier: BSD-3-Clause
"""Many boards in one process: each is as if it were alone."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from unit.gym.cart import cart_url, near_the_middle

import unitylink.gym
from unitylink.errors import UnityLinkError
from unitylink.gym.vector import RobotVector

COUNT = 5


@pytest.fixture
def url(tmp_path: Path) -> str:
    return cart_url(tmp_path)


@pytest.fixture
def vector(url: str) -> Iterator[RobotVector]:
    made = unitylink.gym.make_vector(url, COUNT, dt_s=0.02, reward=near_the_middle, most_steps=4)
    yield made
    made.close()


def pushed(turn: int) -> np.ndarray[Any, np.dtype[np.float64]]:
    return np.array([[float(index - turn), 0.1] for index in range(COUNT)])


def test_each_board_moves_as_if_it_were_alone(url: str, vector: RobotVector) -> None:
    seen, facts = vector.reset(seed=3)
    together = [seen]
    assert facts["clipped"].tolist() == [0] * COUNT
    for turn in range(3):
        seen, rewards, done, over, facts = vector.step(pushed(turn))
        together.append(seen)
        assert rewards.shape == (COUNT,)
        assert not done.any() and not over.any()
        assert not facts["missed"].any()
    assert vector.observation_space.contains(seen)
    vector.close()
    for index in range(COUNT):
        env = unitylink.gym.make(url, dt_s=0.02, reward=near_the_middle)
        alone = [env.reset(seed=3 + index)[0]]
        alone += [env.step(pushed(turn)[index])[0] for turn in range(3)]
        env.close()
        # a board that began a little later has another phase of its plant's millisecond
        np.testing.assert_allclose([row[index] for row in together], alone, atol=2e-3)


def test_an_episode_that_has_ended_begins_anew_in_the_next_step(vector: RobotVector) -> None:
    vector.reset(seed=1)
    ends = [vector.step(pushed(0))[3].all() for _ in range(4)]
    assert ends == [False, False, False, True]
    seen, rewards, done, over, facts = vector.step(np.full((COUNT, 2), 99.0))  # actions of nobody
    assert not rewards.any() and not done.any() and not over.any()
    assert (np.abs(seen[:, 0]) <= 0.11).all()
    assert (facts["time_s"] < 0.02).all()


def test_a_lost_board_does_not_stop_the_others(vector: RobotVector) -> None:
    vector.reset(seed=1)
    vector.environments[0].robot.links[0].board.hang_up()
    _, _, _, over, facts = vector.step(pushed(0))
    assert over.tolist() == [True, False, False, False, False]
    assert "lost" in facts["lost"][0]
    seen, _, _, over, _ = vector.step(pushed(1))
    assert not over.any()
    assert vector.observation_space.contains(seen)


def test_what_is_wrong_is_told(url: str, vector: RobotVector) -> None:
    with pytest.raises(UnityLinkError, match="a count from 1"):
        unitylink.gym.make_vector(url, 0, dt_s=0.02, reward=near_the_middle)
    with pytest.raises(UnityLinkError, match="2 seeds for 5"):
        vector.reset(seed=[1, 2])


def test_all_go_back_together(vector: RobotVector) -> None:
    vector.reset(seed=6)
    vector.step(pushed(0))
    states = vector.save()
    went_on = vector.step(pushed(1))
    seen = vector.restore(states)
    assert vector.observation_space.contains(seen)
    again = vector.step(pushed(1))
    np.testing.assert_allclose(again[0], went_on[0], atol=2e-4)
    with pytest.raises(UnityLinkError, match=f"1 states for {COUNT}"):
        vector.restore(states[:1])
