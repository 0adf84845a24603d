# SPDX-License-Identifier: BSD-3-Clause
"""Suspected causes of differences from the paper, each as a change of the model.

If a suspected cause is true, its change brings the cell to the paper's value.

A change is made to the whole model, so it also shows which other cells get worse.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from .link_parameters import FT245_ASYNC, LinkParameters
from .model_figures import LONG_BURST_REQUESTS, model_figures
from .software_cost import SoftwareCost

Figures = dict[str, float]

PAPER_BYTE_S = 1.159e-6 / 14  # the paper's shortest period in a burst of writes has 14 bytes
PAPER_START_S = 18e-6  # 19.9 us from request to effect, less the time of gateware and link
# The rows Unity-SW less Low-level python, without SI. Table I does not have the other costs.
PAPER_STACK = SoftwareCost(
    0.0, 0.0, stack_read_s=98e-6, stack_write_s=87e-6, framed_read_s=0, framed_write_s=0
)


@dataclass(frozen=True)
class Ablation:
    """One change of the model.

    `words` describes it. `chosen` is the cell of the paper from which its size was taken.
    """

    words: str
    chosen: str = ""
    link: LinkParameters = FT245_ASYNC
    pause_s: float = 0.0
    start_s: float = 0.0
    long_requests: int = LONG_BURST_REQUESTS
    stack: SoftwareCost | None = None

    def figures(self, cost: SoftwareCost) -> Figures:
        """Return all figures of the model with this change."""
        return model_figures(
            self.stack or cost,
            self.link,
            pause_s=self.pause_s,
            start_s=self.start_s,
            long_requests=self.long_requests,
        )


ABLATIONS: dict[str, Ablation] = {
    "pause": Ablation("the script pauses 26 us between requests", "974 us", pause_s=26e-6),
    "one-reply": Ablation(
        "the host takes one reply of 14 bytes from each packet", link=replace(FT245_ASYNC, packet_bytes=16)
    ),
    "microframe": Ablation(
        "a microframe of 175 us", "639.1 kb/s", link=replace(FT245_ASYNC, microframe_s=175e-6)
    ),
    "two-buses": Ablation("a data bus for each way", link=replace(FT245_ASYNC, half_duplex=False)),
    "fast": Ablation("14 bytes in 1.159 us", "1.159 us", link=replace(FT245_ASYNC, byte_s=PAPER_BYTE_S)),
    "fast-two-buses": Ablation(
        "a data bus for each way and 14 bytes in 1.159 us",
        "1.159 us",
        link=replace(FT245_ASYNC, byte_s=PAPER_BYTE_S, half_duplex=False),
    ),
    "start": Ablation("the host starts a transfer 18 us later", "19.9 us", start_s=PAPER_START_S),
    "all-out": Ablation(
        "a data bus for each way, 14 bytes in 1.159 us and a start 18 us later",
        "1.159 and 19.9 us",
        link=replace(FT245_ASYNC, byte_s=PAPER_BYTE_S, half_duplex=False),
        start_s=PAPER_START_S,
    ),
    "stack": Ablation(
        "the stack costs as much as in the paper without SI (98 and 87 us)", "1072 us", stack=PAPER_STACK
    ),
    "shorter-burst": Ablation("a burst of 300 reads instead of 600", long_requests=300),
}


def ablations(cost: SoftwareCost) -> dict[str, Figures]:
    """Return the figures of the model with each ablation."""
    return {name: ablation.figures(cost) for name, ablation in ABLATIONS.items()}
