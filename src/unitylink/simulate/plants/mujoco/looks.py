# SPDX-License-Identifier: BSD-3-Clause
"""What the cameras of a model see, kept now and drawn later."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import mujoco  # type: ignore[import-untyped]

from .camera import Camera, Pixels
from .plant import MujocoPlant


class Looks:
    """Cameras of a plant by name, with height and width.

    `keep` keeps where the plant is, which takes microseconds, and returns a function that draws it. Raises
    UnityLinkError for a camera that the model does not have, and ToolError if nothing draws.
    """

    def __init__(self, plant: MujocoPlant, sizes: Mapping[str, tuple[int, int]]) -> None:
        self._plant = plant
        self._data: Any = mujoco.MjData(plant.model)
        self._cameras: dict[str, Camera] = {}
        for name, (height, width) in sizes.items():
            self._cameras[name] = Camera(plant.model, width, height, name)

    def keep(self) -> Callable[[], dict[str, Pixels]]:
        """Keep where the plant is. Also from another thread than that of the plant."""
        state = self._plant.snapshot()
        return lambda: self._draw(state)

    def close(self) -> None:
        """Give back what draws."""
        for camera in self._cameras.values():
            camera.close()

    def _draw(self, state: Any) -> dict[str, Pixels]:
        model = self._plant.model
        mujoco.mj_setState(model, self._data, state, mujoco.mjtState.mjSTATE_INTEGRATION)
        mujoco.mj_forward(model, self._data)
        return {name: camera.shoot(self._data) for name, camera in self._cameras.items()}
