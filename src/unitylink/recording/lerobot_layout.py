# SPDX-License-Identifier: BSD-3-Clause
"""What the files of a LeRobot data set (format v3.0) are called, and what their columns are."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

VERSION = "v3.0"
CHUNK_FILES = 1000  # files in a folder
INFO, STATS, TASKS = Path("meta/info.json"), Path("meta/stats.json"), Path("meta/tasks.parquet")
OWN = Path("meta/unitylink.json")  # what LeRobot's own files have no place for
STATE, ACTION, DEVICE_TIME, LOST = "observation.state", "action", "device_time", "lost"
IMAGES = "observation.images."  # before the name of a camera
_COUNTED = ("frame_index", "episode_index", "index", "task_index")


def data_file(number: int) -> Path:
    """Return the place of the frames of an episode. Each episode has a file of its own."""
    return Path(f"data/chunk-{number // CHUNK_FILES:03d}/file-{number % CHUNK_FILES:03d}.parquet")


def episodes_file(number: int) -> Path:
    """Return the place of the facts about an episode."""
    return Path(f"meta/episodes/chunk-{number // CHUNK_FILES:03d}/file-{number % CHUNK_FILES:03d}.parquet")


@dataclass(frozen=True)
class Layout:
    """The frames of a data set: how many in a second, and the names of their numbers.

    `state` are the values that are observed, and `action` the set-points. `cameras` are pictures by name,
    with height and width.
    """

    fps: int
    state: tuple[str, ...]
    action: tuple[str, ...]
    robot_type: str
    cameras: tuple[tuple[str, tuple[int, int]], ...] = ()

    @property
    def features(self) -> dict[str, dict[str, Any]]:
        """The features of `meta/info.json`, in the order of the columns.

        The time at which each value was sampled does not begin with `observation.`: a policy would take it as
        an input.
        """

        def of(dtype: str, names: tuple[str, ...]) -> dict[str, Any]:
            return {
                "dtype": dtype,
                "shape": [len(names)],
                "names": [name.replace("/", ".") for name in names],
            }

        alone = {"shape": [1], "names": None}
        return {
            STATE: of("float32", self.state),
            ACTION: of("float32", self.action),
            DEVICE_TIME: of("int64", self.state),
            LOST: {"dtype": "int64", **alone},
            "timestamp": {"dtype": "float32", **alone},
            **{name: {"dtype": "int64", **alone} for name in _COUNTED},
            **{
                IMAGES + name: {
                    "dtype": "image",
                    "shape": [*size, 3],
                    "names": ["height", "width", "channels"],
                }
                for name, size in self.cameras
            },
        }

    def info(self, episodes: int, frames: int, tasks: int) -> dict[str, Any]:
        """Return the contents of `meta/info.json`."""
        return {
            "codebase_version": VERSION,
            "robot_type": self.robot_type,
            "total_episodes": episodes,
            "total_frames": frames,
            "total_tasks": tasks,
            "chunks_size": CHUNK_FILES,
            "data_files_size_in_mb": 100,
            "video_files_size_in_mb": 200,
            "fps": self.fps,
            "splits": {"train": f"0:{episodes}"},
            "data_path": "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
            "video_path": None,
            "features": self.features,
        }
