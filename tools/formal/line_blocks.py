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
        not_proven="Dynamixel, with its CRC and its stuffed bytes: the bench has it",
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
)
