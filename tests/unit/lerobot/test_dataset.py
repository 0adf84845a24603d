# SPDX-License-Identifier: BSD-3-Clause
"""A data set of LeRobot: its files, columns and types are those of format v3.0.

The table is from LeRobot 0.6.1 (https://huggingface.co/docs/lerobot/lerobot-dataset-v3 and its own files),
read in November 2026. `make lerobot` reads a data set with LeRobot's own loader.
"""

from __future__ import annotations

import io
import json
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from PIL import Image
from pyarrow import parquet
from unit.lerobot.arm import write_arm

from unitylink.cli import main
from unitylink.errors import UnityLinkError, ValueRangeError
from unitylink.recording.frames import Frames
from unitylink.recording.lerobot_dataset import LerobotDataset
from unitylink.recording.lerobot_layout import Layout

LAYOUT = Layout(50, ("j1.position", "j1.speed"), ("j1.target",), "arm")
COLUMNS = {
    "observation.state": pa.list_(pa.float32(), 2),
    "action": pa.float32(),  # one number is no list
    "device_time": pa.list_(pa.int64(), 2),
    "lost": pa.int64(),
    "timestamp": pa.float32(),
    "frame_index": pa.int64(),
    "episode_index": pa.int64(),
    "index": pa.int64(),
    "task_index": pa.int64(),
}
INFO = {
    "codebase_version": "v3.0",
    "robot_type": "arm",
    "total_episodes": 2,
    "total_frames": 7,
    "total_tasks": 2,
    "chunks_size": 1000,
    "data_files_size_in_mb": 100,
    "video_files_size_in_mb": 200,
    "fps": 50,
    "splits": {"train": "0:2"},
    "data_path": "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
    "video_path": None,
}
EPISODE = {
    "episode_index": pa.int64(),
    "tasks": pa.list_(pa.string()),
    **dict.fromkeys(
        (
            *("length", "data/chunk_index", "data/file_index", "dataset_from_index", "dataset_to_index"),
            *("meta/episodes/chunk_index", "meta/episodes/file_index"),
        ),
        pa.int64(),
    ),
}
STATISTICS = ("min", "max", "mean", "std", "count", "q01", "q10", "q50", "q90", "q99")


def episode(folder: Path, frames: int, task: str, lost: int = 0) -> None:
    data = LerobotDataset(folder, LAYOUT, {"spec": "arm.ul"})
    for k in range(frames):
        data.add([0.5 * k, 1.0], [2.0 * k], sampled_ns=[20_000_000 * k, 20_000_000 * k - 5], lost=lost)
    data.save_episode(task)


def test_files_columns_and_types(tmp_path: Path) -> None:
    folder = tmp_path / "arm"
    episode(folder, 4, "reach")
    episode(folder, 3, "hold", lost=2)
    files = sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())
    assert files == [
        *(f"data/chunk-000/file-00{n}.parquet" for n in range(2)),
        *(f"meta/episodes/chunk-000/file-00{n}.parquet" for n in range(2)),
        *(f"meta/{name}" for name in ("info.json", "stats.json", "tasks.parquet", "unitylink.json")),
    ]
    info = json.loads((folder / "meta/info.json").read_text())
    features = info.pop("features")
    assert info == INFO
    assert list(features) == list(COLUMNS) and not any("/" in name for name in features)
    for name, feature in features.items():
        assert set(feature) == {"dtype", "shape", "names"}
        kind = COLUMNS[name]
        listed = pa.types.is_fixed_size_list(kind)
        assert feature["shape"] == [kind.list_size if listed else 1], name
        assert feature["dtype"] == {"float": "float32"}.get(str(kind.value_type if listed else kind), "int64")
    assert features["observation.state"]["names"] == list(LAYOUT.state)
    table = parquet.read_table(folder / "data/chunk-000/file-001.parquet")
    assert {field.name: field.type for field in table.schema} == COLUMNS
    rows = table.to_pydict()
    assert (
        rows["index"] == [4, 5, 6] and rows["frame_index"] == [0, 1, 2] and rows["episode_index"] == [1] * 3
    )
    assert rows["timestamp"] == pytest.approx([0, 0.02, 0.04]) and rows["lost"] == [2] * 3
    assert rows["device_time"][2] == [40_000_000, 39_999_995]
    assert parquet.ParquetFile(folder / "data/chunk-000/file-000.parquet").metadata.row_group(0).column(
        0
    ).compression == ("SNAPPY")


