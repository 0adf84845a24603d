# SPDX-License-Identifier: BSD-3-Clause
"""Pictures and films of a plant of MuJoCo in files: PNG, GIF and MP4."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import mujoco  # type: ignore[import-untyped]

from unitylink.errors import ToolError, UnityLinkError
from unitylink.optional import absent
from unitylink.recording.pictures import png_of

from .camera import Camera, Pixels
from .plant import MujocoPlant

FILMS = (".gif", ".mp4")
MOST_FRAMES = 3000  # two minutes at 25 Hz
_STATE = mujoco.mjtState.mjSTATE_INTEGRATION


def save_picture(plant: MujocoPlant, file: str | Path, *, width: int = 640, height: int = 480) -> None:
    """Write a PNG of a plant as it is now. Raises ToolError if nothing draws (`Camera`)."""
    film = Film(plant, width=width, height=height)
    film.take()
    write_png(Path(file), film.pictures()[0])


class Film:
    """What a plant has done: `take` keeps where it is, and `save` draws all of it, at `rate_hz`.

    Only numbers are kept meanwhile, so the plant is not late because of its film.
    """

    def __init__(
        self, plant: MujocoPlant, *, rate_hz: float = 25, width: int = 640, height: int = 480
    ) -> None:
        self._plant = plant
        self._size = width, height
        self.rate_hz = rate_hz
        self._states: list[Any] = []

    def __len__(self) -> int:
        return len(self._states)

    def take(self) -> None:
        """Keep where the plant is. Does nothing if the film is full."""
        if len(self._states) < MOST_FRAMES:
            self._states.append(self._plant.snapshot())

    def pictures(self, which: Sequence[int] | None = None) -> list[Pixels]:
        """Draw what has been taken, or only the frames with these numbers."""
        model = self._plant.model
        data, camera = mujoco.MjData(model), Camera(model, *self._size)
        try:
            drawn = []
            for number in range(len(self._states)) if which is None else which:
                mujoco.mj_setState(model, data, self._states[number], _STATE)
                mujoco.mj_forward(model, data)
                drawn.append(camera.shoot(data))
            return drawn
        finally:
            camera.close()

    def save(self, file: str | Path) -> None:
        """Write a GIF or an MP4. Raises ToolError if nothing draws, or Pillow or ffmpeg is absent."""
        path = Path(file)
        kind = film_kind(path)
        if not self._states:
            raise UnityLinkError(f"{path}: nothing has been filmed")
        (_gif if kind == ".gif" else _mp4)(path, self.pictures(), self.rate_hz)


def film_kind(path: Path) -> str:
    """Return the ending of a film. Raises UnityLinkError for another, and ToolError for what it needs."""
    kind = path.suffix.lower()
    if kind not in FILMS:
        raise UnityLinkError(f"{path}: a film is a file that ends in {' or '.join(FILMS)}")
    if kind == ".mp4" and shutil.which("ffmpeg") is None:
        raise ToolError("a film as MP4 needs ffmpeg: sudo apt-get install ffmpeg, or take FILE.gif")
    if kind == ".gif":
        try:
            import PIL.Image  # noqa: F401
        except ImportError:
            raise absent("pillow", "a film as GIF") from None
    return kind


def _gif(path: Path, pictures: list[Pixels], rate_hz: float) -> None:
    from PIL import Image

    # The colours of the middle are those of all, so that they do not flicker.
    palette = Image.fromarray(pictures[len(pictures) // 2]).quantize(128)
    frames = [Image.fromarray(one).quantize(palette=palette, dither=Image.Dither.NONE) for one in pictures]
    # GIF counts in hundredths of a second
    duration_ms = 10 * max(2, round(100 / rate_hz))
    frames[0].save(
        path, save_all=True, append_images=frames[1:], duration=duration_ms, loop=0, optimize=False
    )


def _mp4(path: Path, pictures: list[Pixels], rate_hz: float) -> None:
    height, width, _ = pictures[0].shape
    command = ["ffmpeg", "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24"]
    command += ["-s", f"{width}x{height}", "-r", f"{rate_hz:g}", "-i", "-", "-pix_fmt", "yuv420p", str(path)]
    data = b"".join(one.tobytes() for one in pictures)
    done = subprocess.run(command, input=data, capture_output=True, check=False)
    if done.returncode:
        raise ToolError(f"{path}: ffmpeg failed: {done.stderr.decode(errors='replace').strip()[-300:]}")


def write_png(path: Path, pixels: Pixels) -> None:
    """Write a picture as PNG, without a package for it."""
    path.write_bytes(png_of(pixels))
