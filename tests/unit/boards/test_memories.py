# SPDX-License-Identifier: BSD-3-Clause
"""Block RAMs are counted in the netlist. A chip with too few is refused, with the sum."""

from __future__ import annotations

import pytest

from unitylink.boards import load_board
from unitylink.boards.memories import BLOCK_RAMS, Memory, memories_of, shortage

NETLIST = """\
module fifo_8_16
  (input  clock);
  reg [7:0] memory[15:0] ; // memory
endmodule
module unused
  (input  clock);
  reg [31:0] memory[65535:0] ; // memory
endmodule
module buffer_129_a93755f8273b0e8dc4b0ecc158e5853119a24bf0
  (input  clock);
  reg [17:0] memory[4095:0] ; // memory
  reg [4:0] taken[1023:0] ; // memory
  reg [4:0] state;
  reg [31:0] table_of_logic[255:0] ; // memory
  assign light = table_of_logic[state];
  reg [15:0] program[511:0] ; // memory
  assign next = program[state];
  assign fetched = enable ? next : instruction;
  assign oldest = memory[state];
  memory[state] <= command;
  fifo_8_16 records (
endmodule
module lamp_top
  (input  clock);
  buffer_129_a93755f8273b0e8dc4b0ecc158e5853119a24bf0 requests (
  fifo_8_16 bytes (
endmodule
"""


@pytest.mark.parametrize(
    ("words", "bits", "block_rams"),
    [
        (16, 8, 1),
        (256, 16, 1),
        (257, 16, 2),
        (512, 8, 1),
        (2048, 2, 1),
        (512, 80, 10),
        (4096, 18, 18),
        (64, 19, 2),
        (1024, 5, 2),
    ],
)
def test_a_memory_takes_the_shape_that_needs_fewest(words: int, bits: int, block_rams: int) -> None:
    assert Memory("one", words, bits).block_rams == block_rams
    assert Memory("three", words, bits, 3).block_rams == 3 * block_rams


def test_a_module_below_the_top_counts_once_for_each_instance() -> None:
    assert [str(memory) for memory in memories_of(NETLIST, "Lamp_Top")] == [
        "18 in buffer: 4,096 words of 18 bits",
        "2 in buffer: 1,024 words of 5 bits",
        "2 in buffer: 512 words of 16 bits",
        "2 in fifo: 2 times 16 words of 8 bits",
    ]


def test_a_chip_with_too_few_is_refused_with_the_sum() -> None:
    memories = memories_of(NETLIST, "lamp_top")
    assert shortage(memories, "hx8k") == shortage(memories, "25k") == ()
    (first, *rest) = shortage(memories, "hx1k")
    assert first == "it takes 24 block RAMs and the chip has 16" and rest == list(map(str, memories))
    assert shortage(memories[:1], "lp384") and not shortage([], "lp384")


def test_every_ice40_of_a_board_is_known() -> None:
    assert {load_board(name).device for name in ("icebreaker", "ice40-hx8k")} <= BLOCK_RAMS.keys()