def test_episodes_tasks_and_statistics(tmp_path: Path) -> None:
    episode(tmp_path, 4, "reach")
    episode(tmp_path, 3, "hold", lost=2)
    table = parquet.read_table(tmp_path / "meta/episodes/chunk-000/file-001.parquet")
    types = {field.name: field.type for field in table.schema}
    assert {name: types[name] for name in EPISODE} == EPISODE
    assert set(types) - set(EPISODE) == {f"stats/{name}/{part}" for name in COLUMNS for part in STATISTICS}
    assert all(pa.types.is_list(types[name]) for name in types if name.startswith("stats/"))
    (row,) = table.to_pylist()
    assert (row["episode_index"], row["length"], row["tasks"]) == (1, 3, ["hold"])
    assert (row["dataset_from_index"], row["dataset_to_index"], row["data/file_index"]) == (4, 7, 1)
    assert row["stats/action/max"] == [4.0] and row["stats/action/count"] == [3]
    import pandas as pd  # this takes long, so only one worker imports it

    tasks = pd.read_parquet(tmp_path / "meta/tasks.parquet")
    assert tasks.index.name == "task" and tasks["task_index"].to_dict() == {"reach": 0, "hold": 1}
    stats = json.loads((tmp_path / "meta/stats.json").read_text())
    assert set(stats) == set(COLUMNS) and set(stats["action"]) == set(STATISTICS)
    assert (
        stats["action"]["max"] == [6.0] and stats["index"]["count"] == [7] and stats["index"]["q50"] == [3.0]
    )
    assert json.loads((tmp_path / "meta/unitylink.json").read_text()) == {"spec": "arm.ul", "lost": [0, 2]}


def test_pictures_are_png_in_the_parquet_and_their_colours_have_statistics(tmp_path: Path) -> None:
    layout = replace(LAYOUT, cameras=(("front", (2, 3)),))
    for level in (0, 102):
        data = LerobotDataset(tmp_path, layout)
        for k in range(2):
            pixels = np.full((2, 3, 3), (level, level + 51 * k, 255), np.uint8)
            data.add([0.0, 0.0], [0.0], sampled_ns=[0, 0], look=lambda seen=pixels: {"front": seen})
        data.save_episode("look")
    info = json.loads((tmp_path / "meta/info.json").read_text())
    name = "observation.images.front"
    assert info["features"][name] == {
        "dtype": "image",
        "shape": [2, 3, 3],
        "names": ["height", "width", "channels"],
    }
    table = parquet.read_table(tmp_path / "data/chunk-000/file-001.parquet")
    assert table.schema.field(name).type == pa.struct([("bytes", pa.binary()), ("path", pa.string())])
    with Image.open(io.BytesIO(table[name].to_pylist()[1]["bytes"])) as picture:
        assert picture.size == (3, 2) and picture.getpixel((2, 1)) == (102, 153, 255)
    colours = json.loads((tmp_path / "meta/stats.json").read_text())[name]
    assert set(colours) == set(STATISTICS) and colours["count"] == [4]
    assert colours["min"] == [[[0.0]], [[0.0]], [[1.0]]] and colours["max"] == [[[0.4]], [[0.6]], [[1.0]]]
    assert np.ravel(colours["mean"]) == pytest.approx([0.2, 0.3, 1.0])
    assert np.ravel(colours["std"]) == pytest.approx([0.2, np.std([0, 0.2, 0.4, 0.6]), 0.0])
    data.add([0.0, 0.0], [0.0], sampled_ns=[0, 0], look=lambda: {"front": np.zeros((2, 2, 3), np.uint8)})
    with pytest.raises(ValueRangeError, match=r"camera front: a picture of \(2, 2, 3\); expected bytes"):
        data.save_episode("look")
    with pytest.raises(ValueRangeError, match="must return those of front"):
        data.add([0.0, 0.0], [0.0], sampled_ns=[0, 0])
    with pytest.raises(UnityLinkError, match="other features"):
        LerobotDataset(tmp_path, LAYOUT)


