# SPDX-License-Identifier: BSD-3-Clause
"""What is proven about a node of a TosNet ring."""

from __future__ import annotations

from block import Block, Mutant

TOSNET_BLOCKS = (
    Block(
        "tosnet_code",
        "`tosnet/tosnet_code_pkg`: 8b10b, scrambler and checksum of the TosNet line",
        depth=2,
        induction=1,
        not_proven="that all symbols that do not exist are told: one wrong bit may make another symbol",
        mutants=(
            Mutant("tosnet_code_pkg.vhd", '"100111", "101001"', '"100110", "101001"'),
            Mutant("tosnet_code_pkg.vhd", "so_far := disparity xor to_bit(swap);", "so_far := disparity;"),
            Mutant("tosnet_code_pkg.vhd", "elsif so_far = '0' and control = '1' then", "elsif false then"),
            Mutant(
                "tosnet_code_pkg.vhd",
                "return (scramble(1) xor scramble(0)) &",
                "return (scramble(1) and scramble(0)) &",
            ),
            Mutant(
                "tosnet_code_pkg.vhd",
                "(rest(top - 1 downto 0) & '0') xor feedback",
                "(rest(top - 1 downto 0) & '1') xor feedback",
            ),
        ),
    ),
    Block(
        "tosnet_packet",
        "`tosnet/tosnet_packet_out` and `tosnet_packet_in`, without line errors, a symbol in each clock",
        depth=0,
        deep=22,
        not_proven="damaged symbols, longer packets: the benches test them",
        mutants=(
            Mutant(
                "tosnet_packet_out.vhd",
                "(not item_valid or item_data(0));",
                "item_data(0);",
            ),
            Mutant(
                "tosnet_packet_out.vhd",
                "state <= seed_symbol;\n            sum   <= (others => '0');",
                "state <= seed_symbol;",
            ),
            Mutant("tosnet_packet_in.vhd", "scramble <= next_scramble(scramble);", "null;"),
            Mutant("tosnet_packet_in.vhd", "enough <= to_bit(count = check_bytes);", "enough <= '1';"),
        ),
    ),
    Block(
        "tosnet_words",
        "`tosnet/tosnet_words` with two rings: no set of words is torn",
        depth=8,
        reach=12,
        pdr=True,
        not_proven="that the master redistributes words of one cycle: the ring's bench tests it",
        mutants=(
            Mutant("tosnet_words.vhd", "if all_came = '1' and not taken then", "if not taken then"),
            Mutant("tosnet_words.vhd", "since <= apart_clocks;", "since <= 0;"),
            Mutant("tosnet_words.vhd", "came(ring) <= (others => '0');", "null;"),
            Mutant(
                "tosnet_words.vhd", "send_words(ring) <= word;", "send_words(ring) <= word or write_words(0);"
            ),
        ),
    ),
    Block(
        "tosnet_walk",
        "`tosnet/tosnet_walk` in a ring of two nodes, with any registers",
        depth=8,
        pdr=True,
        reach=70,
        not_proven="larger rings, and that no register is left out: the bench tests them",
        mutants=(
            Mutant("tosnet_walk.vhd", "others_todo(to_integer(selected)) <= '0';", "null;"),
            Mutant("tosnet_walk.vhd", "section <= '1';", "section <= '0';"),
            Mutant("tosnet_walk.vhd", "if place = 15 then", "if place = 14 then"),
        ),
    ),
    Block(
        "tosnet_carrier",
        "`tosnet/tosnet_carrier` with three words to write and two to read",
        depth=16,
        pdr=True,
        reach=40,
        not_proven="other numbers of words, and slaves that let the bus wait: the bench tests them",
        mutants=(
            Mutant("tosnet_carrier.vhd", "renews    <= renews or exchange;", "renews <= exchange;"),
            Mutant("tosnet_carrier.vhd", "begins    <= begins or (running xor ran);", "null;"),
            Mutant("tosnet_carrier.vhd", "following := constants;", "following := constants + 1;"),
            Mutant("tosnet_carrier.vhd", "place = writes - 1 or place = words - 1", "place < words"),
        ),
    ),
)
