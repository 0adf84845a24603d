# SPDX-License-Identifier: BSD-3-Clause
"""The cases of `test_clock_true.py` for the components with a serial line."""

from __future__ import annotations

from gateware.clock_true import Case
from gateware.clock_true_words import SERVO_BUS
from gateware.modbus_line import ORDERS, replies_of_modbus
from gateware.rc_line import ppm_line, sbus_line
from gateware.serial_line import serial_line
from gateware.servo_line import replies_of_servos

SERIAL_CASES = {
    "modbus_master": (
        Case(
            "address=17, words=3, period=4 ms, baud_hz=100000, timeout=2 ms",
            {0: (*[1] * 30, 0)},
            pause=900,
            clocks=200_000,
            clock_hz=1_000_000,
            answers=replies_of_modbus,
        ),
        Case(
            "words=4, parity=0, stop_bits=2, baud_hz=57600, timeout=3 ms, failures_most=1",
            {0: (*[1] * 60, 0)},
            pause=2000,
            clocks=300_000,
            clock_hz=1_300_000,
            program=ORDERS,
            generics={"values": 3, "outputs": 1},
            answers=replies_of_modbus,
        ),
    ),
    "servo_bus": (
        Case(
            "servos=2, baud_hz=230400, cycle_hz=200, timeout_us=300, failures_most=2",
            SERVO_BUS,
            900,
            clocks=240_000,
            answers=replies_of_servos,
        ),
        Case(
            "servos=2, protocol=1, baud_hz=280000, cycle_hz=450, timeout_us=200, gap_us=7, failures_most=2",
            SERVO_BUS,
            900,
            clocks=160_000,
            answers=replies_of_servos,
        ),
        Case(
            "servos=1, protocol=1, baud_hz=57600, cycle_hz=400, timeout_us=20, gap_us=1",
            SERVO_BUS,
            300,
        ),
    ),
    "uart_bridge": (
        Case(
            "baud_hz=50000, hold=600 us, depth=4",
            {0: (0x55, 0, 0xFF), 2: (0, 0, 0, 4)},
            pause=400,
            outside=serial_line,
            clocks=60_000,
            clock_hz=400_000,
        ),
        Case(
            "baud_hz=38400, parity=1, stop_bits=2, half_duplex=1, depth=2",
            {2: (4, 0, 0, 3)},
            pause=900,
            outside=serial_line,
            clocks=40_000,
            clock_hz=400_000,
        ),
        Case("baud_hz=50000, parity=2, depth=8", pause=200, quiet=300, clock_hz=400_000),
    ),
    "rc_receiver": (
        Case(
            "timeout_ms=10, lost_us=1500",
            pause=300,
            outside=sbus_line(10.0, inverted=True),
            clocks=90_000,
            clock_hz=1_000_000,
        ),
        Case(
            "channels=3, inverted=0, timeout_ms=40",
            pause=3000,
            outside=sbus_line(14.3, inverted=False),
            clocks=90_000,
            clock_hz=1_430_000,
        ),
        Case(
            "protocol=0, channels=2, inverted=0, timeout_ms=10, filter_ns=400",
            pause=900,
            outside=ppm_line(8.3, 2),
            clocks=800_000,
            clock_hz=8_300_000,
        ),
        Case(
            "protocol=0, channels=1, timeout_ms=10, lost_us=1000, filter_ns=0",
            pause=200,
            outside=ppm_line(8.0, 1),
            clocks=500_000,
            clock_hz=8_000_000,
        ),
    ),
}
