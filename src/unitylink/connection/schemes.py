# SPDX-License-Identifier: BSD-3-Clause
"""The schemes of link URLs. `connect`, the command line and their help texts read this one table.

Its first rows are those of the native core (`native/src/layer0_driver/schemes.cpp`). A scheme that is made in
Python has its row here. Its function makes what the URL names, and returns the driver URL that reaches it.
CONTRIBUTING.md has the steps.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from unitylink import _native
from unitylink.errors import UrlError

if TYPE_CHECKING:
    from unitylink.layer2_message import Link


class Device(Protocol):
    """The device that a scheme makes. It is closed after the link."""

    def close(self) -> None: ...


@dataclass(frozen=True)
class Scheme:
    """One way to a device. `form` is an example of its URLs. `what` says in a few words where it leads.

    `make` returns what the URL names, and the URL under which the native core reaches that. With None, the
    core opens the URL itself. `virtual` means that the URL names a spec, and that there is no port and no
    hardware. `stream` means that the device takes a stream of bytes. Otherwise layer 2 reaches the registers
    itself, without a protocol. `once` means that it cannot be opened a second time. `open` returns the whole
    link, for a scheme that the native core has no part in. Such a link comes back by itself.
    """

    name: str
    form: str
    what: str
    make: Callable[[str], tuple[Device, str]] | None = None
    virtual: bool = False
    stream: bool = True
    once: bool = False
    open: Callable[[str], Link] | None = None
    check: Callable[[str], object] | None = None

    @property
    def lasting(self) -> bool:
        """Whether `reconnect="auto"` opens a lost line again.

        It does not for a virtual board, which is never unplugged.
        """
        return self.stream and not self.once and not self.virtual and self.open is None


def _simulated(url: str) -> tuple[Device, str]:
    from unitylink.simulate import simulated_board  # imported here, because it loads the twin and the plants

    return simulated_board(url)


def _far(url: str) -> Link:
    from unitylink.zenoh.link import ZenohLink  # imported here, because few programs need it

    return ZenohLink(url)


def _check_far(url: str) -> object:
    from unitylink.zenoh.far_options import read_far_url

    return read_far_url(url)


SCHEMES = {
    scheme.name: scheme
    for scheme in (
        *(Scheme(*row[:3], stream=row[3], once=row[4]) for row in _native.schemes()),
        Scheme("sim", "sim:SPEC.ul", "a virtual board inside this program: the twin", _simulated, True),
        Scheme("rtl", "rtl:SPEC.ul", "the same, but the VHDL itself, compiled", _simulated, True),
        Scheme("bit", "bit:SPEC.ul?board=NAME", "the same, but the bitstream for a board", _simulated, True),
        Scheme(
            "zenoh",
            "zenoh:lab/arm1",
            "a robot on a Zenoh network, behind `unitylink bridge zenoh`",
            stream=False,
            open=_far,
            check=_check_far,
        ),
    )
}


def scheme_of(url: str) -> Scheme:
    """Return the scheme of a link URL. Raises UrlError, which lists all forms, if it has no known scheme.

    >>> scheme_of("tcp://192.168.1.10:5555?crc=1").what
    'a board on the network, or `unitylink simulate`'
    """
    name, colon, _ = url.partition(":")
    try:
        whole = b"\0" not in url.encode()
    except UnicodeEncodeError:  # a word of the command line is not UTF-8
        whole = False
    if not whole:
        raise UrlError(f"link URL {url!r}: it is not UTF-8, or contains a NUL")
    if colon and name in SCHEMES:
        return SCHEMES[name]
    wrong = f"no scheme {name!r}" if colon else "it does not begin with a scheme and a colon"
    raise UrlError(f"link URL {url!r}: {wrong}; a link looks like {forms()}")


def forms() -> str:
    """Return an example of each scheme's URLs, for a sentence."""
    *most, last = (scheme.form for scheme in SCHEMES.values())
    return f"{', '.join(most)} or {last}"
