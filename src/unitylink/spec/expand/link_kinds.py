# SPDX-License-Identifier: BSD-3-Clause
"""From the TOSNET, MEMORY, DOUBLE_BUFFER or FIFO of a spec to the hardware proxy of an instance."""

from __future__ import annotations

from collections.abc import Mapping

from unitylink.protocol import TOSNET_MEMORY_WORDS

from ..meaning.evaluate import Evaluator, RunTime, Value
from ..meaning.scope import ADDRESS_MAX, Scope
from ..model import TOSNET_NODES, LinkBinding, RingOptions
from ..text.syntax import Number, Property
from ..units import UNITS

_DEPTH_DEFAULT = 16  # words of a FIFO without a DEPTH
_SIZE_MAX = 1 << 20  # the most words of a double buffer
_DEPTH_MAX = 1 << 16
_NODE_MAX = 15  # four bits of an address, and of a packet
_RINGS_MAX = 2
_CHECK_BYTES_MAX = 2  # of a packet's check
_RATES = {  # property of TOSNET -> the least and the most, in Hz
    "BAUD": (100_000, 1_000_000_000),
    "CYCLE_RATE": (1, 1_000_000),
}


def bind_link(
    scope: Scope, outer: LinkBinding, names: Mapping[str, Value], evaluator: Evaluator
) -> LinkBinding:
    """Return the proxy of an instance. Missing properties come from `outer`, except BASE, which is then 0."""
    node = scope.link_kind
    assert node is not None  # the caller has checked it
    objects: dict[str, str | None] = {"CTRL": outer.ctrl, "COMM": outer.comm}
    for key in objects:
        one = scope.link_property(key)
        if one is not None and one.name is not None:
            value = names.get(one.name.text)
            objects[key] = value.name if isinstance(value, RunTime) else None
    base = _number(scope.link_property("BASE"), (0, ADDRESS_MAX), 0, names, evaluator)
    chosen = scope.link_property("LINK")
    link = chosen.name.text if chosen is not None and chosen.name is not None else outer.link
    kind = node.kind.lower()
    size = 0
    if kind == "double_buffer":
        if scope.link_property("SIZE") is None:
            message, hint = (
                "a double buffer needs its SIZE in words",
                "write `DOUBLE_BUFFER(BASE=…, SIZE=16)`",
            )
            evaluator.reporter.report("UL058", node.start, node.end, message, hint)
        size = _number(scope.link_property("SIZE"), (1, _SIZE_MAX), 1, names, evaluator)
    elif kind == "fifo":
        depth = scope.link_property("DEPTH")
        size = _number(depth, (2, _DEPTH_MAX), _DEPTH_DEFAULT, names, evaluator)
        if depth is not None and depth.argument is not None and size & size - 1:
            place = depth.argument.start, depth.argument.end
            message = f"a queue of {size} words: the gateware's hold a power of two"
            hint = f"write {1 << size.bit_length()}, or {1 << size.bit_length() - 1}"
            evaluator.reporter.report("UL058", *place, message, hint)
    ring = RingOptions()
    if kind == "tosnet":
        node_id = scope.link_property("NODE")
        time = _number(scope.link_property("TIME"), (0, TOSNET_MEMORY_WORDS - 1), -1, names, evaluator)
        ring = RingOptions(
            None if node_id is None else _number(node_id, (0, _NODE_MAX), 0, names, evaluator),
            _rate(scope.link_property("BAUD"), names, evaluator),
            _rate(scope.link_property("CYCLE_RATE"), names, evaluator),
            _nodes(scope.link_property("NODES"), evaluator),
            _number(scope.link_property("RINGS"), (1, _RINGS_MAX), 1, names, evaluator),
            _number(scope.link_property("CHECK_BYTES"), (1, _CHECK_BYTES_MAX), 1, names, evaluator),
            time if time >= 0 else None,
        )
    return LinkBinding(kind, base, objects["CTRL"], objects["COMM"], size, link, ring)


def _number(
    given: Property | None,
    limits: tuple[int, int],
    default: int,
    names: Mapping[str, Value],
    evaluator: Evaluator,
) -> int:
    if given is None or given.argument is None:
        return default
    part = given.argument.parts[0]
    if isinstance(part, Number) and part.value > ADDRESS_MAX:
        return default  # already reported with the constructor
    value = evaluator.integer(given.argument, names, given.key, *limits)
    return default if value is None else value


def _nodes(given: Property | None, evaluator: Evaluator) -> str:
    if given is None or given.name is None or given.name.text in TOSNET_NODES:
        return TOSNET_NODES[0] if given is None or given.name is None else given.name.text
    place = given.name.start, given.name.end
    message = f"NODES is {given.name.text}"
    hint = "write `NODES=ring` for nodes behind a line, or `NODES=inside` for logic in this FPGA"
    evaluator.reporter.report("UL108", *place, message, hint)
    return TOSNET_NODES[0]


def _rate(given: Property | None, names: Mapping[str, Value], evaluator: Evaluator) -> int | None:
    if given is None or given.argument is None:
        return None
    place = given.argument.start, given.argument.end
    value = evaluator.quantity(given.argument, names, given.key, UNITS["Hz"])
    if value is None:
        return None
    least, most = _RATES[given.key]
    if isinstance(value, int) and least <= value <= most:
        return value
    message = f"{given.key} is {float(value):g} Hz"
    evaluator.reporter.report(
        "UL049", *place, message, f"it is a whole number of Hz from {least:,} to {most:,}"
    )
    return None
