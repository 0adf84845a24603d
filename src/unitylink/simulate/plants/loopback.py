# SPDX-License-Identifier: BSD-3-Clause
"""The plant that returns what the PC writes."""

from __future__ import annotations

from unitylink.spec.model import Instance, Spec

from ..registers import Registers
from .words import Echo, WordPlant


class LoopbackPlant(WordPlant):
    """In every instance, the first READ echoes the first WRITE, and the second READ the second WRITE.

    Other READs count.
    """

    def fill(self, spec: Spec | None, registers: Registers) -> None:
        for root in spec.roots if spec else ():
            self._attach(root, registers.data_bits)

    def _attach(self, instance: Instance, data_bits: int) -> None:
        # words of other links do not echo
        plain = instance.elements if instance.link.kind in ("memory", "tosnet") else ()
        writes = [element for element in plain if element.access == "WRITE"]
        reads = [element for element in plain if element.access == "READ"]
        for write, read in zip(writes, reads, strict=False):
            pairs = zip(write.addresses, read.addresses, strict=False)
            self.echoes += [Echo(source, target) for source, target in pairs]
        for read in reads[len(writes) :]:
            self.ramp(read, data_bits)
        for inner in instance.instances:
            self._attach(inner, data_bits)
