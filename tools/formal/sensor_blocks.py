# SPDX-License-Identifier: BSD-3-Clause
"""What is proven about the components that measure."""

from __future__ import annotations

from block import Block, Mutant

SENSOR_BLOCKS = (
    Block(
        "sigma_delta_adc_sinc3",
        "`components/sigma_delta_adc`, a filter with an osr of 3 and a bit at each clock",
        depth=6,
        deep=22,
        not_proven="the clocks after the search, which has five values; other rates; bits further apart",
        mutants=(
            Mutant(
                "sigma_delta_adc_sinc3.vhd", "sums(3) <= sums(3) + sums(2);", "sums(3) <= sums(3) + sums(1);"
            ),
            Mutant("sigma_delta_adc_sinc3.vhd", "if left = 0 then", "if left = 1 then"),
            Mutant(
                "sigma_delta_adc_sinc3.vhd", "before(number) <= value;", "before(number) <= sums(number);"
            ),
            Mutant(
                "sigma_delta_adc_sinc3.vhd", "before <= (others => (others => '0'));\n        left", "left"
            ),
        ),
    ),
    Block(
        "sigma_delta_adc",
        "`components/sigma_delta_adc`, two channels, filters that give any value",
        depth=8,
        reach=14,
        pdr=True,
        for_ever=("lost_is_told", "lost_trips", "trip_has_a_cause"),
        seen={
            "words": "dut.write_words",
            "take": "dut.take",
            "levels": "dut.levels",
            "fresh": "dut.fresh",
            "trip_fresh": "dut.trip_fresh",
            "sums": "dut.sums",
            "trip_sums": "dut.trip_sums",
        },
        loose=("dut.take", "dut.fresh", "dut.trip_fresh", "dut.sums", "dut.trip_sums"),
        not_proven="mclk; other rates and numbers of channels; the filters, which have a proof of their own",
        mutants=(
            Mutant("sigma_delta_adc.vhd", "sum > highest or sum < lowest", "sum > highest"),
            Mutant(
                "sigma_delta_adc.vhd", "sum > highest or sum < lowest", "sum > highest + 1 or sum < lowest"
            ),
            Mutant(
                "sigma_delta_adc.vhd",
                "bad := lost or beyond;",
                "bad := lost or (channels_t'range => beyond(0));",
            ),
            Mutant("sigma_delta_adc.vhd", "elsif enabled_before = '0' then", "else"),
            Mutant("sigma_delta_adc.vhd", "running    <= nor bad;", "running    <= '1';"),
            Mutant("sigma_delta_adc.vhd", "settled(number) <= 0;", "null;"),
            Mutant("sigma_delta_adc.vhd", "value_t'length)) - bias -", "value_t'length)) - bias +"),
        ),
    ),
    Block(
        "rc_receiver",
        "`components/rc_receiver`, two channels, frames at any clock and of any age",
        depth=12,
        pdr=True,
        seen={
            "put": "dut.put",
            "channel": "dut.channel",
            "value": "dut.value",
            "whole": "dut.whole",
            "broken": "dut.broken",
            "flags": "dut.flags",
            "age": "dut.age",
            "valid": "dut.valid",
        },
        loose=("dut.put", "dut.channel", "dut.value", "dut.whole", "dut.broken", "dut.flags", "dut.age"),
        not_proven="the front ends, PPM and S.Bus, and how the age counts: the bench has them",
        mutants=(
            Mutant("rc_receiver.vhd", "(bank xnor fresh) & channel", "(not bank) & channel"),
            Mutant("rc_receiver.vhd", "elsif takes = '1' or put = '1' then", "elsif takes = '1' then"),
            Mutant("rc_receiver.vhd", "takes   <= pending and not wishbone_m2s.cyc;", "takes   <= pending;"),
            Mutant(
                "rc_receiver.vhd",
                "fresh   <= takes and not kept(3) and not kept(2);",
                "fresh   <= takes and not kept(3);",
            ),
            Mutant("rc_receiver.vhd", "(takes and kept(3)) = '1' or expires", "expires"),
            Mutant("rc_receiver.vhd", "is_channel <= valid and to_bit", "is_channel <= to_bit"),
        ),
    ),
    Block(
        "hall",
        "`components/hall`, a clock of 1 MHz, without a filter",
        depth=14,
        induction=2,
        seen={
            "levels": "dut.levels",
            "sector": "dut.sector",
            "known": "dut.known",
            "runs": "dut.runs",
            "back": "dut.back",
            "timed": "dut.timed",
            "taken": "dut.taken",
        },
        not_proven="when a step of the angle is due; the velocity; the filter: the bench has them",
        mutants=(
            Mutant("hall.vhd", "angle <= angle + step_size;", "angle <= angle + step_size + 1;"),
            Mutant("hall.vhd", "if timed = '1' and back = to_bit(down) then", "if timed = '1' then"),
            Mutant("hall.vhd", "valid      <= to_bit(good);", "valid      <= '1';"),
            Mutant("hall.vhd", "place := sector & '0';", "place := found & '0';"),
            Mutant("hall.vhd", "if known = '1' and (up or down) then", "if known = '1' then"),
            Mutant("hall.vhd", "(not good and bad_before = '0')", "not good"),
        ),
    ),
    Block(
        "one_wire",
        "`components/one_wire`, a try; the places of a slot come at any clock, in their order",
        depth=8,
        pdr=True,
        reach=20,
        for_ever=(
            "counts",
            "counts_looked",
            "has_converted",
            "has_marks",
            "only_samples",
            "right_check",
            "right_value",
        ),
        seen={
            "enable": "dut.enable",
            "turns": "dut.turns",
            "place": "dut.timer",
            "due": "dut.due",
            "step": "dut.step",
            "number": "dut.count",
            "raw": "dut.raw",
            "state": "dut.state",
            "value": "dut.value",
        },
        loose=("dut.tick", "dut.eighth", "dut.timer", "dut.due"),
        not_proven="what the state says; other resolutions; parasite 1: the bench has them",
        mutants=(
            Mutant("one_wire.vhd", "(ended = '0' or accept = '1')", "true"),
            Mutant("one_wire.vhd", "if unsigned(crc) /= 0 then", "if false then"),
            Mutant("one_wire.vhd", "elsif lost = '1' then", "elsif false then"),
            Mutant("one_wire.vhd", "elsif was_busy = '1' then", "elsif true then"),
            Mutant("one_wire.vhd", "was_busy <= '0';", "null;"),
            Mutant(
                "one_wire.vhd",
                "if step /= rests then\n          fail(not_converted);",
                "if false then\n          null;",
            ),
            Mutant("one_wire.vhd", "if count(6 downto 4) = 0 then", "if count(5 downto 4) = 0 then"),
        ),
    ),
    Block(
        "pulse_counter_reads",
        "`components/pulse_counter`, what the bus reads, of words that may be anything",
        depth=12,
        pdr=True,
        reach=60,
        seen={
            "round": "dut.words.count",
            "starting": "dut.words.starting",
            "sum": "dut.words.sum",
            "reads": "dut.words.reads",
            "bank": "dut.words.bank",
            "whole": "dut.words.whole",
            "shown": "dut.words.shown",
        },
        loose=("dut.words.sum",),
        not_proven="the frequency; a master that gives an access up",
        mutants=(
            Mutant("pulse_counter_words.vhd", "bank <= bank xor shown;", "bank <= not bank;"),
            Mutant("pulse_counter_words.vhd", "thawed or (put and last)", "thawed"),
            Mutant("pulse_counter_words.vhd", "if reads = '0' then", "if reads = '0' and second = '1' then"),
        ),
    ),
    Block(
        "pulse_counter_words",
        "`components/pulse_counter`, the words that are written, of 8 bits; a timeout of 64 ticks",
        depth=0,
        deep=10,
        induction=3,
        by_abc=True,
        reach=48,
        seen={
            "round": "dut.count",
            "between": "dut.period",
            "has_shut": "dut.was_shut",
            "puts": "dut.put",
            "acks": "dut.ack",
            **{
                name: f"dut.{name}"
                for name in (
                    *(
                        "starting",
                        "closed",
                        "whole",
                        "bank",
                        "shown",
                        "now",
                        "sum",
                        "paused",
                        "rests",
                        "pulses",
                    ),
                    *(
                        "ticks",
                        "at",
                        "span",
                        "passed",
                        "stepped_at",
                        "has_pulse",
                        "has_two",
                        "stepped",
                        "twice",
                    ),
                    "shut",
                )
            },
        },
        not_proven="longer words and timeouts; the frequency; a master that gives an access up",
        mutants=(
            Mutant("pulse_counter_words.vhd", "before    := (others => '0');\n        begun", "begun"),
            Mutant("pulse_counter_words.vhd", "given  <= hit;", "given  <= '0';"),
            Mutant("pulse_counter_words.vhd", "pulse and gate and not paused and", "pulse and gate and"),
            Mutant("pulse_counter_words.vhd", "or twice = '1' or rests = '1')", "or twice = '1')"),
            Mutant("pulse_counter_words.vhd", "span      <= begun - since;", "span      <= begun;"),
            Mutant(
                "pulse_counter_words.vhd",
                "if shut = '1' then\n            rests",
                "if false then\n            rests",
            ),
            Mutant("pulse_counter_words.vhd", "stopped <= not rests;", "stopped <= '1';"),
            Mutant("pulse_counter_words.vhd", "(put or (hit and not second))", "(put or hit)"),
        ),
    ),
    Block(
        "encoder_bank",
        "`components/encoder_bank`, two channels, words of 12 bits, samples in each round",
        depth=0,
        deep=6,
        pdr=True,
        reach=20,
        seen={
            "clocks": "dut.count",
            "begins": "dut.starting",
            "shut": "dut.closed",
            "old": "dut.whole",
            "for_bus": "dut.shown",
            "near": "dut.pins_synchroniser.first",
            "seen": "dut.settled",
            "taken": "dut.sample",
            "now_are": "dut.levels",
            "thaws": "dut.thawed",
            "acks": "dut.ack",
            "errs": "dut.err",
            **{
                name: f"dut.{name}"
                for name in ("bank", "known", "sum", "fault_sum", "newest", "place", "put", "found")
            },
        },
        not_proven="more channels; samples that are rounds apart; a master that gives an access up",
        mutants=(
            Mutant("encoder_bank.vhd", "(now(0) xor was(1))", "(now(0) xor now(1))"),
            Mutant("encoder_bank.vhd", "bank <= bank xor shown;", "bank <= not bank;"),
            Mutant("encoder_bank.vhd", "(thawed or (done and last))", "thawed"),
            Mutant("encoder_bank.vhd", "samples = '1' and sample(line) = before(line)", "samples = '1'"),
            Mutant(
                "encoder_bank.vhd", "second = '1' and\n                        channel = turn", "second = '1'"
            ),
            Mutant("encoder_bank.vhd", "if hit = '1' and is_faults = '0' then", "if hit = '1' then"),
        ),
    ),
)
