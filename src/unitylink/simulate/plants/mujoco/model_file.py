# SPDX-License-Identifier: BSD-3-Clause
"""The file of a plant of MuJoCo: MJCF, URDF, or TOML that names one of both and says more about values."""

from __future__ import annotations

import logging
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import ParseError, parse

import mujoco  # type: ignore[import-untyped]

from unitylink.errors import UnityLinkError

from ...machine import DcMotorData
from .own_motors import motors_of

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

_KEYS = ("model", "shared", "values", "motors")
_log = logging.getLogger("unitylink.simulate")


@dataclass(frozen=True)
class ModelFile:
    """A model, and what the TOML says about values, by their paths. `notes` are about the model itself.
    `motors` are those of the library, and those of the TOML.

    If it is `shared`, the boards of a process move the same model.
    """

    path: Path
    model: Any
    values: Mapping[str, Any]
    shared: bool
    motors: Mapping[str, DcMotorData]
    notes: tuple[str, ...]


def load_model(file: str) -> ModelFile:
    """Load it. Raises UnityLinkError for a file that is not there, or that MuJoCo refuses."""
    path = Path(file)
    data: Mapping[str, Any] = {}
    if path.suffix.lower() == ".toml":
        data = _map(path)
        path = path.parent / data["model"]
    if not path.is_file():  # MuJoCo's own message for this is that of a parser
        raise UnityLinkError(f"plant mujoco:{path}: there is no such file")
    mujoco.set_mju_user_warning(_log.debug)  # else they go to a file in the working folder
    bare = _links_without_inertia(path)
    try:
        model = mujoco.MjModel.from_xml_path(str(path))
    except ValueError as error:
        remedy = f". Links without <inertial>: {', '.join(bare)}; give them mass and inertia" if bare else ""
        raise UnityLinkError(f"plant mujoco:{path}: {error}{remedy}") from error
    # or a model that has become unstable would begin anew, and say nothing
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    notes = [
        f"link {name} of {path.name} has no <inertial>; it has the mass of its shapes in water"
        for name in bare
    ]
    motors = motors_of(data.get("motors", {}), file)
    return ModelFile(path, model, data.get("values", {}), data.get("shared", False), motors, tuple(notes))


def _map(path: Path) -> Mapping[str, Any]:
    """Return what a TOML says. It names its model as seen from its own folder."""
    if not path.is_file():
        raise UnityLinkError(f"plant mujoco:{path}: there is no such file")
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise UnityLinkError(f"plant mujoco:{path}: {error}") from error
    for key in data:
        if key not in _KEYS:
            raise UnityLinkError(
                f"plant mujoco:{path}: there is no key {key!r}; there are {', '.join(_KEYS)}"
            )
    model = data.get("model")
    if not isinstance(model, str) or Path(model).suffix.lower() == ".toml":
        raise UnityLinkError(f'plant mujoco:{path}: it must name the model: model = "robot.xml"')
    if not isinstance(data.get("values", {}), Mapping):
        raise UnityLinkError(f'plant mujoco:{path}: `values` must be a table: [values."shoulder.position"]')
    motors = data.get("motors", {})
    if not isinstance(motors, Mapping) or not all(isinstance(one, Mapping) for one in motors.values()):
        raise UnityLinkError(f'plant mujoco:{path}: `motors` must be tables: [motors."of my own"]')
    if not isinstance(data.get("shared", False), bool):
        raise UnityLinkError(f"plant mujoco:{path}: shared is {data['shared']!r}; it must be true or false")
    return data


def _links_without_inertia(path: Path) -> list[str]:
    """Return the links of a URDF that move, and have no mass. MuJoCo itself names only a number."""
    try:
        root = parse(path).getroot()
    except (ParseError, OSError):
        return []  # MuJoCo says it better
    if root.tag != "robot":
        return []
    children = {child.get("link") for child in root.iterfind("joint/child")}
    bare = {link.get("name") for link in root.iterfind("link") if link.find("inertial") is None}
    return sorted(name for name in children & bare if name)
