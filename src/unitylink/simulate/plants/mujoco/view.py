# SPDX-License-Identifier: BSD-3-Clause
"""A window with the model as it moves. It only looks: nothing in it moves the robot."""

from __future__ import annotations

import importlib.util
from typing import Any

import mujoco  # type: ignore[import-untyped]

from unitylink.errors import ToolError
from unitylink.optional import absent

from .camera import has_display
from .plant import MujocoPlant


class View:
    """A window of MuJoCo's passive viewer. Raises ToolError without a display, or without its package."""

    def __init__(self, plant: MujocoPlant) -> None:
        if not has_display():  # MuJoCo would end this process
            raise ToolError("a view needs a display, and there is none; --picture and --film need none")
        if importlib.util.find_spec("glfw") is None:
            raise absent("glfw", "a view of a model")
        from mujoco import viewer

        self._plant = plant
        # data of its own, because the plant moves in a thread of its own
        self._data: Any = mujoco.MjData(plant.model)
        self._window = viewer.launch_passive(plant.model, self._data, show_left_ui=False, show_right_ui=False)

    @property
    def open(self) -> bool:
        """Is the window still there?"""
        return bool(self._window.is_running())

    def show(self) -> None:
        """Show where the plant is now."""
        with self._window.lock():
            kind = mujoco.mjtState.mjSTATE_INTEGRATION
            mujoco.mj_setState(self._plant.model, self._data, self._plant.snapshot(), kind)
            mujoco.mj_forward(self._plant.model, self._data)
        self._window.sync()

    def close(self) -> None:
        """Close the window."""
        self._window.close()
