# SPDX-License-Identifier: BSD-3-Clause
"""All errors of Unity-Link, as one tree.

    UnityLinkError
    ├── LinkError                  something about a link; knows .item .address .attempts .elapsed_s
    │   ├── LinkTimeout            the device did not answer in time; reads had no effect, writes see below
    │   ├── OutcomeUnknown         a write was sent and its answer lost: it may or may not have happened
    │   ├── LinkClosed             the port is closed, gone, or was unplugged
    │   ├── LinkDown               the line is gone and is being opened again (reconnect=1); nothing was sent
    │   ├── LinkBusy               another program holds the port or the board
    │   ├── LinkNotFound           there is no such port, host or file
    │   ├── BusError               the device answered that its bus refused or did not answer the address
    │   ├── ProtocolError          the device answered something this protocol does not have
    │   ├── UnexpectedValue        the device holds a number that its type in the spec does not have
    │   ├── NetworkError           the network behind the gateware dropped a commit, or
    │   │   ├── NetworkOffline     … is down
    │   │   ├── NetworkHalted      … has halted until its reset
    │   │   └── NodeLost           … lacks a node; knows .nodes
    │   ├── AccessRefused          a server does not let this user do it: unknown token, or a scope is missing
    │   ├── LeaseHeld              another user of a server has the write lease of this part of the robot
    │   ├── DeadManTripped         the device has made its outputs safe; nothing is written before arm()
    │   └── DeviceMismatch         the device cannot do what is asked (widths, groups, publishing)
    ├── ValueRangeError            a value, address or count that cannot be sent; nothing was (ValueError)
    ├── AssignmentError            an attribute or entry of a robot that cannot be replaced (AttributeError)
    ├── UnknownName                a name that a robot, a group or a recording does not have (KeyError)
    ├── UrlError                   a link URL that cannot be understood (ValueError)
    ├── SpecError                  a UL-spec with errors; carries .diagnostics
    ├── FleetError                 a description of a fleet that cannot be used
    ├── ToolError                  a program that compiles gateware is missing or refuses its input
    ├── BoardError                 a board that is not known, or a design that does not go on it
    └── BindingError               a generated file that does not belong to this library, spec or link

The branch tells the cause. A `LinkError` comes from the outside world, the others come from the caller.
"""

from __future__ import annotations

import reprlib
from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from typing_extensions import Self


def shown(value: object) -> str:
    """Return a value as a short text for an error.

    >>> shown([1, 2, "x"]), shown(10**5000)
    ("[1, 2, 'x']", 'a number that is too long to be shown')
    """
    try:
        return reprlib.repr(value)
    except Exception:  # an integer with more digits than Python writes, or an object whose repr fails
        return (
            f"a {'number' if isinstance(value, int) else type(value).__name__} that is too long to be shown"
        )


class UnityLinkError(Exception):
    """Base of every error of this library."""


class LinkError(UnityLinkError):
    """Something about a link failed.

    `item` is the name from the spec, if a layer above knew it. `address` is the word address. `attempts` is
    how often the request was sent. `elapsed_s` is the time from the first attempt to the result.
    """

    def __init__(
        self,
        message: str,
        *,
        item: str | None = None,
        address: int | None = None,
        attempts: int = 0,
        elapsed_s: float = 0.0,
    ) -> None:
        super().__init__(message)
        self.message = message
        self.item = item
        self.address = address
        self.attempts = attempts
        self.elapsed_s = elapsed_s

    def with_item(self, item: str) -> Self:
        """Name the item of this error, unless a lower layer already did. Return self for `raise`.

        >>> str(LinkTimeout("read of 0x0088 unanswered", address=0x88).with_item("j1.cpos"))
        'j1.cpos: read of 0x0088 unanswered'
        """
        if self.item is None:
            self.item = item
        return self

    def __str__(self) -> str:
        return f"{self.item}: {self.message}" if self.item else self.message


class LinkTimeout(LinkError):
    """The device did not answer in time."""


class OutcomeUnknown(LinkError):
    """A request with side effects was sent and its reply was lost: it may or may not have been executed.

    Read the item back, or write a known state, before you go on. The library has repeated nothing.
    """


class LinkClosed(LinkError):
    """The port is closed, gone, or was unplugged."""


class LinkDown(LinkError):
    """The line is gone and is being opened again (`reconnect=1`). Nothing was sent.

    `Link.wait_up` waits for the line. `Link.on_event` tells when it is back.
    """


class LinkBusy(LinkError):
    """Another program holds the port or the board."""


class LinkNotFound(LinkError):
    """There is no such port, host or file."""


class BusError(LinkError):
    """The device answered that its bus refused the address, or that nothing answered at this address."""


class ProtocolError(LinkError):
    """The device's answer is not in the protocol, or it refused a command."""


class UnexpectedValue(LinkError):
    """The device holds a number that is invalid for its type in the spec, such as 3 in an enum of 0 to 2."""


class NetworkError(LinkError):
    """The real-time network behind the gateware is offline or halted, or it dropped a commit.

    The message says which.
    """


class NetworkOffline(NetworkError):
    """The network behind the gateware is down: a fibre is cut, or its nodes look for their ring."""


class NetworkHalted(NetworkError):
    """The network has gone without a commit for too many cycles. It halts until it is reset."""


class NodeLost(NetworkError):
    """Nodes that should be in the network's ring are not. `nodes` has their ids."""

    nodes: tuple[int, ...] = ()


class AccessRefused(LinkError):
    """The server does not know the token, or the token lacks a scope. The message names the scope.

    Nothing was sent to the board.
    """


class LeaseHeld(LinkError):
    """Another user has the write lease of this part of the robot, or its outputs are being made safe.

    The message says who has it and for how long. Nothing was sent to the board.
    """


class DeadManTripped(LinkError):
    """The device has heard nothing for too long. Its outputs are safe, and it writes nothing before
    `arm()`."""


class DeviceMismatch(LinkError):
    """The device cannot do what was requested: widths, group sizes, read-multiple, publishing."""


class ValueRangeError(UnityLinkError, ValueError):
    """A value, address or count cannot be sent. Nothing was sent."""


class AssignmentError(UnityLinkError, AttributeError):
    """An attribute or entry of a robot cannot be replaced. Use the methods of a value to write it."""


class UnknownName(UnityLinkError, KeyError):
    """A robot, a group or a recording does not have this name."""

    def __str__(self) -> str:
        """Return the sentence without the quotes of a KeyError."""
        return str(self.args[0]) if self.args else ""


class UrlError(UnityLinkError, ValueError):
    """A link URL cannot be understood."""


class SpecError(UnityLinkError):
    """A UL-spec has errors. `diagnostics` holds all of them, and `str()` is the report."""

    def __init__(self, report: str, diagnostics: Sequence[object] = ()) -> None:
        super().__init__(report)
        self.diagnostics = tuple(diagnostics)


class FleetError(UnityLinkError):
    """A description of a fleet cannot be used: two robots of one name, a missing spec, an unknown word."""


class ToolError(UnityLinkError):
    """A program that compiles gateware (ghdl, verilator …) is missing, or refused its input."""


class BoardError(UnityLinkError):
    """A board is unknown, its manifest is wrong, or a design does not fit on it (pins, area, clock)."""


class BindingError(UnityLinkError):
    """A generated file does not belong to this version of the library, this spec or this link."""
