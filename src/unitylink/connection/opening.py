# SPDX-License-Identifier: BSD-3-Clause
"""connect(url) opens a Link to whatever a URL names. open_driver(url) opens only its bytes."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Literal

from unitylink.connection.schemes import Device, scheme_of
from unitylink.errors import UrlError
from unitylink.layer0_driver import Driver
from unitylink.layer2_message import Link, check_url

if TYPE_CHECKING:
    from unitylink.simulate import BoardState

_RECONNECT = re.compile(r"[?&]reconnect=")
_TIME = re.compile(r"[?&]time=")


def connect(
    url: str,
    *,
    reconnect: bool | Literal["auto"] | None = None,
    time: Literal["real", "lockstep"] | None = None,
    state: BoardState | None = None,
) -> Link:
    """Return an open Link to the device that `url` names.

        connect("serial:/dev/ttyUSB0?baud=3000000")
        connect("tcp://192.168.1.10:5555?crc=1&fifo=1024")
        connect("ftdi:FT1234?channel=B&baud=3000000")          # an FTDI chip, past the kernel's driver
        connect("spi:/dev/spidev0.0?speed_hz=10000000")        # an SPI port of the kernel's
        connect("rs485:/dev/ttyUSB0?node=3&baud=3000000")      # one of many nodes on a pair
        connect("mmap:/dev/uio0?size=4096")                    # registers that are memory here
        connect("sim:examples/scara/scara.ul?plant=scara")     # a virtual board in this process
        connect("rtl:examples/scara/scara.ul?plant=scara")     # the same, but the VHDL itself, compiled
        connect("zenoh:lab/arm1")                              # a robot on a Zenoh network (docs/zenoh.md)

    The link speaks the framed protocol if the device knows it. If the device answers eight classic questions
    and no HELLO, it falls back to the classic protocol (`link.protocol`, and `link.notice`, which is logged).
    Then a PULSE or a value with SAFE raises DeviceMismatch, unless the URL has `protocol=classic`.

    Options: `protocol=auto|classic|framed`; `deadman=SECONDS` (of silence until the device makes its outputs
    safe); `spec_hash=HEX` (raises DeviceMismatch if the gateware has another wire hash), or `spec_hash=any`
    (objects are made even if the gateware was built from another spec, which is logged).

    With `reconnect=1` in the URL, or `reconnect=True`, a lost or silent line is opened again, and
    subscriptions go on (`Link.on_event`, `Link.wait_up`). Meanwhile, requests raise LinkDown at once. With
    `wait=SECONDS` reads wait that long instead. This is not for `fd:` and `mmap:`. `reconnect="auto"` does
    the same, if the URL says nothing else and names hardware that allows it.

    With `time="lockstep"`, or `time=lockstep` in the URL, the time of a virtual board goes in steps. It
    passes only while a call waits, as `Link.step` does (docs/lockstep.md).

    `state=link.board.save()` makes a virtual board that goes on from the state of another one
    (docs/lockstep.md).

    `mmap:` has no protocol, and options of its own: `offset= size= address_bytes= base_hz=`. All others have
    `timeout=0.1` (s per attempt), `attempts=3`, `fifo=16` or `fifo=RX,TX` (bytes of the device's buffers),
    `crc=0|1`, `publish_crc=1`, `polynomial=0x07` (or `xor`, or `none` for gateware without checksums, which
    never gets a `$`), `window=64`, `gateware=auto|2012|corrected`, `trace=FILE` (a capture of all bytes, for
    `unitylink decode` and Wireshark). For gateware without RLC, there are also
    `address_bytes= data_bytes= read_many= publish_mode= base_hz= groups= group_size= rate_bytes=`.

    Raises UrlError, LinkNotFound, LinkBusy, LinkTimeout (nothing answers), DeviceMismatch.
    """
    scheme = scheme_of(url)
    if reconnect == "auto":
        reconnect = True if scheme.lasting and not _RECONNECT.search(url) else None
    if reconnect is not None:
        url = _with(url, "reconnect", str(int(reconnect)), _RECONNECT)
    if time is not None:
        if not scheme.virtual:
            raise UrlError(
                f"link URL {url!r}: time={time} is for virtual boards; the time of hardware passes"
            )
        url = _with(url, "time", time, _TIME)
    if state is not None and not scheme.virtual:
        raise UrlError(f"link URL {url!r}: a state is for virtual boards; hardware has its own")
    if scheme.open is not None:
        return scheme.open(url)
    if scheme.make is None:
        return Link(url)
    device, driver_url = scheme.make(url) if state is None else _restored(url, state)
    try:
        link = Link(driver_url)
    except UrlError as error:
        device.close()
        raise UrlError(str(error).replace(driver_url, url)) from None
    except BaseException:
        device.close()
        raise
    link.url = url
    link.board = device if scheme.virtual else None
    link.call_on_close(device.close)
    if state is not None:
        link.board.go_on()
    return link


def _restored(url: str, state: BoardState) -> tuple[Device, str]:
    from unitylink.simulate import simulated_board

    return simulated_board(url, state)


def check_link(url: str) -> None:
    """Check a link URL, and the spec that a virtual board names. Nothing is opened.

    Raises UrlError, with what is known instead of what is wrong, or SpecError.
    """
    if scheme_of(url).virtual:
        from unitylink.simulate.simulated import check_simulated

        check_simulated(url)
    elif (check := scheme_of(url).check) is not None:
        check(url)
    else:
        check_url(url)


def _with(url: str, option: str, value: str, present: re.Pattern[str]) -> str:
    if present.search(url):
        raise UrlError(f"link URL {url!r}: {option} is given in the URL and as an argument; give it once")
    return f"{url}{'&' if '?' in url else '?'}{option}={value}"


@contextmanager
def open_driver(url: str) -> Iterator[Driver]:
    """Open the bytes of what `url` names, for callers with their own protocol. The `with` closes it.

    Raises UrlError, LinkNotFound, LinkBusy, LinkTimeout.
    """
    scheme = scheme_of(url)
    if not scheme.stream:
        raise UrlError(f"link URL {url!r}: {scheme.what} has no bytes, only registers")
    device, driver_url = (None, url) if scheme.make is None else scheme.make(url)
    try:
        with Driver(driver_url) as driver:
            yield driver
    finally:
        if device is not None:
            device.close()
