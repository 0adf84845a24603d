# SPDX-License-Identifier: BSD-3-Clause
"""What is proven about the components that talk over a line."""

from __future__ import annotations

from block import Block, Mutant

LINE_BLOCKS = (
    Block(
        "uart_bridge",
        "`components/uart_bridge`, queues of two bytes, half_duplex, a hold of 3 clocks; any lengths of bits",
        depth=10,
        pdr=True,
        reach=70,
        seen={
            "sent": "dut.sent",
            "send_data": "dut.send_data",
            "tx_ready": "dut.tx_ready",
            "rx_valid": "dut.rx_valid",
            "rx_data": "dut.rx_data",
            "rx_error": "dut.rx_error",
            "rate": "dut.index",
        },
        loose=("dut.transmitter.phase", "dut.receiver.phase"),
        not_proven="longer queues; a master that gives an access up",
        mutants=(
            Mutant("uart_bridge.vhd", "take  <= was_read(1) and came_1;", "take  <= was_read(1);"),
            Mutant("uart_bridge.vhd", "if room = 0 and unsigned(wishbone_m2s.adr) = 0 then", "if false then"),
            Mutant(
                "uart_bridge.vhd", "timer <= hold_clocks;\n          if to_send = '0'", "if to_send = '0'"
            ),
            Mutant("uart_bridge.vhd", "to_bit(state = idle) and not to_send and", "not to_send and"),
            Mutant("uart_bridge.vhd", "(is_half_duplex and tx_enable)", "'0'"),
            Mutant("uart_bridge.vhd", "gap <= not put;", "gap <= '0';"),
            Mutant("uart_bridge.vhd", "and not take and not (put and unread);", "and not take;"),
            Mutant("uart_bridge.vhd", "if to_send = '0' and tx_ready = '1' then", "if to_send = '0' then"),
        ),
    ),
    Block(
        "modbus_master_line",
        "`components/modbus_master`, the frames; bits, the pause and the timeout of any length",
        depth=0,
        deep=8,
        induction=3,
        by_abc=True,
        reach=95,
        seen={
            "tx_valid": "dut.tx_valid",
            "tx_ready": "dut.tx_ready",
            "tx_data": "dut.tx_data",
            "rx_valid": "dut.rx_valid",
            "rx_data": "dut.rx_data",
            "rx_error": "dut.rx_error",
            "level": "dut.level",
            "silence": "dut.silence",
            "silent": "dut.silent",
            "timer": "dut.timer",
            "late": "dut.late",
            "hears": "dut.state",
            "sum": "dut.crc",
            "is_last": "dut.last",
            "left": "dut.transmitter.left",
            "shift": "dut.transmitter.shift",
            **{name: f"dut.{name}" for name in ("data", "receives", "talks", "heard", "refuses", "lead")},
        },
        loose=("dut.silence", "dut.timer"),
        given={"dut.transmitter.phase": "tx_phase", "dut.receiver.phase": "rx_phase"},
        guided={"tx_ticks": 16383, "rx_ticks": 16383, "byte": 0, "reset": 0},
        not_proven="how long the pause and the timeout are; that a refusal is told from a good reply; the "
        "program, which `bus_sequencer` runs: the bench has them",
        mutants=(
            Mutant(
                "modbus_master_line.vhd",
                "to_bit(silence = pause_us) and level;",
                "to_bit(silence = pause_us);",
            ),
            Mutant("modbus_master_line.vhd", "          if lead = 0 then", "          if lead = 3 then"),
            Mutant("modbus_master_line.vhd", 'if crc_with(crc, rx_data) /= x"0000" then', "if false then"),
            Mutant("modbus_master_line.vhd", "elsif heard = 0 and late = '1' then", "elsif false then"),
            Mutant(
                "modbus_master_line.vhd",
                "elsif late = '1' then\n            fail",
                "elsif false then\n            fail",
            ),
            Mutant("modbus_master_line.vhd", "deaf      <= reset or drives;", "deaf      <= reset;"),
            Mutant(
                "modbus_master_line.vhd",
                "          if tx_ready = '1' then\n            drives <= '0';",
                "          if true then\n            drives <= '0';",
            ),
        ),
    ),
    Block(
        "servo_bus_receiver",
        "`components/servo_bus`, a reply of Feetech, a timeout of 20 us; characters come at any clock",
        depth=0,
        deep=6,
        induction=3,
        by_abc=True,
        reach=60,
        seen={
            "rx_valid": "dut.rx_valid",
            "data": "dut.data",
            "rx_error": "dut.rx_error",
            "place": "dut.place",
            "timer": "dut.timer",
            "counted": "dut.heard",
            "wrong": "dut.wrong",
            "extra": "dut.extra",
            "low": "dut.low",
            "summed": "dut.check",
        },
        without=(("servo_bus_receiver", "receiver"),),
        not_proven="Dynamixel: that is the next proof",
        mutants=(
            Mutant(
                "servo_bus_receiver.vhd",
                "fits := data = id;\n            else",
                "fits := true;\n            else",
            ),
            Mutant("servo_bus_receiver.vhd", "fits := unsigned(data) = rules.reply_length;", "fits := true;"),
            Mutant(
                "servo_bus_receiver.vhd", "wrong = '0' and extra = 0 and stuffed", "extra = 0 and stuffed"
            ),
            Mutant("servo_bus_receiver.vhd", "rx_valid when place = rules.header_last or", "rx_valid when"),
            Mutant(
                "servo_bus_receiver.vhd",
                "timer = timeout_us or (and heard) = '1' then",
                "timer = timeout_us then",
            ),
            Mutant("servo_bus_receiver.vhd", "without_sign(data & low, 15)", "without_sign(low & data, 15)"),
        ),
    ),
    Block(
        "servo_bus_receiver_dynamixel",
        "`components/servo_bus`, a reply of Dynamixel, a timeout of 20 us; characters come at any clock",
        depth=0,
        deep=6,
        induction=3,
        by_abc=True,
        reach=250,
        guided={"again": 0, "listens": 1, "id": 5, "steady": 1},
        seen={
            "counted": "dut.heard",
            "shift": "dut.checks.divides_shift",
            "left": "dut.checks.divides_left",
            "summed": "dut.check",
            **{
                name: f"dut.{name}"
                for name in ("data", "rx_error", "place", "timer", "wrong", "extra", "run", "low")
            },
        },
        without=(("servo_bus_receiver", "receiver"),),
        given={"dut.rx_valid": "arrives"},
        not_proven="that a reply with stuffed bytes is good: the bench has it",
        mutants=(
            Mutant("servo_bus_receiver.vhd", "fits := data = check(15 downto 8);", "fits := true;"),
            Mutant("servo_bus_receiver.vhd", "when 4 => fits := data = id;", "when 4 => fits := true;"),
            Mutant("servo_bus_receiver.vhd", 'data = x"FD" and extra /= 0;', 'data = x"FD";'),
            Mutant(
                "servo_bus_receiver.vhd",
                "if not fits or rx_error /= no_receive_error then",
                "if not fits or rx_error(0) = '1' then",
            ),
            Mutant("servo_bus_check.vhd", "elsif left /= 0 then", "elsif left > 1 then"),
        ),
    ),
    Block(
        "servo_bus_sender",
        "`components/servo_bus`, the packets of Feetech to two servos; a bit has any number of clocks",
        depth=0,
        deep=8,
        induction=3,
        by_abc=True,
        reach=170,
        guided={"tx_ticks": 8191, "reset": 0, "packet": 1, "told": 3, "engaged": 3, "first": 0, "second": 0},
        seen={
            "tx_data": "dut.tx_data",
            "tx_ready": "dut.tx_ready",
            "left": "dut.transmitter.left",
            "shift": "dut.transmitter.shift",
            "spot": "dut.place",
            **{name: f"dut.{name}" for name in ("taken", "state", "part", "timer", "length", "check")},
        },
        given={"dut.transmitter.phase": "tx_phase"},
        not_proven="Dynamixel, with its CRC; other numbers of servos: the bench has them",
        mutants=(
            Mutant("servo_bus_sender.vhd", "skips = '1' or (taken", "(taken"),
            Mutant(
                "servo_bus_sender.vhd",
                "        when ending =>\n          if tx_ready = '1' then",
                "        when ending =>\n          if true then",
            ),
            Mutant("servo_bus_sender.vhd", "if timer = 0 then", "if timer = 1 then"),
            Mutant(
                "servo_bus_sender.vhd",
                "engaged(to_integer(item));\n            end if;",
                "engaged(0);\n            end if;",
            ),
            Mutant(
                "servo_bus_sender.vhd",
                "bytes := bytes + count + (count & '0');",
                "bytes := bytes + (count & '0');",
            ),
            Mutant("servo_bus_sender.vhd", "place > rules.header_last)", "place > rules.header_last + 1)"),
        ),
    ),
    Block(
        "servo_bus",
        "`components/servo_bus`, the cycle, with two servos; packets and replies end at any clock",
        depth=0,
        deep=12,
        pdr=True,
        reach=50,
        seen={
            name: f"dut.{name}"
            for name in (
                *("state", "packet", "servo", "half", "timer", "tick", "go", "ended", "listens", "put"),
                *("field", "word", "good", "lost", "item", "goal_out", "last_out", "sent_out", "position"),
                *("puts_goal", "stamps", "copies", "keeps", "drive", "told", "engaged", "holding", "valid"),
                *("bank", "told_count", "engaged_count", "count", "enable"),
            )
        },
        without=(("servo_bus_1000000", "sender"), ("servo_bus_1000000", "receiver")),
        loose=("dut.tick_phase", "dut.due"),
        not_proven="what the bus reads, but that it changes as a whole; the period; other numbers of servos: "
        "the bench has them",
        mutants=(
            Mutant(
                "servo_bus_states.vhd", "told(number)    <= nor drive or known;", "told(number)    <= known;"
            ),
            Mutant("servo_bus_states.vhd", "or drive and known;", "or drive;"),
            Mutant("servo_bus_states.vhd", "if reset = '1' or stops = '1' then", "if reset = '1' then"),
            Mutant(
                "servo_bus.vhd", "elsif lost = '1' then\n            failed <= '1';", "elsif lost = '1' then"
            ),
            Mutant(
                "servo_bus.vhd",
                "if copies = '1' and keeps = '0' then",
                "if copies = '1' and keeps = '0' and known = '0' then",
            ),
            Mutant(
                "servo_bus.vhd",
                "state <= pausing;\n            if packet",
                "state <= choosing;\n            if packet",
            ),
            Mutant("servo_bus.vhd", "if good = '1' then", "if (good or lost) = '1' then"),
            Mutant("servo_bus.vhd", "if timer = gap_us then", "if timer /= gap_us then"),
        ),
    ),
)
