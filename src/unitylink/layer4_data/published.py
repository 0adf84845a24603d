# SPDX-License-Identifier: BSD-3-Clause
"""What publishing needs from a value, and from a group of values. `ReadValue` and `ValueGroup` have it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Protocol

from unitylink.spec.model import Publish
from unitylink.values import Codec

from .listeners import Listeners

if TYPE_CHECKING:
    from unitylink.layer3_hardware import HardwareProxy


class PublishedGroup(Protocol):
    """Listens to several values at once."""

    def take(self, time_s: float, values: Sequence[Any], numbers: Sequence[Any]) -> None: ...


class HasCodec(Protocol):
    """Anything that consists of one or several words."""

    @property
    def codec(self) -> Codec: ...


class PublishedValue(Protocol):
    """A value that publishes bring. `latest` and `raw` are from the last publish."""

    path: str
    hardware: HardwareProxy
    addresses: tuple[int, ...]
    codec: Codec
    checked: bool | None
    pollable: bool
    publish: Publish | None
    line: int | None
    latest: Any
    raw: int | None
    listeners: Listeners[Any]

    @property
    def groups(self) -> Sequence[PublishedGroup]: ...
