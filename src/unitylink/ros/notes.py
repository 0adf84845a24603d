# SPDX-License-Identifier: BSD-3-Clause
"""The annotations `@ros(..)` before a constructor, an instance or an element."""

from __future__ import annotations

from unitylink.errors import BindingError
from unitylink.spec.annotation import Annotation, AnnotationValue
from unitylink.spec.model import Element, Instance

# option -> its type; without this table, a misspelt option would silently have no effect
TWIST_AXES = ("linear_x", "linear_y", "linear_z", "angular_x", "angular_y", "angular_z")
JOINT_PARTS = ("position", "velocity", "effort", "position_sp", "velocity_sp", "effort_sp")
_INSTANCE = {
    "name": str,
    "type": str,
    "frame": str,
    "queue": int,
    "reliable": bool,
    "joint": str,
    **dict.fromkeys((*JOINT_PARTS, *TWIST_AXES, "left", "right"), str),
    **dict.fromkeys(("radius_m", "track_m"), float),
}
_ELEMENT = {"name": str, "type": str, "frame": str, "queue": int, "reliable": bool}
_INSTANCE_TYPES = ("JointState", "Twist", "Imu", "BatteryState", "Odometry")


class Note:
    """The `@ros(..)` of one declaration, after the checks.

    Raises BindingError, which names the place and the choices.
    """

    def __init__(self, item: Element | Instance) -> None:
        self.where = f"{item.span.file}:{item.span.line}: `{item.path or item.name}`"
        self._options: dict[str, AnnotationValue] = {}
        known = _ELEMENT if isinstance(item, Element) else _INSTANCE
        for annotation in item.annotations:
            if annotation.name == "ros":
                self._take(annotation, known)
        kind = self.text("type")
        if isinstance(item, Instance) and kind and kind not in _INSTANCE_TYPES:
            raise self.wrong(f"type {kind!r} is none of {', '.join(_INSTANCE_TYPES)}")
        if self.number("queue", 1) < 1:
            raise self.wrong("queue must be 1 or more messages")

    def _take(self, annotation: Annotation, known: dict[str, type]) -> None:
        if annotation.values:
            raise self.wrong(f"{annotation.values[0]!r} has no key; write key=value, such as type=..")
        for key, given in annotation.options:
            if key not in known:
                raise self.wrong(f"there is no option {key!r}; there are {', '.join(known)}")
            # the language writes true and false as 1 and 0
            value = bool(given) if known[key] is bool and given in (0, 1) else given
            value = float(value) if known[key] is float and isinstance(value, int) else value
            if not isinstance(value, known[key]):
                raise self.wrong(f"{key}={value!r} is not of type {known[key].__name__}")
            if isinstance(value, str) and not value.isprintable():
                raise self.wrong(f"{key}={value!r} has characters that cannot be printed")
            self._options[key] = value

    def wrong(self, what: str) -> BindingError:
        return BindingError(f"{self.where}: @ros(..): {what}")

    def text(self, key: str, default: str = "") -> str:
        return str(self._options.get(key, default))

    def number(self, key: str, default: int) -> int:
        return int(self._options.get(key, default))

    def real(self, key: str) -> float:
        return float(self._options.get(key, 0.0))

    def flag(self, key: str, default: bool) -> bool:
        return bool(self._options.get(key, default))
