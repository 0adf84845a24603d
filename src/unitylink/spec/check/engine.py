# SPDX-License-Identifier: BSD-3-Clause
"""Check that the small engine of the gateware can do what a spec asks for (docs/gateware/framed_small.md)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

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
    for group in (group for device in among for group in device.groups if publishing):
        element = group.elements[0]
        yield Lack(
            element,
            f"the small engine does not publish `{element.path}`",
            "let the PC ask for it: PUBLISH(2, divisor)",
        )
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
