# SPDX-License-Identifier: BSD-3-Clause
"""LeRobot's interface for devices as it is published, and stand-ins of its base classes.

Its packages are 5.4 GB, so the tests do without them. The table is of version 0.6.1, from these pages, read
in November 2026: https://huggingface.co/docs/lerobot/integrate_hardware and
https://huggingface.co/docs/lerobot/main/api/robots. `make lerobot` compares it with the classes themselves.
"""

from __future__ import annotations

import abc
import importlib
import inspect
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from types import ModuleType
from typing import Any, ClassVar

import pytest

PROPERTY = "property"
# member -> what it is: a property, or its parameters with their default values
ROBOT: dict[str, str | dict[str, Any]] = {
    "observation_features": PROPERTY,
    "action_features": PROPERTY,
    "is_connected": PROPERTY,
    "is_calibrated": PROPERTY,
    "connect": {"calibrate": True},
    "calibrate": {},
    "configure": {},
    "get_observation": {},
    "send_action": {"action": inspect.Parameter.empty},
    "disconnect": {},
}
TELEOPERATOR: dict[str, str | dict[str, Any]] = {
    "action_features": PROPERTY,
    "feedback_features": PROPERTY,
    "is_connected": PROPERTY,
    "is_calibrated": PROPERTY,
    "connect": {"calibrate": True},
    "calibrate": {},
    "configure": {},
    "get_action": {},
    "send_feedback": {"feedback": inspect.Parameter.empty},
    "disconnect": {},
}
PREFIXES = ("lerobot_robot_", "lerobot_camera_", "lerobot_teleoperator_", "lerobot_policy_", "lerobot_env_")


def shape_of(cls: type[Any], member: str) -> str | dict[str, Any]:
    """Return what a member of a class is, in the form of the tables."""
    found = inspect.getattr_static(cls, member)
    if isinstance(found, property):
        return PROPERTY
    parameters = list(inspect.signature(found).parameters.values())[1:]  # without self
    return {parameter.name: parameter.default for parameter in parameters}


@dataclass(kw_only=True)
class DeviceConfig:
    """The stand-in for a RobotConfig or TeleoperatorConfig: a registry of its subclasses by type."""

    id: str | None = None
    calibration_dir: Path | None = None
    known: ClassVar[dict[str, type[Any]]]

    def __init_subclass__(cls) -> None:
        if DeviceConfig in cls.__bases__:
            cls.known = {}

    @classmethod
    def register_subclass(cls, name: str) -> Callable[[type[Any]], type[Any]]:
        def register(config: type[Any]) -> type[Any]:
            assert name not in cls.known
            cls.known[name] = config
            return config

        return register


def _base(table: dict[str, str | dict[str, Any]]) -> type[Any]:
    """Return an abstract class with the members of a table."""

    def abstract(told: str | dict[str, Any]) -> Any:
        def member(*_: Any) -> Any: ...

        kind = inspect.Parameter.POSITIONAL_OR_KEYWORD
        given = told if isinstance(told, dict) else {}
        parameters = [inspect.Parameter(name, kind, default=value) for name, value in given.items()]
        own = inspect.Parameter("self", kind)
        member.__signature__ = inspect.Signature([own, *parameters])  # type: ignore[attr-defined]
        made = abc.abstractmethod(member)
        return property(made) if told == PROPERTY else made

    def begin(self: Any, config: Any) -> None:
        self.id = config.id

    members = {name: abstract(told) for name, told in table.items()}
    return abc.ABCMeta("Base", (), {"__init__": begin, **members})


@contextmanager
def stand_in(monkeypatch: pytest.MonkeyPatch) -> Iterator[tuple[type[Any], type[Any]]]:
    """Put the stand-ins in the place of LeRobot's modules. Gives the two registries."""

    @dataclass(kw_only=True)
    class RobotConfig(DeviceConfig):
        pass

    @dataclass(kw_only=True)
    class TeleoperatorConfig(DeviceConfig):
        pass

    parts = {
        "lerobot": {},
        "lerobot.robots": {"Robot": _base(ROBOT), "RobotConfig": RobotConfig},
        "lerobot.teleoperators": {
            "Teleoperator": _base(TELEOPERATOR),
            "TeleoperatorConfig": TeleoperatorConfig,
        },
    }
    for name, content in parts.items():
        module = ModuleType(name)
        vars(module).update(content)
        monkeypatch.setitem(sys.modules, name, module)
    yield RobotConfig, TeleoperatorConfig


def plug_ins() -> list[str]:
    """Import every distribution whose name begins as that of a plug-in, under this very name."""
    names = [found.metadata["Name"] for found in metadata.distributions()]
    found = sorted({name for name in names if name and name.startswith(PREFIXES)})
    for name in found:
        importlib.import_module(name)
    return found


def device_of(config: Any) -> Any:
    """Make the device of a configuration: its class has the same name without `Config`."""
    module, name = type(config).__module__, type(config).__name__
    assert name.endswith("Config")
    for place in (module, module.rpartition(".")[0]):
        device = getattr(importlib.import_module(place), name.removesuffix("Config"), None)
        if device is not None:
            return device(config)
    raise AssertionError(f"no device class for {name}")
