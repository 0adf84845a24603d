# SPDX-License-Identifier: BSD-3-Clause
"""Check that the small engine of the gateware can do what a spec asks for (docs/gateware/framed_small.md)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from unitylink import protocol as p

from ..expand.publishing import devices
from ..model import Device, Element, Instance, Link
from ..report.diagnostics import Reporter


@dataclass(frozen=True)
class Lack:
    """What the small engine lacks for `element`. With the `remedy`, the spec would not need it."""

    element: Element
    what: str
    remedy: str


def check_engine(roots: tuple[Instance, ...], links: Mapping[str, Link], reporter: Reporter) -> None:
    """Report what a link with ENGINE=small cannot do. Each reason is reported only once."""
    for device in devices(roots, links):
        if device.link.engine == "small":
            elements = [e for root in roots if root.name == device.root for e in root.walk()]
            own = [element for element in elements if element.link.comm == device.comm]
            told: set[str] = set()
            for lack in lacks_of([device], own):
                if lack.remedy not in told:
                    told.add(lack.remedy)
                    span = lack.element.span
                    start = reporter.sources.offset(span)
                    message = f"{lack.what}, and link `{device.link.name}` has ENGINE=small"
                    hint = f"{lack.remedy}, or write ENGINE=fast"
                    reporter.report("UL105", start, start + span.end - span.start, message, hint)


def lacks_of(
    among: Iterable[Device], elements: Iterable[Element], *, publishing: bool = True
) -> Iterator[Lack]:
    """Yield what the small engine cannot do. Without `publishing`, the publishes of the spec do not count."""
    for device in among if publishing else ():
        yield from _lacks_of_groups(device)
    for element in elements:
        if element.link.kind in ("tosnet", "double_buffer"):
            yield Lack(
                element,
                f"the small engine has no lists, which {element.link.kind.upper()} of `{element.path}` needs",
                "take plain memory",
            )
        elif element.words > 1 and element.readable:
            yield Lack(
                element,
                f"the small engine reads one word at a time, and `{element.path}` has {element.words}",
                "give it a type of one word",
            )


def small_group_size(address_bytes: int, data_bytes: int) -> int:
    """Return the most words of a group of the small engine. Its record has room for the addresses of so many,
    and so has a publish for their words.

    >>> small_group_size(2, 4), small_group_size(1, 4)
    (11, 17)
    """
    carried = (p.SMALL_ENGINE_REPLY_MAX - 7) // data_bytes  # less the head of a publish
    return min(p.SMALL_ENGINE_GROUP_ADDRESS_BYTES // address_bytes, carried)


def _lacks_of_groups(device: Device) -> Iterator[Lack]:
    """Yield what its groups need that the small engine lacks. A group of many words becomes several."""
    link = device.link
    highest = max((address for group in device.groups for address in group.addresses), default=0)
    address_bits = link.address_bits or highest.bit_length() or 1
    most = small_group_size(-(-address_bits // 8), -(-link.data_bits // 8))
    needed = 0
    for group in device.groups:
        element = group.elements[0]
        needed += -(-len(group.addresses) // most)
        if needed > p.SMALL_ENGINE_GROUPS_MAX:
            yield Lack(
                element,
                f"the small engine publishes {p.SMALL_ENGINE_GROUPS_MAX} groups of {most} words, and "
                f"`{element.path}` needs one more",
                "let the PC ask for some values: PUBLISH(2, divisor)",
            )
        if group.divisor >= 1 << 8 * p.SMALL_ENGINE_RATE_BYTES:
            yield Lack(
                element,
                f"the small engine counts to 65535, and the divisor of `{element.path}` is {group.divisor}",
                "choose a lower BASE",
            )