def test_another_data_set_is_not_mixed_in(tmp_path: Path) -> None:
    episode(tmp_path / "arm", 2, "reach")
    for layout, says in (
        (Layout(30, LAYOUT.state, LAYOUT.action, "arm"), r"other frames a second \(50, not 30\)"),
        (Layout(50, LAYOUT.state, LAYOUT.action, "leg"), r"other robot \(arm, not leg\)"),
        (Layout(50, LAYOUT.state[:1], LAYOUT.action, "arm"), "other features"),
    ):
        with pytest.raises(UnityLinkError, match=says):
            LerobotDataset(tmp_path / "arm", layout)
    (tmp_path / "notes").mkdir()
    (tmp_path / "notes" / "a.txt").write_text("mine")
    with pytest.raises(UnityLinkError, match="no data set of LeRobot"):
        LerobotDataset(tmp_path / "notes", LAYOUT)
    data = LerobotDataset(tmp_path / "new", LAYOUT)
    with pytest.raises(UnityLinkError, match="an episode needs a frame"):
        data.save_episode("nothing")
    with pytest.raises(ValueRangeError, match="expected"):
        data.add([1.0], [1.0], sampled_ns=[1])
    assert not (tmp_path / "new").exists()


def test_frames_have_the_newest_values_and_their_times(tmp_path: Path) -> None:
    data = LerobotDataset(tmp_path, LAYOUT)
    frames = Frames(data, lambda: 0)
    frames.take(9.0, {"j1.target": 1.0})
    assert set(frames.missing()) == {"j1.position", "j1.speed"}
    frames.take(10.0, {"j1.position": 0.0, "j1.speed": 5.0})  # all are known: the first frame
    for k in range(1, 10):
        frames.take(10.0 + 0.01 * k, {"j1.position": float(k)})
    frames.take(10.2, {"j1.position": 20.0, "j1.target": 2.0})  # nothing came for 0.1 s
    frames.until(10.2)
    data.save_episode("x")
    rows = parquet.read_table(tmp_path / "data/chunk-000/file-000.parquet").to_pydict()
    assert len(rows["index"]) == 11 and frames.held == 4
    assert [state[0] for state in rows["observation.state"]] == [0, 2, 4, 6, 8, 9, 9, 9, 9, 9, 20]
    assert rows["device_time"][1] == [20_000_000, 0] and rows["device_time"][6] == [90_000_000, 0]
    assert rows["action"] == [1.0] * 10 + [2.0]


@pytest.mark.takes(3)
def test_record_writes_episodes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    url, folder = write_arm(tmp_path), tmp_path / "data"

    def record(*more: str) -> dict[str, Any]:
        assert main(["record", url, "--lerobot", str(folder), "--rate", "50", "--json", *more]) in (0, 1)
        told: dict[str, Any] = json.loads(capsys.readouterr().out)
        return told

    first, second = record("--task", "reach", "--duration", "1.5"), record("--duration", "1.3")
    assert (first["episode"], second["episode"]) == (0, 1) and first["frames"] > 10
    table = parquet.read_table(folder / "data/chunk-000/file-000.parquet")
    assert table.num_rows == first["frames"]
    times = table.column("device_time").to_pylist()
    info = json.loads((folder / "meta/info.json").read_text())
    names = info["features"]["observation.state"]["names"]
    assert "j[0].position" in names and "mode" not in names
    place = names.index("j[0].position")
    steps = [later[place] - earlier[place] for earlier, later in pairwise(times)]
    near = [(step + 2_000_000) % 10_000_000 < 4_000_000 for step in steps]
    assert sum(near) > 0.7 * len(near), "published each 10 ms; a busy machine learns the clock late"
    own = json.loads((folder / "meta/unitylink.json").read_text())
    assert own["units"]["j[0].position"] == "rad" and len(own["lost"]) == 2
    assert main(["record", url, "j[0].position", "--lerobot", str(tmp_path / "no"), "--count", "3"]) == 1
    assert "a policy learns from both sides" in capsys.readouterr().err
    assert main(["record", url, "--lerobot", str(folder), "--out", "a.csv"]) == 2
    assert main(["record", url, "--task", "x", "--count", "1", "--out", str(tmp_path / "a.csv")]) == 2
