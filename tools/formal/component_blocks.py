# SPDX-License-Identifier: BSD-3-Clause
"""What is proven about components."""

from __future__ import annotations

from block import Block, Mutant

COMPONENT_BLOCKS = (
    Block(
        "gpio",
        "`components/gpio`, two pins without a filter",
        depth=14,
        pdr=True,
        not_proven="other numbers of pins; the filter; a master that gives an access up",
        mutants=(
            Mutant("gpio.vhd", "pin_out or write_words(3)(pins_t'range);", "write_words(3)(pins_t'range);"),
            Mutant(
                "gpio.vhd",
                "changed <= or ((levels xor before) and",
                "changed <= or ((levels and not before) and",
            ),
            Mutant("gpio.vhd", 'writable => "011111"', 'writable => "111111"'),
        ),
    ),
)
