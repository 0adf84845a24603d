# SPDX-License-Identifier: BSD-3-Clause
"""RobotEnvironment: the spaces, the episodes and the steps."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt

from unitylink.connection import connect
from unitylink.connection.schemes import scheme_of
from unitylink.errors import LinkError, UnityLinkError, ValueRangeError
from unitylink.layer2_message import Link
from unitylink.layer4_data import ReadValue, Value, ValueGroup, WriteValue, load_spec_objects
from unitylink.simulate import BoardState
from unitylink.spec import load

from .channel import Channel, is_number
from .pictures import Pictures

Numbers = npt.NDArray[np.float64]
Values = Mapping[str, Any]


@dataclass(frozen=True)
class Task:
    """What is to be learned: the period of control, the reward, and how an episode begins and ends."""

    dt_s: float
    reward: Callable[[Values, Values], float]
    done: Callable[[Values], bool] | None = None
    home: Callable[[Any], object] | None = None
    most_steps: int | None = None


@dataclass(frozen=True)
class EnvironmentState:
    """A moment of an episode on a virtual board: `RobotEnvironment.save` makes it."""

    board: BoardState
    seen: Numbers
    written: Values
    steps: int
    clipped: int
    missed: int
    time_s: float  # since the episode began
    late_s: float  # since the last period ended


class RobotEnvironment(gymnasium.Env[Numbers, Numbers]):
    """A robot behind a link. `unitylink.gym.make` makes it.

    `observed` and `commanded` are the channels, in the order of the numbers in the spaces.
    """

    metadata: dict[str, Any] = {"render_modes": []}  # noqa: RUF012  as in gymnasium.Env
    render_mode: str | None = None

    def __init__(
        self,
        url: str,
        task: Task,
        *,
        spec: str | None,
        observed: Sequence[str] | None,
        commanded: Sequence[str] | None,
        render_mode: str | None = None,
    ) -> None:
        if not 1e-5 <= task.dt_s <= 3600:
            raise UnityLinkError(f"dt_s is {task.dt_s!r}; expected seconds, 1e-5 to 3600")
        self._virtual = scheme_of(url).virtual
        self._url, self.task = url, task
        if spec is None and not self._virtual:
            raise UnityLinkError(f"{url} does not name the spec; give its file: spec=...")
        self._spec = None if spec is None else load(spec)
        self._asked = observed, commanded
        self._link: Link | None = None
        self._robot: Any = None
        self._steps = self._clipped = self._missed = 0
        self._due_s = self._begun_s = 0.0
        self._written: dict[str, Any] = {}
        self._lost: LinkError | None = None
        self._open(0)
        self._last = np.zeros(len(self.observed))
        self.observation_space = _space(self.observed)
        self.action_space = _space(self.commanded)
        self._pictures: Pictures | None = None
        if render_mode is not None:
            try:
                self._pictures = Pictures(render_mode, self._now().board)
            except UnityLinkError:
                self._shut()
                raise
            self.render_mode = render_mode
            self.metadata = {"render_modes": [render_mode], "render_fps": max(1, round(1 / task.dt_s))}

    # ---- Gymnasium's own

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Numbers, dict[str, Any]]:
        """Begin an episode. A virtual board begins anew, and a plant with `seed(number)` gets a seed."""
        super().reset(seed=seed)
        self._begin_episode(int(self.np_random.integers(1 << 31)) if self._virtual else 0)
        if self.task.home is not None:
            self.task.home(self._robot)
        self._steps = self._clipped = self._missed = 0
        self._due_s = self._begun_s = self._now().now_s()
        return self._numbers(self._look()), self._facts()

    def step(self, action: Numbers) -> tuple[Numbers, float, bool, bool, dict[str, Any]]:
        """Write the action, let `dt_s` pass, and look.

        A lost link, or a plant that fails, ends the episode: it is truncated, and `info["lost"]` says why.
        Raises UnityLinkError with the number of the step if the reward fails.
        """
        self.begin(action)
        self.wait()
        return self.finish()

    def render(self) -> Any:
        """Return a picture of the model (docs/gym.md), or None without a `render_mode`."""
        return None if self._pictures is None else self._pictures.draw(self._now().board)

    def close(self) -> None:
        """Close the link. It may be called twice."""
        if self._pictures is not None:
            self._pictures.close()
        self._shut()

    # ---- beside Gymnasium: a moment that one comes back to

    def save(self) -> EnvironmentState:
        """Return this moment of the episode. Raises UnityLinkError: on hardware, and as `Board.save` does."""
        link = self._now()
        if not self._virtual:
            raise UnityLinkError("a robot of hardware cannot go back, so there is no state to save")
        now_s = link.now_s()
        return EnvironmentState(
            link.board.save(),
            np.array(self._last),
            dict(self._written),
            self._steps,
            self._clipped,
            self._missed,
            now_s - self._begun_s,
            now_s - self._due_s,
        )

    def restore(self, state: EnvironmentState) -> tuple[Numbers, dict[str, Any]]:
        """Go on from a moment of this environment or of another one with the same board."""
        self._shut()
        self._open(0, state.board)
        now_s = self._now().now_s()
        self._begun_s, self._due_s = now_s - state.time_s, now_s - state.late_s
        self._steps, self._clipped, self._missed = state.steps, state.clipped, state.missed
        self._written, self._last = dict(state.written), np.array(state.seen)
        return np.array(self._last), self._facts()

    # ---- the parts of a step: of a vector, many begin, one waits, and all finish

    def begin(self, action: Numbers) -> None:
        """Write the action."""
        self._now()
        written: dict[str, Any] = {}
        for channel, number in zip(self.commanded, np.asarray(action, dtype=np.float64).ravel(), strict=True):
            written[channel.path], clipped = channel.taken(float(number))
            self._clipped += clipped
        self._written = written
        try:
            self._commands.write(list(written.values()))
        except LinkError as error:
            self._lost = error

    def wait(self) -> None:
        """Let the rest of the period pass."""
        link = self._now()
        try:
            if self._lost is None:
                self._wait(link)
        except LinkError as error:
            self._lost = error

    def finish(self) -> tuple[Numbers, float, bool, bool, dict[str, Any]]:
        """Look, and judge what is seen."""
        seen: dict[str, Any] = {}
        try:
            if self._lost is None:
                seen = self._look()
        except LinkError as error:
            self._lost = error
        failed = self._link.board.error if self._virtual and self._link is not None else None
        if self._lost is not None or failed is not None:
            facts = {**self._facts(), "lost": str(failed or self._lost)}
            self._shut()
            return np.array(self._last), 0.0, False, True, facts
        self._steps += 1
        reward = self._called("reward", self.task.reward, seen, self._written)
        done = self.task.done is not None and bool(self._called("done", self.task.done, seen))
        over = self.task.most_steps is not None and self._steps >= self.task.most_steps
        return self._numbers(seen), float(reward), done, over, self._facts()

    # ---- the robot

    @property
    def virtual(self) -> bool:
        """Whether it is a virtual board, whose time goes in steps."""
        return self._virtual

    @property
    def robot(self) -> Any:
        """The objects of the spec. After `restore` and a lost link they are others."""
        return self._robot

    def _open(self, seed: int, state: BoardState | None = None) -> None:
        if self._virtual:
            joined = "&" if "?" in self._url else "?"
            self._link = connect(f"{self._url}{joined}seed={seed}", time="lockstep", state=state)
        else:
            self._link = connect(self._url)
        try:
            # a virtual board has compiled its spec already
            spec = self._spec if self._spec is not None else self._link.board.spec
            self._robot = load_spec_objects(spec, self._link)
            observed, commanded = self._asked
            reads = _chosen(self._robot, observed, ReadValue, lambda value: not isinstance(value, WriteValue))
            writes = _chosen(self._robot, commanded, WriteValue, lambda value: value.access != "PULSE")
            self.observed = [Channel.of(value, bounded=False) for value in reads]
            self.commanded = [Channel.of(value, bounded=True) for value in writes]
            if not self.observed or not self.commanded:
                what = "observed" if not self.observed else "commanded"
                raise UnityLinkError(f"{spec.source}: no number is {what}; give paths of values")
            self._sensors = ValueGroup(reads, "observed")
            self._commands = ValueGroup(writes, "commanded")
        except BaseException:
            self._shut()
            raise

    def _begin_episode(self, seed: int) -> None:
        link = self._link
        if link is None or link.closed or self._lost is not None:
            self._shut()
            self._open(seed)
        elif self._virtual:
            link.reset(seed)

    def _shut(self) -> None:
        self._lost = None
        if self._link is not None:
            self._link.close()
        self._link = None

    def _now(self) -> Link:
        if self._link is None:
            raise UnityLinkError("the environment is closed, or its link was lost; call reset()")
        return self._link

    def _wait(self, link: Link) -> None:
        self._due_s += self.task.dt_s
        if link.now_s() > self._due_s:
            self._missed += 1
            self._due_s = link.now_s()
        link.sleep_until(self._due_s)

    def _look(self) -> dict[str, Any]:
        return dict(self._sensors.snapshot())

    def _numbers(self, seen: Values) -> Numbers:
        self._last = np.array([float(seen[channel.path]) for channel in self.observed])
        return self._last

    def _facts(self) -> dict[str, Any]:
        time_s = round(self._now().now_s() - self._begun_s, 9)
        return {"time_s": time_s, "clipped": self._clipped, "missed": self._missed}

    def _called(self, what: str, function: Callable[..., Any], *arguments: Values) -> Any:
        try:
            return function(*arguments)
        except Exception as error:
            text = f"{what} failed at step {self._steps}: {type(error).__name__}: {error}"
            if isinstance(error, KeyError):  # a name that is not among its arguments
                there = [path for values in arguments for path in values]
                near = get_close_matches(str(error.args[0]), there, 3, 0.3) or there
                text += f"; nearest: {', '.join(near)}"
            raise UnityLinkError(text) from error


def _chosen(
    robot: Any,
    paths: Sequence[str] | None,
    kind: type[ReadValue[Any]] | type[WriteValue[Any]],
    fits: Callable[[Any], bool],
) -> list[Value[Any]]:
    if paths is None:
        return [value for value in robot if isinstance(value, kind) and is_number(value) and fits(value)]
    chosen: list[Value[Any]] = []
    for path in paths:
        value = robot[path]
        if not isinstance(value, kind) or not is_number(value):
            verb = "read" if kind is ReadValue else "written"
            raise ValueRangeError(f"{path} is no number that can be {verb}")
        chosen.append(value)
    return chosen


def _space(channels: Iterable[Channel]) -> gymnasium.spaces.Space[Numbers]:
    listed = list(channels)
    low = np.array([channel.low for channel in listed])
    high = np.array([channel.high for channel in listed])
    return gymnasium.spaces.Box(low, high, dtype=np.float64)
