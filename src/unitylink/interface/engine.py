# SPDX-License-Identifier: BSD-3-Clause
"""The choice of the engine of the framed protocol: docs/gateware/framed_small.md, docs/generate-vhdl.md."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Any, Final, Protocol

from unitylink import protocol as p
from unitylink.settings import SETTINGS
from unitylink.spec.check.engine import Lack, lacks_of, small_group_size
from unitylink.spec.isochrony import small
from unitylink.spec.isochrony.latency import BITS_PER_BYTE
from unitylink.spec.model import LINES, Instance, Spec

SMALL: Final = MappingProxyType(
    {
        "protocol": "framed",
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

GROUPS: Final = MappingProxyType(
    {"groups": p.SMALL_ENGINE_GROUPS_MAX, "rate_bytes": p.SMALL_ENGINE_RATE_BYTES}
)
"""With publishing: the most groups, and the bytes of a divisor. small_group_size has the words of a group."""


MOST_LOAD: Final = 0.8
"""The share of the time that publishes may take."""


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
    @property
    def publish_mode(self) -> int: ...


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
    if configuration.publish_mode:
        size = small_group_size(configuration.address_bytes, configuration.data_bytes)
        for name, has in {**GROUPS, "group_size": size}.items():
            if getattr(configuration, name) > has:
                value = getattr(configuration, name)
                return f"{name} is {value}; the small engine has at most {has}: choose that, or engine 'fast'"
    return ""


def groups_for(spec: Spec, configuration: Any, given: Mapping[str, Any]) -> dict[str, Any]:
    """Return the settings of publishing for a design with the small engine.

    It publishes if the spec does. The groups are as large as they can be.
    """
    mode = given.get("publish_mode", 2 if any(device.groups for device in spec.devices) else 0)
    if not mode:
        return {"publish_mode": 0}
    size = small_group_size(configuration.address_bytes, configuration.data_bytes)
    return {"publish_mode": mode, "group_size": size, "rate_bytes": p.SMALL_ENGINE_RATE_BYTES}


def byte_clocks_min(publish_mode: int) -> int:
    """Return the fewest clocks that a byte may take on the line of a design with the small engine."""
    return p.SMALL_ENGINE_PUBLISH_BYTE_CLOCKS_MIN if publish_mode else p.SMALL_ENGINE_BYTE_CLOCKS_MIN


def too_often(spec: Spec, configuration: Any) -> str:
    """If a small engine cannot keep the rates of the spec's publishes, return this with the remedy, else "".

    It prepares a publish, and then sends it. Both together must end before the next ones are due. Without a
    baud rate the line takes no time.
    """
    publishes = [group for device in spec.devices for group in device.groups if group.divisor]
    if not configuration.publish_mode or not publishes:
        return ""
    period = configuration.clock_hz // configuration.base_hz
    least = p.SMALL_ENGINE_PUBLISH_PERIOD_MIN
    if period < least:
        return (
            f"a base strobe comes every {period} clocks, and the small engine needs {least}: choose a lower "
            "BASE, or engine 'fast'"
        )
    scan = p.SMALL_LATENCY_SCAN * p.SMALL_ENGINE_GROUPS_MAX
    load = scan / period
    size = small_group_size(configuration.address_bytes, configuration.data_bytes)
    for group in publishes:
        whole, rest = divmod(len(group.addresses), size)
        for words in [size] * whole + [rest] * (rest > 0):
            one = small.publish_of(words, configuration.address_bytes, configuration.data_bytes)
            clocks = one.clocks + one.characters * max(2, configuration.byte_clocks)
            load += clocks / (group.divisor * period)
    if load > MOST_LOAD:
        return (
            f"its publishes take {load:.0%} of the time of the small engine and its line, and at most "
            f"{MOST_LOAD:.0%} leave room for requests: choose lower rates, a faster line, or engine 'fast'"
        )
    return ""


def too_fast(configuration: Chosen) -> str:
    """If the line brings posts faster than the small engine executes them, return this with the remedy, else
    "".
    """
    clocks, least = configuration.byte_clocks, byte_clocks_min(configuration.publish_mode)
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
    few = all(given.get(name, 0) <= most for name, most in {"window": SMALL["window"], **GROUPS}.items())
    line = plain.protocol == "framed" and plain.physical in LINES
    least = byte_clocks_min(given.get("publish_mode", any(device.groups for device in spec.devices)))
    baud_hz = plain.baud_hz or max((device.link.baud_hz or 0 for device in spec.devices), default=0)
    slow = baud_hz * least <= plain.clock_hz * BITS_PER_BYTE
    able = not _at_once(spec) and not any(lacks(spec, given)) and not too_often(spec, plain)
    return asked and few and line and slow and able


def _at_once(spec: Spec) -> bool:
    """Tell whether the spec has parts whose words a program reads together."""
    elements = [element for _, element in spec.walk()]
    polled = sum(element.publish is not None and element.publish.mode == 2 for element in elements)
    return polled > 1 or any(e.link.kind == "fifo" for e in elements) or any(map(_has_groups, spec.roots))


def _has_groups(part: Instance) -> bool:
    return bool(part.groups) or any(map(_has_groups, part.instances))
