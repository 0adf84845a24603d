# SPDX-License-Identifier: BSD-3-Clause
"""What Home Assistant wants to know of an item: a message for each, from the spec."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from unitylink.recording.json_messages import steps

if TYPE_CHECKING:
    from unitylink.layer4_data import Value
    from unitylink.spec.model import Spec

PREFIX = "homeassistant"
ON, OFF, PRESS = "ON", "OFF", "PRESS"
COMMANDED = ("WRITE", "READWRITE", "PULSE")  # what commands can do something to
STEP_LEAST, LIMIT = 0.001, 1e15  # what Home Assistant takes
_OTHER = re.compile(r"[^A-Za-z0-9_-]")
_UNITS = {"deg": "°", "degC": "°C", "us": "µs"}  # as Home Assistant writes them
_CLASSES = {  # device classes, and the units that Home Assistant knows for them
    "temperature": ("°C", "K"),
    "voltage": ("V", "mV", "µV", "kV", "MV"),
    "current": ("A", "mA"),
    "power": ("mW", "W", "kW", "MW", "GW"),
    "energy": ("J", "kJ", "MJ", "GJ", "Wh"),
    "frequency": ("Hz", "kHz", "MHz", "GHz"),
    "distance": ("km", "m", "cm", "mm"),
    "speed": ("m/s", "mm/s", "km/h"),
    "pressure": ("Pa", "kPa", "bar"),
    "duration": ("h", "min", "s", "ms", "µs"),
}


@dataclass(frozen=True)
class Topics:
    """The names of the topics of a robot.

    >>> arm = Topics("arm")
    >>> arm.state("leg[2].angle"), arm.status
    ('unitylink/arm/leg/2/angle', 'unitylink/arm/status')
    """

    robot: str

    @property
    def base(self) -> str:
        return f"unitylink/{self.robot}"

    @property
    def status(self) -> str:
        return f"{self.base}/status"

    @property
    def error(self) -> str:
        """Why a command was refused. It is never kept by the broker."""
        return f"{self.base}/error"

    def state(self, path: str) -> str:
        """Return where the value of an item is. `set` below it takes commands."""
        return "/".join((self.base, *steps(path)))

    def command(self, path: str) -> str:
        return f"{self.state(path)}/set"

    @property
    def stop(self) -> str:
        return f"{self.base}/stop"


def discovery(
    spec: Spec,
    robot: str,
    values: Mapping[str, Value[Any]],
    read: Collection[str],
    written: Collection[str],
) -> Iterator[tuple[str, str]]:
    """Yield (topic, JSON) for each item. An empty text takes away what an earlier start may have said.

    `read` has the paths whose values come, and `written` those that commands may write.
    """
    topics = Topics(robot)
    device = {
        "identifiers": [f"unitylink_{robot}"],
        "name": robot,
        "manufacturer": "Unity-Link",
        "model": spec.name,
        "sw_version": spec.hash,
    }
    common = {"availability_topic": topics.status, "device": device}

    def message(kind: str, name: str, facts: dict[str, Any] | None) -> tuple[str, str]:
        own = f"unitylink_{_OTHER.sub('_', robot)}_{_OTHER.sub('_', name)}"
        told = None if facts is None else {"name": name, "unique_id": own, **facts, **common}
        text = "" if told is None else json.dumps(told, separators=(",", ":"), ensure_ascii=False)
        return f"{PREFIX}/{kind}/{own}/config", text

    for path, value in values.items():
        state = {"state_topic": topics.state(path)} if path in read else {}
        if path in written:
            kind, facts = _writes(value)
            yield message(_reads(value)[0], path, None)
            yield message(kind, path, {**facts, **state, "command_topic": topics.command(path)})
        else:
            kind, facts = _reads(value)
            if value.access in COMMANDED:
                yield message(_writes(value)[0], path, None)
            yield message(kind, path, {**facts, **state} if state else None)
    stop = {"command_topic": topics.stop, "payload_press": PRESS, "icon": "mdi:stop-circle"}
    yield message("button", "stop", stop if written else None)


def _reads(value: Value[Any]) -> tuple[str, dict[str, Any]]:
    kind = value.quantity.type
    if kind.kind == "bool":
        return "binary_sensor", {"payload_on": ON, "payload_off": OFF}
    if kind.enum is not None:
        return "sensor", {"device_class": "enum", "options": [one.name for one in kind.enum.values]}
    if kind.kind == "bits":
        return "sensor", {}
    return "sensor", {"state_class": "measurement", **_unit(value)}


def _writes(value: Value[Any]) -> tuple[str, dict[str, Any]]:
    kind = value.quantity.type
    if value.access == "PULSE":
        return "button", {"payload_press": PRESS}
    if kind.kind == "bool":
        return "switch", {"payload_on": ON, "payload_off": OFF}
    if kind.enum is not None:
        return "select", {"options": [one.name for one in kind.enum.values]}
    if kind.kind == "bits":
        return "text", {"max": 255}
    step = 1.0 if value.codec.integer_sign is not None else STEP_LEAST
    if value.quantity.scaled:
        step = max(STEP_LEAST, abs(float(value.quantity.scale)) / (1 << kind.fraction))
    return "number", {"mode": "box", **_limits(value), "step": step, **_unit(value)}


def _limits(value: Value[Any]) -> dict[str, float]:
    least, most = (float(one) for one in (value.minimum, value.maximum))
    return {
        "min": least if math.isfinite(least) else -LIMIT,
        "max": most if math.isfinite(most) else LIMIT,
    }


def _unit(value: Value[Any]) -> dict[str, str]:
    if not value.unit:
        return {}
    unit = _UNITS.get(value.unit, value.unit)
    known = next((name for name, units in _CLASSES.items() if unit in units), None)
    return {"unit_of_measurement": unit, **({"device_class": known} if known else {})}


def payload(value: Any) -> str:
    """Return the state of an item, from its value as `View.plain` gives it.

    >>> payload(True), payload("hold"), payload(12.5), payload({"ready": True})
    ('ON', 'hold', '12.5', '{"ready":true}')
    """
    if isinstance(value, bool):
        return ON if value else OFF
    if isinstance(value, str):
        return value
    return json.dumps(value, separators=(",", ":"))


def command(value: Value[Any], text: str) -> Any:
    """Return the value that a command means. What cannot be read stays a text, which the item refuses."""
    kind = value.quantity.type
    if kind.kind == "bool":
        return {"on": True, "off": False, "true": True, "false": False, "1": True, "0": False}.get(
            text.strip().lower(), text
        )
    if kind.enum is not None:
        return text.strip()
    try:
        number = json.loads(text, parse_constant=float)
    except (ValueError, RecursionError):
        return text
    whole = value.codec.integer_sign is not None and not value.quantity.scaled
    return int(number) if whole and isinstance(number, float) and number.is_integer() else number
