# SPDX-License-Identifier: BSD-3-Clause
"""Works with LeRobot itself: `python tools/lerobot/check.py FOLDER`, by the Python of build/lerobot."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))

from unit.lerobot.arm import write_arm  # noqa: E402
from unit.lerobot.published import ROBOT, TELEOPERATOR, shape_of  # noqa: E402

BIN = Path(sys.executable).parent
HOLD = '{"speed_limit": 3.0, "grip": 0.5}'
_PATIENCE_S = 600


def interface() -> None:
    """Compare our table with the classes."""
    from lerobot.robots import Robot
    from lerobot.teleoperators import Teleoperator

    for cls, table in ((Robot, ROBOT), (Teleoperator, TELEOPERATOR)):
        theirs = {name: shape_of(cls, name) for name in sorted(cls.__abstractmethods__)}
        assert theirs == dict(sorted(table.items())), (cls.__name__, theirs)
    print("interface: the table is that of the classes")


def data_set(folder: Path, url: str) -> None:
    """Record two episodes with our command, and read them with LeRobot's loader."""
    from lerobot.datasets.lerobot_dataset import LeRobotDataset
    from torch.utils.data import DataLoader

    for task in ("reach", "hold"):
        command = [sys.executable, "-m", "unitylink", "record", url, "--lerobot", str(folder)]
        done = subprocess.run(
            [*command, "--rate", "50", "--duration", "2", "--task", task], timeout=120, check=False
        )
        assert done.returncode in (0, 1), "1: a busy machine has lost a sample"
    info = json.loads((folder / "meta" / "info.json").read_text())
    times = {"observation.state": [-0.04, -0.02, 0.0]}
    data = LeRobotDataset("local/small_arm", root=folder, delta_timestamps=times)
    assert len(data) == info["total_frames"] and data.num_episodes == 2 and data.fps == 50
    first, last = data[0], data[len(data) - 1]
    assert (first["task"], last["task"]) == ("reach", "hold"), "tasks are texts"
    assert tuple(first["observation.state"].shape) == (3, info["features"]["observation.state"]["shape"][0])
    assert str(first["device_time"].dtype) == "torch.int64" and str(first["action"].dtype) == "torch.float32"
    batch = next(iter(DataLoader(data, batch_size=8, shuffle=True)))
    assert len(batch["task"]) == 8 and batch["device_time"].ndim == 2
    print(f"data set: {len(data)} frames of {data.num_episodes} episodes read by LeRobot's loader")


def commands(folder: Path, url: str) -> None:
    """Install the generated package, and teleoperate, record and replay."""
    subprocess.run(
        [sys.executable, "-m", "unitylink", "generate", "small_arm.ul", "--only", "lerobot"],
        cwd=folder,
        check=True,
        timeout=_PATIENCE_S,
    )
    package = folder / "lerobot" / "lerobot_robot_small_arm"
    pip = [
        sys.executable,
        "-m",
        "pip",
        "install",
        "--quiet",
        "--no-deps",
        "--no-build-isolation",
        "--force-reinstall",
    ]
    subprocess.run([*pip, str(package)], check=True, timeout=_PATIENCE_S)
    robot = ["--robot.type=small_arm", f"--robot.link={url}"]
    leader = ["--teleop.type=small_arm_leader", f"--teleop.link={url}", f"--teleop.hold={HOLD}"]
    recorded = folder / "by_lerobot"
    named = [f"--dataset.root={recorded}", "--dataset.repo_id=local/by_lerobot"]
    more = [
        "--dataset.video=false",
        "--dataset.push_to_hub=false",
        "--dataset.num_episodes=1",
        "--dataset.fps=30",
    ]
    times = ["--dataset.episode_time_s=3", "--dataset.reset_time_s=0", "--dataset.single_task=reach"]
    for name, arguments in (
        ("teleoperate", [*robot, *leader, "--fps=30", "--teleop_time_s=3"]),
        ("record", [*robot, *leader, *named, *more, *times, "--play_sounds=false"]),
        ("replay", [*robot, *named, "--dataset.episode=0", "--play_sounds=false"]),
    ):
        environment = os.environ | {"HF_HUB_OFFLINE": "1", "HF_HOME": str(folder / "hub")}
        done = subprocess.run(
            [BIN / f"lerobot-{name}", *arguments],
            env=environment,
            text=True,
            capture_output=True,
            timeout=300,
            check=False,
        )
        assert done.returncode == 0, f"lerobot-{name}: {done.stdout[-3000:]}{done.stderr[-3000:]}"
        print(f"lerobot-{name}: done")
    frames = json.loads((recorded / "meta" / "info.json").read_text())["total_frames"]
    assert frames > 20, frames


def main() -> None:
    folder = Path(sys.argv[1]).resolve()
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    url = write_arm(folder)
    interface()
    data_set(folder / "data", url)
    commands(folder, url)
    print("1 passed, 0 failed")


if __name__ == "__main__":
    main()
