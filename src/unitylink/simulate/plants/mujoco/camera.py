# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of a model of MuJoCo, with a display or without one."""

from __future__ import annotations

import ctypes
import importlib.util
import os
import sys
from difflib import get_close_matches
from importlib import import_module
from typing import Any

import mujoco  # type: ignore[import-untyped]
import numpy as np
import numpy.typing as npt

from unitylink.errors import ToolError, UnityLinkError
from unitylink.optional import absent

Pixels = npt.NDArray[np.uint8]  # (height, width, 3)

SHADOW_PIXELS, SAMPLES = 1024, 4  # MuJoCo's own of shadows take ten times as long without a graphics card
_REMEDY = "on Debian or Ubuntu: sudo apt-get install libegl1 libgl1-mesa-dri"
_LIBRARIES = {"egl": "libEGL.so.1", "osmesa": "libOSMesa.so.8"}


class Camera:
    """Looks at a model: through the camera of this name, or the first one, else from where all is seen.

    Raises ToolError if there is nothing that draws. It says what to install. Raises UnityLinkError if the
    model has no camera of this name.
    """

    def __init__(self, model: Any, width: int = 640, height: int = 480, name: str = "") -> None:
        number = _number_of(model, name) if name else 0
        self._model = model
        self._area = mujoco.MjrRect(0, 0, width, height)
        visual = model.vis
        visual.global_.offwidth = max(width, visual.global_.offwidth)
        visual.global_.offheight = max(height, visual.global_.offheight)
        visual.quality.shadowsize = min(SHADOW_PIXELS, visual.quality.shadowsize)
        visual.quality.offsamples = min(SAMPLES, visual.quality.offsamples)
        try:
            self._drawing = _drawing(width, height)
            self._drawing.make_current()
            self._context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100)
        except ToolError:
            raise
        except Exception as error:  # each way to draw has errors of its own
            what = f"{type(error).__name__}: {error}"
            raise ToolError(f"a picture of a model cannot be drawn ({what}); {_REMEDY}") from error
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._context)
        self._scene = mujoco.MjvScene(model, maxgeom=10_000)
        self._options = mujoco.MjvOption()
        self._camera = mujoco.MjvCamera()
        if model.ncam:
            self._camera.type, self._camera.fixedcamid = mujoco.mjtCamera.mjCAMERA_FIXED, number
        else:
            mujoco.mjv_defaultFreeCamera(model, self._camera)

    def shoot(self, data: Any) -> Pixels:
        """Return a picture of the model as it is now."""
        self._drawing.make_current()
        seen = mujoco.mjtCatBit.mjCAT_ALL
        mujoco.mjv_updateScene(self._model, data, self._options, None, self._camera, seen, self._scene)
        mujoco.mjr_render(self._area, self._scene, self._context)
        pixels = np.empty((self._area.height, self._area.width, 3), dtype=np.uint8)
        mujoco.mjr_readPixels(pixels, None, self._area, self._context)
        upright: Pixels = np.ascontiguousarray(pixels[::-1])  # OpenGL begins at the bottom
        return upright

    def close(self) -> None:
        """Give back what draws."""
        self._drawing.make_current()
        self._context.free()
        self._drawing.free()


def _number_of(model: Any, name: str) -> int:
    names = [model.camera(number).name for number in range(model.ncam)]
    if name not in names:
        near = ", ".join(get_close_matches(name, names, 3, 0.3) or names) or "none"
        raise UnityLinkError(f"the model has no camera {name!r}; nearest: {near}")
    return names.index(name)


def has_display() -> bool:
    """Is there a screen to show something on?"""
    return sys.platform != "linux" or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def _drawing(width: int, height: int) -> Any:
    """Return MuJoCo's context of OpenGL. MUJOCO_GL may say which."""
    if importlib.util.find_spec("OpenGL") is None:
        raise absent("pyopengl", "a picture of a model")
    kind = os.environ.get("MUJOCO_GL", "").lower()
    if not kind:
        kind = {"darwin": "cgl", "win32": "glfw"}.get(sys.platform, "")
    if not kind:
        kind = next((one for one, library in _LIBRARIES.items() if _is_there(library)), "")
        if not kind:
            raise ToolError(f"a picture of a model needs {_LIBRARIES['egl']}, which is absent; {_REMEDY}")
    return import_module(f"mujoco.{kind}").GLContext(width, height)


def _is_there(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True
