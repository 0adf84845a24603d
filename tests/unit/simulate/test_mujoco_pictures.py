# SPDX-License-Identifier: BSD-3-Clause
"""Pictures and films of a model of MuJoCo, drawn without a display, and what is told if they cannot be."""

from __future__ import annotations

import importlib.util
import io
import shutil
from pathlib import Path

import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from PIL import Image
from pyarrow import parquet

import unitylink.gym
from unitylink import connect
from unitylink.cli import main
from unitylink.commands.model_view import ModelView
from unitylink.errors import ToolError, UnityLinkError
from unitylink.simulate.plants.mujoco import Film, MujocoPlant, camera, save_picture
from unitylink.simulate.plants.mujoco.view import View

SPEC = 'public arm() { @turn = 0x10: f32 READ(UNIT="rad"); @turn_goal = 0x20: f32 WRITE(UNIT="rad"); }'
MODEL = """
<mujoco>
  <option gravity="0 0 0" integrator="implicitfast" timestep="0.001"/>
  <visual><headlight ambient=".6 .6 .6"/></visual>
  <worldbody>
    <camera name="above" pos="0 0 2"/>
    <body>
      <joint name="turn" axis="0 0 1" armature=".01"/>
      <geom type="box" size=".3 .05 .05" pos=".3 0 0" rgba="1 0 0 1"/>
    </body>
  </worldbody>
  <actuator><position name="turn_goal" joint="turn" kp="400" dampratio="1"/></actuator>
</mujoco>
"""


@pytest.fixture
def url(tmp_path: Path) -> str:
    (tmp_path / "arm.ul").write_text(SPEC)
    (tmp_path / "arm.xml").write_text(MODEL)
    return f"sim:{tmp_path / 'arm.ul'}?plant=mujoco:{tmp_path / 'arm.xml'}"


def red(file: Path | Image.Image) -> tuple[float, float]:
    """Return the middle of what is red, in parts of the picture's width and height."""
    with Image.open(file) if isinstance(file, Path) else file as image:
        pixels = np.asarray(image.convert("RGB")).astype(int)
    rows, columns = np.nonzero(pixels[..., 0] - pixels[..., 1:].max(axis=-1) > 60)
    assert len(rows) > 0.005 * pixels[..., 0].size
    return float(columns.mean()) / pixels.shape[1], float(rows.mean()) / pixels.shape[0]


def test_a_picture_and_a_film_show_where_the_arm_is(url: str, tmp_path: Path) -> None:
    with connect(url, time="lockstep") as link:
        plant = link.board.plant
        film = Film(plant, width=160, height=120)
        save_picture(plant, tmp_path / "start.png", width=160, height=120)
        link.write(0x20, int(np.float32(np.pi / 2).view(np.uint32)))
        for _ in range(10):
            film.take()
            link.step(0.04)
        save_picture(plant, tmp_path / "end.png", width=160, height=120)
        film.save(tmp_path / "arm.gif")
        assert plant.data.qpos[0] == pytest.approx(np.pi / 2, abs=0.01)  # nobody has moved it but the PC
    (start, end), (x, y) = (red(tmp_path / name) for name in ("start.png", "end.png")), (0.5, 0.5)
    assert start[0] > x + 0.1 and start[1] == pytest.approx(y, abs=0.03)
    assert end[1] < y - 0.1 and end[0] == pytest.approx(x, abs=0.03)
    with Image.open(tmp_path / "arm.gif") as frames:
        assert frames.n_frames == 10 and frames.info["duration"] == 40
        assert red(frames.convert("RGB")) == pytest.approx(start, abs=0.02)
        frames.seek(9)
        assert red(frames.convert("RGB")) == pytest.approx(end, abs=0.05)


def test_a_served_board_leaves_picture_and_film(url: str, tmp_path: Path) -> None:
    plant = MujocoPlant(url.partition("mujoco:")[2])
    shown = ModelView(plant, False, tmp_path / "arm.png", tmp_path / "arm.gif")
    assert shown.tick_s is not None and shown.look() is False
    shown.finish()
    assert red(tmp_path / "arm.png")[0] > 0.6
    assert (tmp_path / "arm.gif").stat().st_size > 1000


