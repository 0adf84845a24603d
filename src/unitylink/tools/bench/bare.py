# SPDX-License-Identifier: BSD-3-Clause
"""A call through a link against a bare C++ round trip: both through one pty, to one twin, in turns."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import TYPE_CHECKING

from .figure import Run
from .programs import Process, native
from .timing import Comparison, in_turns, times

if TYPE_CHECKING:
    from unitylink.layer2_message import Link

# link -> the call, and what the bare program is told to send
Side = Callable[["Link"], tuple[Callable[[], object], list[str]]]


def against_bare(run: Run, url: str, protocol: str, side: Side) -> Comparison:
    """Measure what `side` makes of a link of `protocol` to the pty at `url`.

    The bare program holds a descriptor of the pty that was opened before the link took the port.
    """
    from unitylink import connect

    slave = os.open(url.partition(":")[2].partition("?")[0], os.O_RDWR | os.O_NOCTTY)
    try:
        with connect(f"{url}{'&' if '?' in url else '?'}protocol={protocol}") as link:
            call, options = side(link)
            program = native(run.checkout, "bench_round_trip")
            with Process([program, *options, "--descriptor", str(slave)], pass_fds=[slave]) as bare:
                bare.series("200")
                times(call, 200)
                return in_turns(
                    lambda count: times(call, count),
                    lambda count: bare.series(str(count)),
                    rounds=run.rounds(101),
                    count=200 if not run.quick else 50,
                )
    finally:
        os.close(slave)
