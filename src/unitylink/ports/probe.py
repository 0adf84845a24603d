# SPDX-License-Identifier: BSD-3-Clause
"""Ask what is at the other end of a port. Any answer is possible.

The only request is RLC, which changes nothing. The fence stands before it. It makes the device drop a
half-received message.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from unitylink import protocol
from unitylink.layer1_stream import (
    ApplicationError,
    Busy,
    ClassicDecoder,
    ClassicEncoder,
    DatalinkError,
    Publish,
    Reply,
)

WAIT_S = 0.5  # wait for an answer; a board needs a few ms
SILENT_MOST = 3  # questions in a row; if none of so many is answered, the device is gone


class PortDriver(Protocol):
    """What a probe needs from layer 0."""

    def send(self, data: bytes, *, timeout_s: float = ...) -> None: ...

    def receive(self, *, timeout_s: float = ...) -> bytes: ...


@dataclass(frozen=True)
class Answer:
    """The answer of the device.

    `kind` is one of these: "configuration" (`fields` is the text of the CNF), "refused" (`detail` is the
    E_xxx), "checksum", "line-errors" (`detail` names them), "busy", "echo", "garbage" or "silence".
    `elapsed_s` is the time until the answer.
    """

    kind: str
    received: bytes
    detail: str = ""
    fields: str = ""
    elapsed_s: float = 0.0


def request(*, checked: bool = True, polynomial: int | None = protocol.CRC8_POLYNOMIAL) -> bytes:
    """Return the request RLC, with a fence before it.

    >>> request()
    b'!$RLC*9B\\n'
    """
    encoder = ClassicEncoder(checked=checked, polynomial=polynomial)
    return b"!" + encoder.encode(protocol.COMMAND_READ_CONFIGURATION)


def probe(
    driver: PortDriver,
    *,
    checked: bool = True,
    polynomial: int | None = protocol.CRC8_POLYNOMIAL,
    wait_s: float = WAIT_S,
    clock: Callable[[], float] = time.monotonic,
) -> Answer:
    """Ask for the configuration and return the answer. Publishes of the board are ignored."""
    sent = request(checked=checked, polynomial=polynomial)
    return ask(driver, sent, checked=checked, polynomial=polynomial, wait_s=wait_s, clock=clock)


def ask(
    driver: PortDriver,
    sent: bytes,
    *,
    checked: bool,
    polynomial: int | None,
    wait_s: float,
    clock: Callable[[], float] = time.monotonic,
) -> Answer:
    """Send `sent`, which asks for the configuration, and return the answer."""
    before = ClassicDecoder(data_bytes=0, polynomial=polynomial)
    until_s = clock() + wait_s  # a port that is flooded is never empty
    # These bytes are still under way. A busy board may say so and then hang up.
    while clock() < until_s and (chunk := driver.receive(timeout_s=0.0)):
        if any(isinstance(event, Busy) for event in before.feed(chunk)):
            return Answer("busy", chunk)
    driver.send(sent)
    start_s = clock()
    received = b""
    decoder = ClassicDecoder(data_bytes=0, polynomial=polynomial)
    complaint: Answer | None = None
    while (left_s := start_s + wait_s - clock()) > 0:
        chunk = driver.receive(timeout_s=left_s)
        received += chunk
        for event in decoder.feed(chunk):
            elapsed_s = clock() - start_s
            if isinstance(event, Reply) and event.letters == protocol.REPLY_READ_CONFIGURATION:
                return Answer("configuration", received, fields=event.fields, elapsed_s=elapsed_s)
            if isinstance(event, Busy):
                return Answer("busy", received, elapsed_s=elapsed_s)
            if isinstance(event, ApplicationError):
                complaint = Answer("refused", received, event.error, elapsed_s=elapsed_s)
            elif isinstance(event, DatalinkError):
                complaint = _complaint(event, received, elapsed_s)
        if complaint is not None and not received.endswith(b"f3\n"):  # the fence may itself cause an f3
            return complaint
    if complaint is not None:
        return complaint
    if sent.strip() in received:
        return Answer("echo", received, elapsed_s=wait_s)
    said = ClassicDecoder(data_bytes=0, polynomial=polynomial).feed(received)
    if not received or (said and all(isinstance(event, Publish) for event in said)):
        return Answer("silence", received, elapsed_s=wait_s)
    return Answer("garbage", received, elapsed_s=wait_s)


def _complaint(event: DatalinkError, received: bytes, elapsed_s: float) -> Answer:
    if event.code >= protocol.DATALINK_ERROR_PHYSICAL:
        flags = event.code - protocol.DATALINK_ERROR_PHYSICAL
        names = [name for bit, name in enumerate(("parity", "framing", "overrun")) if flags >> bit & 1]
        return Answer("line-errors", received, " and ".join(names), elapsed_s=elapsed_s)
    if event.code == protocol.DATALINK_ERROR_CHECKSUM:
        return Answer("checksum", received, elapsed_s=elapsed_s)
    return Answer("refused", received, f"?{event.code:x}", elapsed_s=elapsed_s)


def find_polynomial(
    driver: PortDriver, *, wait_s: float = WAIT_S, clock: Callable[[], float] = time.monotonic
) -> int | None:
    """Return the CRC polynomial of the device, 0 for the byte XOR, or None if none of the 256 works.

    The 256 possible checksums of RLC are tried. The checksum of the answer shows which polynomial was right.
    It ends early if the device stops answering, or if all its answers are unreadable.
    """
    lost = 0
    for sum_ in range(256):
        line = b"!$RLC*%02X\n" % sum_
        assumed = protocol.CRC8_POLYNOMIAL
        answer = ask(driver, line, checked=False, polynomial=assumed, wait_s=wait_s, clock=clock)
        if answer.kind == "checksum":
            lost = 0
            continue
        for polynomial in (None, *range(1, 256)):
            if request(polynomial=polynomial) != b"!$RLC*%02X\n" % sum_:
                continue
            events = ClassicDecoder(data_bytes=0, polynomial=polynomial).feed(answer.received)
            if any(isinstance(e, Reply) and e.letters == protocol.REPLY_READ_CONFIGURATION for e in events):
                return polynomial or 0
        lost += 1
        if lost == SILENT_MOST:
            return None
    return None
