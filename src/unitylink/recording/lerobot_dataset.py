# SPDX-License-Identifier: BSD-3-Clause
"""A data set of LeRobot (format v3.0), written with pyarrow. LeRobot itself is not needed.

>>> import tempfile
>>> layout = Layout(50, ("j1.position",), ("j1.target",), "arm")
>>> data = LerobotDataset(tempfile.mkdtemp() + "/arm", layout)
>>> data.add([0.5], [1.0], sampled_ns=[0])
>>> data.save_episode("hold still").frames
1
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from unitylink.errors import UnityLinkError, ValueRangeError
from unitylink.output_file import replace_file

from .lerobot_layout import (
    ACTION,
    CHUNK_FILES,
    DEVICE_TIME,
    IMAGES,
    INFO,
    LOST,
    OWN,
    STATE,
    STATS,
    TASKS,
    VERSION,
    Layout,
    data_file,
    episodes_file,
)
from .parquet import columns_of, read_columns, task_table, write_table
from .pictures import QUANTILES, ColourStatistics, Pixels, png_of, together

Look = Callable[[], Mapping[str, Pixels]]
_EFFORT = 4  # of zlib: more of it takes three times as long, for a tenth less


@dataclass(frozen=True)
class Episode:
    """An episode that has been saved."""

    number: int
    frames: int
    lost: int


class LerobotDataset:
    """The data set in a folder. A new episode goes behind those that are there.

    `origin` says where it comes from, such as the spec and its hash. It is kept in `meta/unitylink.json`.
    Raises UnityLinkError if the folder holds something else, or a data set with other frames.
    """

    def __init__(self, folder: str | Path, layout: Layout, origin: Mapping[str, Any] | None = None) -> None:
        self.folder, self.layout = Path(folder), layout
        self._origin = dict(origin or {})
        self._frames: list[tuple[Sequence[float], Sequence[float], Sequence[int], int]] = []
        self._looks: list[Look] = []
        self._info = self._present()
        self.episodes = int(self._info["total_episodes"]) if self._info else 0

    def add(
        self,
        state: Sequence[float],
        action: Sequence[float],
        *,
        sampled_ns: Sequence[int],
        lost: int = 0,
        look: Look | None = None,
    ) -> None:
        """Add a frame. The times of its values are those of the device, in ns since the episode began.

        `lost` is how many samples have been lost in this episode so far. `look` returns the pictures of the
        cameras of the layout, by name. It is called when the episode is saved, so that no frame is late.
        """
        wanted = len(self.layout.state), len(self.layout.action), len(self.layout.state)
        given = len(state), len(action), len(sampled_ns)
        if given != wanted:
            raise ValueRangeError(f"a frame of {given} numbers (state, action, times); expected {wanted}")
        if self.layout.cameras:
            if look is None:
                names = ", ".join(name for name, _ in self.layout.cameras)
                raise ValueRangeError(f"a frame without pictures; look must return those of {names}")
            self._looks.append(look)
        self._frames.append((tuple(state), tuple(action), tuple(sampled_ns), lost))

    def __len__(self) -> int:
        """Return how many frames the episode has so far."""
        return len(self._frames)

    def save_episode(self, task: str, *, lost: int | None = None) -> Episode:
        """Write the frames as an episode. `lost` are all samples that it lacks.

        Raises UnityLinkError if there are no frames, or if writing fails.
        """
        if not self._frames:
            raise UnityLinkError(f"{self.folder}: an episode needs a frame")
        count, number = len(self._frames), self.episodes
        before = int(self._info["total_frames"]) if self._info else 0
        tasks = self._tasks()
        if task not in tasks:
            tasks.append(task)
        columns = self._columns(number, before, tasks.index(task))
        facts = {
            "episode_index": number,
            "tasks": [task],
            "length": count,
            "data/chunk_index": number // CHUNK_FILES,
            "data/file_index": number % CHUNK_FILES,
            "dataset_from_index": before,
            "dataset_to_index": before + count,
            "meta/episodes/chunk_index": number // CHUNK_FILES,
            "meta/episodes/file_index": number % CHUNK_FILES,
        }
        statistics = _statistics(columns)
        for camera, pngs, colours in self._pictures():
            columns[IMAGES + camera] = pngs
            statistics[IMAGES + camera] = colours
        for feature, numbers in statistics.items():
            facts |= {f"stats/{feature}/{name}": value for name, value in numbers.items()}
        lost = self._frames[-1][3] if lost is None else lost
        try:
            write_table(self.folder / data_file(number), columns_of(self.layout.features, columns))
            write_table(self.folder / episodes_file(number), {name: [value] for name, value in facts.items()})
            write_table(self.folder / TASKS, task_table(tasks))
            self._write_json(STATS, self._all_statistics(number + 1))
            self._write_json(OWN, self._own(number, lost))
            info = self.layout.info(number + 1, before + count, len(tasks))
            self._write_json(INFO, info)  # last: only now the episode counts
        except OSError as error:
            raise UnityLinkError(f"{self.folder}: {error.strerror or error}") from error
        self._info, self.episodes, self._frames, self._looks = info, number + 1, [], []
        return Episode(number, count, lost)

    def _present(self) -> dict[str, Any] | None:
        """Return the info of a data set that is there, after a look at whether an episode fits it."""
        if not self.folder.exists() or (self.folder.is_dir() and not any(self.folder.iterdir())):
            return None
        try:
            info = json.loads((self.folder / INFO).read_text(encoding="utf-8"))
            found = info["codebase_version"], info["fps"], info["robot_type"], info["features"]
        except (OSError, ValueError, KeyError, TypeError):
            raise UnityLinkError(
                f"{self.folder}: this is no data set of LeRobot; name a new folder, or one with a data set"
            ) from None
        wanted = VERSION, self.layout.fps, self.layout.robot_type, self.layout.features
        for what, ours, theirs in zip(
            ("version", "frames a second", "robot", "features"), wanted, found, strict=True
        ):
            if ours != theirs:
                raise UnityLinkError(
                    f"{self.folder}: the data set there has other {what} ({_short(theirs)}, not "
                    f"{_short(ours)}); name a new folder"
                )
        return dict(info)

    def _tasks(self) -> list[str]:
        if self._info is None:
            return []
        read = read_columns(self.folder / TASKS, ("task_index", "task"))
        pairs = zip(read["task_index"].to_pylist(), read["task"].to_pylist(), strict=True)
        return [task for _, task in sorted(pairs)]

    def _columns(self, episode: int, first: int, task: int) -> dict[str, Any]:
        states, actions, times, lost = zip(*self._frames, strict=True)
        count = len(self._frames)
        frame = np.arange(count, dtype=np.int64)
        return {
            STATE: np.array(states, np.float32).reshape(count, -1),
            ACTION: np.array(actions, np.float32).reshape(count, -1),
            DEVICE_TIME: np.array(times, np.int64).reshape(count, -1),
            LOST: np.array(lost, np.int64),
            "timestamp": (frame / self.layout.fps).astype(np.float32),
            "frame_index": frame,
            "episode_index": np.full(count, episode, np.int64),
            "index": first + frame,
            "task_index": np.full(count, task, np.int64),
        }

    def _pictures(self) -> Iterator[tuple[str, list[bytes], dict[str, Any]]]:
        """Yield for each camera its name, its pictures as PNG, and the statistics of their colours."""
        made: dict[str, tuple[list[bytes], ColourStatistics]] = {
            name: ([], ColourStatistics()) for name, _ in self.layout.cameras
        }
        for look in self._looks:
            seen = look()
            for name, size in self.layout.cameras:
                pixels = seen.get(name)
                shape = None if pixels is None else pixels.shape
                if pixels is None or shape != (*size, 3) or pixels.dtype != np.uint8:
                    raise ValueRangeError(f"camera {name}: a picture of {shape}; expected bytes {(*size, 3)}")
                pngs, colours = made[name]
                pngs.append(png_of(pixels, effort=_EFFORT))
                colours.add(pixels)
        for name, (pngs, colours) in made.items():
            yield name, pngs, colours.numbers()

    def _all_statistics(self, episodes: int) -> dict[str, dict[str, list[Any]]]:
        """Return those of all episodes. Of numbers they are exact, and not put together."""
        cameras = [IMAGES + name for name, _ in self.layout.cameras]
        names = tuple(name for name in self.layout.features if name not in cameras)
        parts = [read_columns(self.folder / data_file(number), names) for number in range(episodes)]
        found = _statistics({name: np.concatenate([_array(part[name]) for part in parts]) for name in names})
        keys = ("min", "max", "mean", "std", "count", *QUANTILES)
        for camera in cameras:
            wanted = [f"stats/{camera}/{key}" for key in keys]
            rows = [read_columns(self.folder / episodes_file(number), wanted) for number in range(episodes)]
            found[camera] = together(
                [
                    {key: row[name].to_pylist()[0] for key, name in zip(keys, wanted, strict=True)}
                    for row in rows
                ]
            )
        return found

    def _own(self, number: int, lost: int) -> dict[str, Any]:
        try:
            told = json.loads((self.folder / OWN).read_text(encoding="utf-8"))["lost"]
        except (OSError, ValueError, KeyError):
            told = []
        return {**self._origin, "lost": [*told[:number], lost]}

    def _write_json(self, name: Path, content: Any) -> None:
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        replace_file(path, json.dumps(content, indent=4) + "\n")


def _array(column: Any) -> Any:
    """Return a column as an array of one or two dimensions."""
    return np.array(column.to_pylist())


def _statistics(columns: Mapping[str, Any]) -> dict[str, dict[str, list[Any]]]:
    found = {}
    for name, column in columns.items():
        rows = np.asarray(column, np.float64).reshape(len(column), -1)
        numbers = {
            "min": rows.min(axis=0),
            "max": rows.max(axis=0),
            "mean": rows.mean(axis=0),
            "std": rows.std(axis=0),
            **{key: np.quantile(rows, part, axis=0) for key, part in QUANTILES.items()},
        }
        found[name] = {key: value.tolist() for key, value in numbers.items()} | {"count": [len(rows)]}
    return found


def _short(value: Any) -> str:
    text = str(value if not isinstance(value, dict) else {k: v.get("names") for k, v in value.items()})
    return text if len(text) < 120 else f"{text[:117]}..."
