# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of an environment whose plant is a model of MuJoCo."""

from __future__ import annotations

from typing import Any

from unitylink.errors import UnityLinkError

MODES = ("rgb_array",)


class Pictures:
    """Draws what is behind a board. Raises UnityLinkError for another mode, and without a model."""

    def __init__(self, mode: str, board: Any) -> None:
        if mode not in MODES:
            raise UnityLinkError(f"render_mode is {mode!r}; there is {', '.join(MODES)}")
        plant = getattr(board, "plant", None)
        if not hasattr(plant, "camera"):
            raise UnityLinkError("render_mode needs a model of MuJoCo to draw: plant=mujoco:FILE.xml")
        self._plant: Any = None
        self._camera: Any = None
        self.draw(board)  # what is absent is told now

    def draw(self, board: Any) -> Any:
        """Return a picture of what is behind the board: rows of pixels, each of three bytes."""
        if board.plant is not self._plant:  # the board begins anew with the same, or it is another board
            self.close()
            self._plant, self._camera = board.plant, board.plant.camera()
        return self._camera.shoot(self._plant.data)

    def close(self) -> None:
        """Give back what draws."""
        if self._camera is not None:
            self._camera.close()
        self._camera = self._plant = None
