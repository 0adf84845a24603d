# SPDX-License-Identifier: BSD-3-Clause
"""The choice of the engine of the framed protocol: docs/gateware/framed_small.md, docs/generate-vhdl.md."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Any, Final, Protocol

from unitylink import protocol as p
from unitylink.settings import SETTINGS
from unitylink.spec.check.engine import Lack, lacks_of
from unitylink.spec.isochrony.latency import BITS_PER_BYTE
from unitylink.spec.model import LINES, Instance, Spec

SMALL: Final = MappingProxyType(
    {
        "protocol": "framed",
        "publish_mode": 0,
        "lists": False,
        "exchanges": 0,
        "window": p.SMALL_ENGINE_WINDOW_MAX,
        "request_max": p.SMALL_ENGINE_REQUEST_MAX,
        "reply_max": p.SMALL_ENGINE_REPLY_MAX,
        "credit": p.SMALL_ENGINE_CREDIT,
        "cache_bytes": p.SMALL_ENGINE_CACHE_BYTES,
    }
)
"""The settings of a design with the small engine. `window` may be smaller."""


class Chosen(Protocol):
    """The settings on which the choice depends. A BoardConfiguration has them."""

    @property
    def protocol(self) -> str: ...
    @property
    def physical(self) -> str: ...
    @property
    def engine(self) -> str: ...
    @property
    def clock_hz(self) -> int: ...
    @property
    def baud_hz(self) -> int: ...
    @property
    def byte_clocks(self) -> int: ...


def sizes_of(engine: str) -> Mapping[str, Any]:
    """Return the settings that are fixed in gateware. Only a virtual board may have other values."""
    fixed = {one.name: one.default for one in SETTINGS.values() if one.needed_by == ("twin",)}
    return fixed if engine == "fast" else {**fixed, **{name: SMALL[name] for name in fixed if name in SMALL}}


def beyond_small(configuration: Any) -> str:
    """Return which setting the small engine does not have, with the remedy, or ""."""
    for name, has in SMALL.items():
        value = getattr(configuration, name)
        if value != has and not (name == "window" and value < has):
            most = "at most " if name == "window" else ""
            return f"{name} is {value!r}; the small engine has {most}{has!r}: choose that, or engine 'fast'"
    return ""


def too_fast(configuration: Chosen) -> str:
    """If the line brings posts faster than the small engine executes them, return this with the remedy, else
    "".
    """
    clocks, least = configuration.byte_clocks, p.SMALL_ENGINE_BYTE_CLOCKS_MIN
    if configuration.engine == "small" and 0 < clocks < least:
        return (
            f"a byte takes {clocks} clocks on the line, and the small engine needs {least}: choose a lower "
            "baud rate, a faster clock, or engine 'fast'"
        )
    return ""


def lacks(spec: Spec, given: Mapping[str, Any]) -> Iterator[Lack]:
    """Yield what the spec needs and the small engine cannot do.

    The `given` settings may turn its publishes off.
    """
    elements = (element for _, element in spec.walk())
    return lacks_of(spec.devices, elements, publishing=given.get("publish_mode") != 0)


def small_will_do(spec: Spec, plain: Chosen, given: Mapping[str, Any]) -> bool:
    """Tell whether the small engine can do all that `spec` and the `given` settings need.

    `plain` is the design before the choice. Its line must be slow by itself, because an SPI master or an FTDI
    chip may be fast. A design that also speaks classic text has the fast engine. So has one whose host reads
    bursts or snapshots: a FIFO, a group, several polled values.
    """
    asked = all(given.get(name, value) == value for name, value in SMALL.items() if name != "window")
    few = given.get("window", 0) <= SMALL["window"]
    line = plain.protocol == "framed" and plain.physical in LINES
    baud_hz = plain.baud_hz or max((device.link.baud_hz or 0 for device in spec.devices), default=0)
    slow = baud_hz * p.SMALL_ENGINE_BYTE_CLOCKS_MIN <= plain.clock_hz * BITS_PER_BYTE
    return asked and few and line and slow and not _at_once(spec) and not any(lacks(spec, given))


def _at_once(spec: Spec) -> bool:
    """Tell whether the spec has parts whose words a program reads together."""
    elements = [element for _, element in spec.walk()]
    polled = sum(element.publish is not None and element.publish.mode == 2 for element in elements)
    return polled > 1 or any(e.link.kind == "fifo" for e in elements) or any(map(_has_groups, spec.roots))


def _has_groups(part: Instance) -> bool:
    return bool(part.groups) or any(map(_has_groups, part.instances))
