# SPDX-License-Identifier: BSD-3-Clause
"""Compare a call through a link with a bare C++ round trip through a pty. The two take turns."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from unitylink.capture.pcapng import SENT, read_packets

from .awake import processors_awake
from .figure import BenchError, Run
from .programs import Process, native, twin
from .timing import Comparison, in_turns, times

if TYPE_CHECKING:
    from unitylink.layer2_message import Link

# takes a link; returns the call, and the bytes for the bare program to send
Side = Callable[["Link"], tuple[Callable[[], object], list[str]]]
FramedSide = Callable[["Link"], Callable[[], object]]


def against_bare(run: Run, url: str, protocol: str, side: Side) -> Comparison:
    """Measure `side` on a link of `protocol` to the pty at `url`.

    The bare program uses a descriptor of the pty that was opened before the link locked the port.
    """
    from unitylink import connect

    with opened(url) as slave, connect(with_option(url, f"protocol={protocol}")) as link:
        call, options = side(link)
        program = native(run.checkout, "bench_round_trip")
        with Process([program, *options, "--descriptor", str(slave)], pass_fds=[slave]) as bare:
            return _turns(run, call, bare)


def against_same_bytes(run: Run, configuration: dict[str, int], side: FramedSide) -> Comparison:
    """Measure `side` on a framed link, against a bare program with the same bytes.

    A trace gives the bytes that the link sends, from the first one to the request that is measured. The bare
    program sends the same bytes to another twin, in another session. Only the ids change from one request to
    the next.
    """
    from unitylink import connect

    with twin("pty", **configuration) as ours, twin("pty", **configuration) as theirs:
        url = with_option(ours.line(), "protocol=framed")
        said = _said(url, side)
        program = native(run.checkout, "bench_frame_trip")
        with opened(theirs.line()) as slave, connect(url) as link:
            call = side(link)
            command: list[str | Path] = [program, "--said", said.hex(), "--descriptor", str(slave)]
            with Process(command, pass_fds=[slave]) as bare:
                bytes_each_way = [int(word) for word in bare.line().split()]
                before = link.statistics()
                call()
                after = link.statistics()
                sent = [after.bytes_sent - before.bytes_sent, after.bytes_received - before.bytes_received]
                if sent != bytes_each_way:
                    raise BenchError(f"the link takes {sent} bytes each way, the bare one {bytes_each_way}")
                return _turns(run, call, bare)


def _said(url: str, side: FramedSide) -> bytes:
    """Open a link, call `side` once, and return all bytes that the link sent."""
    from unitylink import connect

    with tempfile.TemporaryDirectory() as folder:
        trace = Path(folder) / "said.pcapng"
        with connect(with_option(url, f"trace={trace}")) as link:
            side(link)()
            until = link.statistics().bytes_sent
        packets = [packet.data for packet in read_packets(trace) if packet.direction == SENT]
    return b"".join(packets)[:until]  # without the CLOSE at the end


def _turns(run: Run, call: Callable[[], object], bare: Process) -> Comparison:
    with processors_awake():
        bare.series("200")
        times(call, 200)
        return in_turns(
            lambda count: times(call, count),
            lambda count: bare.series(str(count)),
            rounds=run.rounds(101),
            count=200 if not run.quick else 50,
        )


def with_option(url: str, option: str) -> str:
    """Return the URL with one more option.

    >>> with_option("serial:/dev/pts/3", "protocol=framed")
    'serial:/dev/pts/3?protocol=framed'
    """
    return f"{url}{'&' if '?' in url else '?'}{option}"


@contextmanager
def opened(url: str) -> Iterator[int]:
    """Open the pty at `url` for a bare program, before a link locks the port."""
    slave = os.open(url.partition(":")[2].partition("?")[0], os.O_RDWR | os.O_NOCTTY)
    try:
        yield slave
    finally:
        os.close(slave)
