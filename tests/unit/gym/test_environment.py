# SPDX-License-Identifier: BSD-3-Clause
"""A robot as an environment of Gymnasium: its own check, the same episode twice, and what goes wrong."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from unit.gym.cart import cart_url, near_the_middle

import unitylink.gym
from unitylink.errors import UnityLinkError, ValueRangeError
from unitylink.gym.environment import RobotEnvironment
from unitylink.simulate import Board
from unitylink.spec import load


@pytest.fixture
def url(tmp_path: Path) -> str:
    return cart_url(tmp_path)


Made = Callable[..., RobotEnvironment]


@pytest.fixture
def made(url: str) -> Iterator[Made]:
    """Make environments, which are closed at the end."""
    with ExitStack() as opened:

        def make(**more: Any) -> RobotEnvironment:
            chosen = {"url": url, "dt_s": 0.02, "reward": near_the_middle, **more}
            env = unitylink.gym.make(chosen.pop("url"), **chosen)
            opened.callback(env.close)
            return env

        yield make


def episode(env: RobotEnvironment, seed: int, steps: int = 30) -> list[Any]:
    seen, facts = env.reset(seed=seed)
    told: list[Any] = [seen.tolist(), facts]
    for turn in range(steps):
        seen, reward, done, over, facts = env.step(np.array([np.sin(turn), 0.1]))
        told.append((seen.tolist(), reward, done, over, facts))
    return told


@pytest.mark.filterwarnings(
    "ignore:.*WARN"
)  # advice: limits of a robot are not -1 to 1, and it draws nothing
def test_gymnasiums_own_check(made: Made) -> None:
    env = made()
    check_env(env, skip_close_check=True)
    env.close()
    env.close()


def test_the_spaces_come_from_the_spec(made: Made) -> None:
    env = made()
    assert [channel.path for channel in env.observed] == ["position", "at_end"]
    assert [channel.path for channel in env.commanded] == ["force", "trim"]
    assert env.action_space.low.tolist() == [-5.0, -1.0]
    assert env.observation_space.high.tolist() == [pytest.approx(214748.3647), 1.0]
    env.close()
    env = made(observed=["position"], commanded=["force"])
    assert env.observation_space.shape == env.action_space.shape == (1,)
    env.close()


def test_the_same_seed_gives_the_same_episode(made: Made) -> None:
    first = made()
    told = episode(first, 7)
    again = episode(first, 7)
    other = episode(first, 8)
    first.close()
    assert told == again == episode(made(), 7)
    assert other[0] != told[0]
    assert told[-1][-1] == {"time_s": pytest.approx(0.6, abs=1e-4), "clipped": 0, "missed": 0}
    assert told[-1][0][0] != told[2][0][0]  # it has moved


def test_an_action_beyond_the_limits_is_clipped_or_refused_as_the_spec_says(made: Made) -> None:
    env = made()
    env.reset(seed=1)
    *_, facts = env.step(np.array([0.0, 3.0]))
    assert facts["clipped"] == 1
    assert env.robot.trim.latest == 1.0
    with pytest.raises(ValueRangeError, match=r"force: the action 6 is not in -5 to 5 N"):
        env.step(np.array([6.0, 0.0]))
    with pytest.raises(ValueRangeError, match="not a number"):
        env.step(np.array([float("nan"), 0.0]))
    env.close()


def test_the_end_of_an_episode(made: Made) -> None:
    env = made(most_steps=3, done=lambda seen: seen["position"] > 0.3)
    env.reset(seed=1)
    ends = [env.step(np.zeros(2))[2:4] for _ in range(3)]
    assert ends == [(False, False), (False, False), (False, True)]
    env.reset(seed=1)
    env.close()
    env = made(done=lambda seen: seen["position"] > 0.3)
    env.reset(seed=1)
    done = False
    for _ in range(200):
        _, _, done, over, _ = env.step(np.array([5.0, 0.0]))
        assert not over
        if done:
            break
    assert done
    env.close()


def test_a_lost_link_ends_the_episode_and_reset_begins_another(made: Made) -> None:
    env = made()
    env.reset(seed=1)
    env.robot.links[0].board.hang_up()
    seen, reward, done, over, facts = env.step(np.zeros(2))
    assert (reward, done, over) == (0.0, False, True)
    assert "lost" in facts["lost"]
    assert env.observation_space.contains(seen)
    with pytest.raises(UnityLinkError, match=r"call reset\(\)"):
        env.step(np.zeros(2))
    env.reset()
    assert "lost" not in env.step(np.zeros(2))[4]
    env.close()


def test_a_plant_that_fails_ends_the_episode_and_reset_begins_another(made: Made) -> None:
    env = made()
    env.reset(seed=1)
    env.robot.links[0].board.plant.speed = float("nan")
    _, reward, done, over, facts = env.step(np.zeros(2))
    assert (reward, done, over) == (0.0, False, True)
    assert "Plant.step(" in facts["lost"] and "ValueError" in facts["lost"]
    env.reset(seed=1)
    assert "lost" not in env.step(np.zeros(2))[4]
    env.close()


def test_a_reward_that_fails_is_told_with_its_step(made: Made) -> None:
    env = made(reward=lambda seen, written: 1 / 0)
    env.reset()
    with pytest.raises(UnityLinkError, match=r"reward failed at step 1: ZeroDivisionError"):
        env.step(np.zeros(2))
    env.close()
    env = made(reward=lambda seen, written: seen["positon"])
    env.reset()
    with pytest.raises(UnityLinkError, match=r"step 1: KeyError: 'positon'; nearest: position"):
        env.step(np.zeros(2))
    env.close()


def test_where_time_passes_by_itself_missed_periods_are_counted(made: Made, tmp_path: Path) -> None:
    spec = tmp_path / "cart.ul"
    homes = []
    with Board(load(spec), endpoint="tcp") as board:
        env = made(url=board.url, spec=str(spec), dt_s=1e-5, home=homes.append)
        env.reset()
        facts = [env.step(np.zeros(2))[4] for _ in range(20)][-1]
        assert facts["missed"] > 0  # no round trip takes 10 us there
        assert homes == [env.robot]
        env.close()


@pytest.mark.parametrize(
    ("more", "told"),
    [
        ({"dt_s": 0}, "dt_s is 0"),
        ({"observed": ["force"]}, "no number that can be read"),
        ({"commanded": ["position"]}, "no number that can be written"),
        ({"observed": ["positon"]}, "position"),
        ({"observed": []}, "no number is observed"),
    ],
)
def test_what_is_wrong_is_told(made: Made, more: dict[str, Any], told: str) -> None:
    with pytest.raises(UnityLinkError, match=told):
        made(**more)


def test_a_number_without_limits_cannot_be_an_action(made: Made, tmp_path: Path) -> None:
    (tmp_path / "wide.ul").write_text("public wide() { @a = 0x1: i32 READ(); @b = 0x2: f32 WRITE(); }")
    with pytest.raises(UnityLinkError, match="b has no limits to learn in"):
        made(url=f"sim:{tmp_path / 'wide.ul'}")
    with pytest.raises(UnityLinkError, match="does not name the spec"):
        made(url="tcp://127.0.0.1:1")


def test_an_episode_goes_on_from_a_state(made: Made) -> None:
    env = made(most_steps=12)
    env.reset(seed=4)
    for turn in range(5):
        env.step(np.array([turn - 2.0, 0.3]))
    state = env.save()

    def rest(env: RobotEnvironment) -> list[object]:
        seen: list[object] = []
        for turn in range(7):
            numbers, reward, _, over, facts = env.step(np.array([turn - 3.0, 9.0]))
            seen.append((numbers.tolist(), reward, over, round(facts["time_s"], 6), facts["clipped"]))
        return seen

    went_on = rest(env)
    seen, facts = env.restore(state)
    assert seen.tolist() == state.seen.tolist()
    assert facts["time_s"] == pytest.approx(state.time_s, abs=1e-8)
    assert rest(env) == went_on
    assert went_on[-1][2]  # type: ignore[index]  # truncated after the same step
    env.close()
    other = made(most_steps=12)
    other.restore(state)
    assert rest(other) == went_on
    with pytest.raises(UnityLinkError, match="environment is closed"):
        env.save()
