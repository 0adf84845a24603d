# SPDX-License-Identifier: BSD-3-Clause
"""What is proven about the physical layers."""

from __future__ import annotations

from block import Block, Mutant

PHYSICAL_BLOCKS = (
    Block(
        "uart_tx",
        "`physical/uart_tx`, 8N1, 4 clocks a bit",
        depth=12,
        deep=60,
        reach=45,
        pdr=True,
        not_proven="parity, two stop bits, bits that are no whole number of clocks: the benches test them",
        mutants=(
            Mutant("uart_tx.vhd", "left = 1 and tick = '1') else", "left = 1) else"),
            Mutant("uart_tx.vhd", "phase <= resize(increment, bits + 1);", "phase <= (others => '0');"),
            Mutant("uart_tx.vhd", "shift <= '1' & shift(9 downto 1);", "shift <= '0' & shift(9 downto 1);"),
        ),
    ),
    Block(
        "uart_rx",
        "`physical/uart_rx`, 8N1, 8 clocks a bit",
        depth=12,
        deep=110,
        not_proven="frames after the first; parity, fast or slow senders, spikes: the benches test them",
        mutants=(
            Mutant(
                "uart_rx.vhd",
                "shift    <= level & shift(7 downto 1);",
                "shift    <= shift(6 downto 0) & level;",
            ),
            Mutant("uart_rx.vhd", "error(framing_error_bit) := '1';", "error(framing_error_bit) := '0';"),
            Mutant("uart_rx.vhd", "all_low  <= '1';", "null;"),
        ),
    ),
    Block(
        "receive_buffer",
        "`physical/receive_buffer`, 4 items",
        depth=10,
        pdr=True,
        not_proven="other depths",
        mutants=(
            Mutant("receive_buffer.vhd", "item_ready <= rx_ready or not is_byte;", "item_ready <= rx_ready;"),
            Mutant("receive_buffer.vhd", "item_valid and is_byte;", "item_valid;"),
            Mutant(
                "receive_buffer.vhd",
                "when item_valid = '1' else no_receive_error;",
                "when is_byte = '0' else no_receive_error;",
            ),
        ),
    ),
    Block(
        "ft245_async",
        "`physical/ft245_async` at 50 MHz, buffers of 2 bytes",
        depth=8,
        deep=20,
        reach=32,
        pdr=True,
        not_proven="that no byte is lost between chip and buffers: the chip model of the benches tests it",
        mutants=(
            Mutant("ft245_async.vhd", "count <= read_clocks - 1;", "count <= 0;"),
            Mutant("ft245_async.vhd", "flush      <= send_item(8);", "flush      <= '1';"),
            Mutant(
                "ft245_async.vhd", "state   <= holding;", "state   <= idle;\n            data_drive <= '0';"
            ),
        ),
    ),
    Block(
        "ft245_async_bytes",
        "`physical/ft245_async`, 50 MHz, buffers of 2 bytes, a chip that gives and takes at any time",
        depth=8,
        deep=18,
        not_proven="times within a clock, and other clocks: the bench's model of the chip checks them",
        mutants=(
            Mutant("ft245_async.vhd", "seen_rxf_n = '0' and read_wait = 0 and", "read_wait = 0 and"),
            Mutant("ft245_async.vhd", "seen_txe_n = '0' and turn_wait = 0", "turn_wait = 0"),
            Mutant(
                "ft245_async.vhd", "            data_drive <= '0';\n            state", "            state"
            ),
            Mutant("ft245_async.vhd", "flushed <= flush;", "flushed <= '1';"),
        ),
    ),
    Block(
        "ft245_sync",
        "`physical/ft245_sync`, buffers of 4 bytes, bursts of 4 clocks, a chip that may do anything",
        depth=6,
        deep=30,
        reach=30,
        pdr=True,
        not_proven="streams on another clock (see the proof of `async_fifo`); times within a clock",
        mutants=(
            Mutant(
                "ft245_sync.vhd",
                "            data_drive <= '0';\n            state      <= idle;",
                "            state      <= idle;",
            ),
            Mutant(
                "ft245_sync.vhd",
                "            oe_n  <= '0';\n",
                "            oe_n  <= '0';\n            rd_n  <= '0';\n",
            ),
            Mutant("ft245_sync.vhd", "taken and flush;", "full and flush;"),
        ),
    ),
    Block(
        "ft245_sync_bytes",
        "`physical/ft245_sync`, as above: its bytes, in both directions",
        depth=6,
        deep=34,
        not_proven="streams on another clock (see the proof of `async_fifo`); swapped bits",
        mutants=(
            Mutant("ft245_sync.vhd", "bytes_under_way : positive := 2;", "bytes_under_way : positive := 1;"),
            Mutant(
                "ft245_sync.vhd", "send_ready <= not full or taken;", "send_ready <= not full or not wr_n;"
            ),
            Mutant("ft245_sync.vhd", "got_valid <= not rd_n and not rxf_n;", "got_valid <= not rd_n;"),
        ),
    ),
    Block(
        "spi_slave",
        "`physical/spi_slave`, buffers of 2 bytes, any sck up to the clock's rate; depths in half clocks",
        depth=4,
        deep=34,
        several_clocks=True,
        not_proven="resets, overruns, filler within a message, long transfers: the bench tests them",
        mutants=(
            Mutant("spi_slave.vhd", "new_byte := came_2 xor came_3;", "new_byte := came_toggle xor came_3;"),
            Mutant("spi_slave.vhd", "miso_drive <= not cs_n;", "miso_drive <= '1';"),
            Mutant("spi_slave.vhd", "<= shift(5 downto 0) & mosi;", "<= shift(5 downto 0) & not mosi;"),
            Mutant("spi_slave.vhd", "and took_2 = offer_toggle and may_go", "and may_go"),
        ),
    ),
    Block(
        "siwu_pulse",
        "`physical/siwu_pulse`, pulses of 5 clocks",
        depth=12,
        deep=40,
        reach=30,
        pdr=True,
        not_proven="times within a clock",
        mutants=(
            Mutant("siwu_pulse.vhd", "waits <= waits or due;", "waits <= due;"),
            Mutant("siwu_pulse.vhd", "if count = gap_clocks then", "if count = 1 then"),
            Mutant(
                "siwu_pulse.vhd",
                "(waits or due) = '1' and count = 0",
                "(waits or due) = '1' and siwu_n = '1'",
            ),
        ),
    ),
    Block(
        "rs485_node",
        "`physical/rs485_node`, bits of 2 clocks, turns of 2 bytes, 3 bits of turn-around and of silence",
        depth=6,
        deep=16,
        reach=50,
        pdr=True,
        not_proven="that every frame for this node reaches the core; bits and buffers: the bench tests them",
        mutants=(
            Mutant(
                "rs485_node.vhd",
                "first(5 downto 0) = node then",
                "first(4 downto 0) = node(4 downto 0) then",
            ),
            Mutant("rs485_node.vhd", "if byte = token_check(first) then", "if true then"),
            Mutant("rs485_node.vhd", "bits_left > 1) then", "bits_left > 2) then"),
            Mutant(
                "rs485_node.vhd", "send_ready <= out_ready and may_say when", "send_ready <= may_say when"
            ),
        ),
    ),
)
