# SPDX-License-Identifier: BSD-3-Clause
"""Every figure that is compared with the paper, by name, in seconds and bit/s."""

from __future__ import annotations

from dataclasses import replace

from . import level_one
from .exchange import read, write
from .gateware import CLOCK_HZ
from .link_parameters import FT245_ASYNC, LinkParameters
from .low_level import largest_held_burst, read_burst, synchronous_s, write_burst
from .software_cost import SoftwareCost

BURST_REQUESTS = 200
LONG_BURST_REQUESTS = 600
HELD_BURST_REQUESTS = 18


def model_figures(
    cost: SoftwareCost,
    link: LinkParameters = FT245_ASYNC,
    *,
    pause_s: float = 0.0,
    start_s: float = 0.0,
    long_requests: int = LONG_BURST_REQUESTS,
) -> dict[str, float]:
    """Return the figures of the 2012 gateware behind the paper's link, with the classic protocol.

    The latency of the full stack is that of the model plus the cost of this host's software. Each other
    argument changes one part of the model (`ablations.py`).
    """
    link_si = replace(link, send_immediate="all")
    figures: dict[str, float] = {"link_hz": 8 / link.byte_s}
    for exchange, stack_s in ((read(), cost.stack_read_s), (write(), cost.stack_write_s)):
        name = exchange.name
        one = level_one.figures("2012", exchange)
        assert one.latency_clocks is not None
        if one.effect_clocks is not None:
            figures[f"{name}_gateware_effect_s"] = one.effect_clocks / CLOCK_HZ
        figures[f"{name}_gateware_s"] = one.latency_clocks / CLOCK_HZ
        figures[f"{name}_gateware_request_hz"] = one.request_hz
        figures[f"{name}_gateware_reply_hz"] = one.reply_hz
        figures[f"{name}_ideal_s"] = exchange.bits * link.byte_s / 8 + one.latency_clocks / CLOCK_HZ
        for tail, chosen in (("", link), ("_si", link_si)):
            script_s = synchronous_s(chosen, exchange, pause_s=pause_s)
            figures[f"{name}_script{tail}_s"] = script_s
            figures[f"{name}_script{tail}_hz"] = exchange.bits / script_s
            figures[f"{name}_stack{tail}_s"] = script_s + stack_s
            figures[f"{name}_stack{tail}_hz"] = exchange.bits / (script_s + stack_s)
    for tail, chosen, requests in (("", link, BURST_REQUESTS), ("_si", link_si, HELD_BURST_REQUESTS)):
        reads = read_burst(chosen, requests)
        figures[f"read_burst{tail}_received_hz"] = reads.received_hz
        figures[f"burst{tail}_stamped_hz"] = reads.stamped_hz
        writes = write_burst(chosen, write())
        burst_s = writes.bits / writes.effective_hz + start_s
        figures[f"write_burst{tail}_first_s"] = writes.first_s + start_s
        figures[f"write_burst{tail}_period_s"] = writes.period_s
        figures[f"write_burst{tail}_hz"] = writes.bits / burst_s
    long = read_burst(link, long_requests)
    figures["long_burst_stamped_hz"] = long.stamped_hz
    figures["long_burst_unpaused_hz"] = long.unpaused_hz
    figures["long_burst_between_pauses"] = long.between_pauses
    figures["burst_si_most"] = largest_held_burst(link)
    return figures
