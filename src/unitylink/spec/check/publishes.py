# SPDX-License-Identifier: BSD-3-Clause
"""Check that the gateware can publish what a spec asks for."""

from __future__ import annotations

from collections.abc import Mapping

from unitylink import protocol

from ..expand.publishing import devices
from ..isochrony.budget import budget
from ..isochrony.latency import BITS_PER_BYTE, publishes_of
from ..model import Device, Element, Instance, Link, SubscriptionGroup
from ..report.diagnostics import Reporter

# The 2012 gateware never stops publishing a group that is filled to its stated size.
_USABLE_2012 = protocol.GROUP_SIZE_2012 - 1


def check_publishes(roots: tuple[Instance, ...], links: Mapping[str, Link], reporter: Reporter) -> None:
    """Report groups that are too large or too many.

    Also report named groups whose values cannot be of one moment.

    The limits of the 2012 gateware matter only without a declared link. A declared link has gateware of its
    own.
    """
    classic = len(links) == 1
    for device in devices(roots, links):
        _check_names(device, reporter)
        _check_device(device, classic, reporter)
        if device.link.baud_hz and device.groups:
            _check_line(device, reporter)


def _check_device(device: Device, classic: bool, reporter: Reporter) -> None:
    count = 0
    told = False
    for group in device.groups:
        _check_size(group, classic, reporter)
        _check_whole(group, device.link.data_bits, reporter)
        before, count = count, count + -(-len(group.addresses) // _USABLE_2012)
        if classic and before <= protocol.GROUPS_2012 < count and not told:
            told = True
            message = f"with this rate the publishes need more than {protocol.GROUPS_2012} groups"
            hint = f"the 2012 gateware has at most {protocol.GROUPS_2012}: use fewer rates, or mode 2"
            _report(reporter, "UL066", group.elements[0], message, hint)
    if len(device.groups) > protocol.GROUPS_MAX:
        message = f"{len(device.groups)} different rates need more than {protocol.GROUPS_MAX} groups"
        hint = f"the group number is one byte: use at most {protocol.GROUPS_MAX} rates, or mode 2"
        _report(reporter, "UL067", device.groups[protocol.GROUPS_MAX].elements[0], message, hint)


def _check_line(device: Device, reporter: Reporter) -> None:
    one = budget(device, timed=False)
    if one.load is None or one.load <= 1:
        return
    most = max(one.groups, key=lambda group: group.bytes_per_s)
    needed = one.bytes_per_s * BITS_PER_BYTE
    message = f"the publishes of link `{device.link.name}` need {needed:,.0f} baud, it has {one.baud_hz:,}"
    hint = f"{most.words} words at {most.rate_hz:g} Hz need the most: publish slower, or raise BAUD"
    _report(reporter, "UL104", device.groups[most.number].elements[0], message, hint)


def _check_size(group: SubscriptionGroup, classic: bool, reporter: Reporter) -> None:
    words = len(group.addresses)
    if words <= _USABLE_2012 or (words <= protocol.GROUP_SIZE_MAX and not classic):
        return
    what = "elements" if words == len(group.elements) else "words"
    when = f"at divisor {group.divisor}" if group.trigger == "rate" else f"`{group.name}`"
    count = f"{words} {what} publish {when}"
    if words > protocol.GROUP_SIZE_MAX:
        message = f"{count}; a message carries {protocol.GROUP_SIZE_MAX}"
        hint = "all of one rate are one snapshot: use several rates, or mode 2 for some"
        _report(reporter, "UL065", _beyond(group, protocol.GROUP_SIZE_MAX), message, hint)
    else:
        message = f"{count}; a group of the 2012 gateware holds {_USABLE_2012}"
        hint = "there they come as several groups, no longer as one snapshot; use several rates, or mode 2"
        _report(reporter, "UL064", _beyond(group, _USABLE_2012), message, hint)


def _check_whole(group: SubscriptionGroup, data_bits: int, reporter: Reporter) -> None:
    """Report publishes that no frame can carry.

    For one rate, there may be several publishes in the same tick.
    """
    words = len(group.addresses)
    most = publishes_of(words, data_bits, "framed")[0]
    if group.trigger == "rate" or not most < words <= protocol.GROUP_SIZE_MAX:
        return
    message = f"{words} words publish `{group.name}`; a frame carries {most}"
    hint = "the words of one event are not divided: publish fewer, or at a rate"
    _report(reporter, "UL065", _beyond(group, most), message, hint)


def _beyond(group: SubscriptionGroup, words: int) -> Element:
    """Return the element that makes the group too large."""
    for element in group.elements:
        words -= element.words
        if words < 0:
            return element
    return group.elements[-1]


def _check_names(device: Device, reporter: Reporter) -> None:
    first: dict[str, SubscriptionGroup] = {}
    for group in device.groups:
        element = group.elements[0]
        name = element.publish.group if element.publish else ""
        if not name:
            continue
        earlier = first.setdefault(name, group)
        if earlier is not group:
            message = f"snapshot group `{name}` is published in two ways"
            hint = "all of a group are published together: give them one rate or one event"
            other = earlier.elements[0].span
            start = reporter.sources.offset(other)
            labels = [(start, start + other.end - other.start, "the other way is here")]
            _report(reporter, "UL103", element, message, hint, labels=labels)


def _report(
    reporter: Reporter,
    code: str,
    element: Element,
    message: str,
    hint: str,
    *,
    labels: list[tuple[int, int, str]] | None = None,
) -> None:
    start = reporter.sources.offset(element.span)
    end = start + element.span.end - element.span.start
    reporter.report(code, start, end, message, hint, labels=labels or ())