def test_a_data_set_of_lerobot_has_what_a_camera_sees(
    url: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    asked = ["record", url, "--lerobot", str(tmp_path / "data"), "--rate", "10", "--count", "6"]
    assert main([*asked, "--camera", "above:160x120"]) == 0
    name, files = "observation.images.above", tmp_path / "data/data/chunk-000"
    rows = parquet.read_table(files / "file-000.parquet", columns=[name])[name].to_pylist()
    assert len(rows) >= 2
    for row in rows:
        with Image.open(io.BytesIO(row["bytes"])) as picture:
            assert picture.size == (160, 120) and red(picture)[0] > 0.6
    capsys.readouterr()
    assert main([*asked, "--camera", "abov"]) == 1
    assert "the model has no camera 'abov'; nearest: above" in capsys.readouterr().err
    asked[1] = url.partition("?")[0]
    assert main([*asked, "--camera", "above"]) == 1
    assert "the link leads to no model of MuJoCo" in capsys.readouterr().err


def test_what_cannot_be_shown_is_told(url: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    plant = MujocoPlant(url.partition("mujoco:")[2])
    with pytest.raises(UnityLinkError, match=r"a film is a file that ends in .gif or .mp4"):
        ModelView(plant, False, None, tmp_path / "arm.avi")
    with pytest.raises(UnityLinkError, match="nothing has been filmed"):
        Film(plant).save(tmp_path / "arm.gif")
    monkeypatch.setattr(shutil, "which", lambda name: None)
    with pytest.raises(ToolError, match=r"sudo apt-get install ffmpeg, or take FILE.gif"):
        ModelView(plant, False, None, tmp_path / "arm.mp4")
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "MUJOCO_GL"):
        monkeypatch.delenv(name, raising=False)
    with pytest.raises(ToolError, match="a view needs a display, and there is none"):
        View(plant)
    monkeypatch.setattr(camera, "_is_there", lambda library: False)
    with pytest.raises(
        ToolError, match=r"needs libEGL.so.1, which is absent; .* install libegl1 libgl1-mesa-dri"
    ):
        save_picture(plant, tmp_path / "arm.png")
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(ToolError, match="a picture of a model needs the package pyopengl"):
        save_picture(plant, tmp_path / "arm.png")


def test_only_a_model_can_be_shown(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "arm.ul").write_text(SPEC)
    assert main(["simulate", str(tmp_path / "arm.ul"), "--picture", str(tmp_path / "arm.png")]) == 2
    assert "give one with --plant mujoco:FILE.xml" in capsys.readouterr().err


LEARNED = 'public arm() { @turn = 0x10: i16 READ(UNIT="rad", SCALE=0.001); '
LEARNED += '@turn_goal = 0x20: i16 WRITE(UNIT="rad", SCALE=0.001, MIN=-2, MAX=2, OVERFLOW=saturate); }'


@pytest.mark.filterwarnings("ignore:.*normalized space.*", "ignore:.*not having a spec.*")
def test_an_environment_to_learn_in_draws_itself(url: str, tmp_path: Path) -> None:
    (tmp_path / "arm.ul").write_text(LEARNED)

    def reward(seen: object, written: object) -> float:
        return 0.0

    env = unitylink.gym.make(url, dt_s=0.05, reward=reward, render_mode="rgb_array")
    check_env(env, skip_close_check=True)
    for _ in range(2):
        env.reset(seed=1)
        assert red(Image.fromarray(env.render()))[0] > 0.6
        for _ in range(8):
            env.step(np.array([np.pi / 2]))
        assert red(Image.fromarray(env.render()))[1] < 0.4
    env.close()
    env.close()
    plain = unitylink.gym.make(url, dt_s=0.05, reward=reward)
    assert plain.render() is None
    plain.close()
    with pytest.raises(UnityLinkError, match="render_mode is 'human'; there is rgb_array"):
        unitylink.gym.make(url, dt_s=0.05, reward=reward, render_mode="human")
    with pytest.raises(UnityLinkError, match="render_mode needs a model of MuJoCo"):
        unitylink.gym.make(url.partition("?")[0], dt_s=0.05, reward=reward, render_mode="rgb_array")
