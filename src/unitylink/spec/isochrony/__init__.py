# SPDX-License-Identifier: BSD-3-Clause
"""How regularly the gateware publishes: the clocks from a base strobe to the first bus strobe of a publish.

The constants are [latency], [framed_latency] and [small_latency] of protocol.toml.
tests/gateware/test_isochrony.py, test_framed_isochrony.py and test_small_isochrony.py compare the VHDL with
them.
"""

from __future__ import annotations

from collections.abc import Sequence

from unitylink.errors import ValueRangeError

from . import classic, framed, small
from .bound import Gateware, Isochrony, Occupation

__all__ = ["Gateware", "Isochrony", "Occupation", "isochrony"]


def isochrony(
    gateware: Gateware,
    *,
    protocol: str | None = None,
    read_many: int | None = None,
    before: Sequence[int] = (),
    checked: bool = True,
    bus_waits: int = 0,
) -> Isochrony:
    """Return the idle time and the bound of a publish of `gateware`, in clocks.

    `protocol` is the one of the link ("classic" or "framed"). With None it is framed if the gateware has it.
    `read_many` is the most words in a request of the host. With None it is the most that is possible.
    `before` has the words of publishes that may be due at the same time and come first. `checked` counts the
    classic checksums. `bus_waits` is how many clocks a slave acknowledges later than one clock after the
    strobe. An access that times out adds twice the bus timeout. Classic text in a framed session is not
    counted. Raises ValueRangeError for datalinks that execute a request while it arrives, because they have
    no bound.

    >>> from unitylink.simulate import BoardConfiguration
    >>> board = BoardConfiguration(groups=2, group_size=16, read_many=32)
    >>> result = isochrony(board, protocol="classic")
    >>> result.idle_clocks, result.late_clocks, result.longest.name
    (14, 273, 'RM')
    >>> isochrony(board).longest.name
    'LIST'
    """
    chosen = protocol or ("classic" if gateware.protocol == "classic" else "framed")
    if chosen not in ("classic", "framed") or gateware.protocol not in (chosen, "both"):
        raise ValueRangeError(f"isochrony: protocol is {chosen!r}; the gateware speaks {gateware.protocol}")
    if gateware.publish_mode == 0:
        raise ValueRangeError("isochrony: publish_mode is 0; gateware without publishing has none")
    if read_many is not None and read_many < 0:
        raise ValueRangeError(f"isochrony: read_many is {read_many}; choose 0 or more words")
    if chosen == "framed":
        bound = small.isochrony if gateware.engine == "small" else framed.isochrony
        return bound(gateware, words=read_many, before=before, bus_waits=bus_waits)
    return classic.isochrony(
        gateware, read_many=read_many, before=before, checked=checked, bus_waits=bus_waits
    )
