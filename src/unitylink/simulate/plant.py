# SPDX-License-Identifier: BSD-3-Clause
"""Plants: what moves behind the registers of a virtual board, and how one is found by name or file."""

from __future__ import annotations

import runpy
from collections.abc import Callable
from pathlib import Path
from typing import Protocol, Union

from unitylink.errors import UnityLinkError
from unitylink.optional import absent
from unitylink.recording import ENDINGS
from unitylink.spec.model import Spec

from .plants.loopback import LoopbackPlant
from .plants.ramp import RampPlant
from .plants.recording import RecordingPlant
from .plants.scara import ScaraPlant
from .plants.words import WordPlant
from .registers import Registers


class Plant(Protocol):
    """Something that moves behind registers. The board's thread steps it every `period_s` of device time.

    An exception in `step` ends the plant, not the board. It is logged and kept in `board.error`.

    A plant may play components of the user's own, of which there is only VHDL. `plays` has their entities,
    and `play(time_s)` sets their words. It is called before each `step`, on the twin only.
    """

    period_s: float

    def attach(self, spec: Spec | None, registers: Registers) -> None:
        """Called once, before the first step."""

    def step(self, time_s: float) -> None:
        """Move on to device time `time_s`: read set-points from the registers, write what sensors measure."""


AnyPlant = Union[Plant, WordPlant]

PLANTS: dict[str, Callable[[], AnyPlant]] = {
    "ramp": RampPlant,
    "loopback": LoopbackPlant,
    "scara": ScaraPlant,
}
DEFAULT_PLANT = "ramp"
MUJOCO = "mujoco:"


def load_plant(name: str, spec: Spec | None = None) -> AnyPlant:
    """Return the plant called `name` (ramp, loopback, scara), or the plant in the file `name`.

    `mujoco:FILE` is a model of MuJoCo, MJCF, URDF or TOML with more about it (docs/mujoco.md). Otherwise the
    file is a recording, or Python with a class `Plant` that takes no arguments or a function
    `make_plant(spec)`. Raises UnityLinkError with the file's name and the reason, and ToolError if MuJoCo is
    absent.
    """
    if name in PLANTS:
        return PLANTS[name]()
    if name.startswith(MUJOCO):
        return _mujoco_plant(name.removeprefix(MUJOCO))
    path = Path(name)
    if path.suffix.lower() in ENDINGS:
        return RecordingPlant(path)
    if path.suffix != ".py":
        raise UnityLinkError(
            f"plant {name!r} is not known; choose {', '.join(PLANTS)}, a Python file (FILE.py), "
            "a recording (FILE.mcap, FILE.csv) or a model of MuJoCo (mujoco:FILE.xml)"
        )
    if not path.is_file():
        raise UnityLinkError(f"plant {name}: there is no such file")
    try:
        content = runpy.run_path(str(path), run_name=path.stem)
        if "make_plant" in content:
            plant = content["make_plant"](spec)
        elif content.get("Plant", Plant) is not Plant:  # the imported protocol `Plant` is not a plant itself
            plant = content["Plant"]()
        else:
            raise UnityLinkError(
                f"plant {name}: the file has neither a class Plant nor a function make_plant(spec)"
            )
    except UnityLinkError:
        raise
    except (Exception, SystemExit) as error:
        raise UnityLinkError(f"plant {name}: {type(error).__name__}: {error}") from error
    if isinstance(plant, WordPlant):
        return plant
    check_plant(plant, f"plant {name}")
    return plant  # type: ignore[no-any-return]  # check_plant has looked at what a Plant needs


def _mujoco_plant(file: str) -> Plant:
    try:
        from .plants.mujoco import MujocoPlant
    except ImportError:
        raise absent("mujoco-core", "a plant of MuJoCo") from None
    return MujocoPlant(file)


def check_plant(plant: object, what: str) -> None:
    """Raise UnityLinkError if `plant` has no period, or cannot be attached or stepped."""
    period_s = getattr(plant, "period_s", None)
    if not isinstance(period_s, (int, float)) or not 1e-5 <= period_s <= 3600:
        raise UnityLinkError(
            f"{what}: period_s is {period_s!r}; it must be a number of seconds, 1e-5 to 3600"
        )
    plays = getattr(plant, "plays", ())
    if not isinstance(plays, (tuple, list, set, frozenset)) or not all(isinstance(one, str) for one in plays):
        raise UnityLinkError(f"{what}: plays is {plays!r}; it must be entities, such as ('stepper',)")
    for method in ("attach", "step", "play") if hasattr(plant, "plays") else ("attach", "step"):
        if not callable(getattr(plant, method, None)):
            raise UnityLinkError(f"{what}: {type(plant).__name__} has no method {method}()")
