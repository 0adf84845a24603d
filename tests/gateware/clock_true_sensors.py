# SPDX-License-Identifier: BSD-3-Clause
"""How `test_clock_true` tries sensors and LEDs with lines of their own."""

from __future__ import annotations

from gateware.clock_true import Case
from gateware.sensor_lines import conversions, echoes, thermometer

SENSOR_CASES = {
    "sonar": (
        Case("period=2 ms, timeout=300 us", {0: (*[1] * 30, 0)}, 900, answers=echoes, clocks=160_000),
        Case(
            "period=2300 us, timeout=100 us, failures_most=1",
            {0: (1,)},
            pause=300,
            answers=echoes,
            clocks=90_000,
            clock_hz=2_000_000,
        ),
    ),
    "hx711": (
        Case(
            "settle=1, timeout=300 us",
            {0: (*[1, 3, 1, 5, 7] * 4, 0)},
            900,
            answers=conversions,
            clocks=60_000,
            clock_hz=5_100_000,
        ),
        Case(
            "settle=0, failures_most=1, timeout=100 us",
            {0: (*[1] * 20, 3)},
            300,
            answers=conversions,
            clocks=40_000,
            clock_hz=4_000_000,
        ),
    ),
    "ws2812": (
        Case(
            "leds=2, reset=20 us",
            {0: (1, 1, 1, 0)},
            pause=900,
            clocks=40_000,
            clock_hz=8_200_000,
        ),
        Case("leds=1, reset=1 us", {0: (1, 1, 0)}, pause=4000, device="sk6812_rgbw", clock_hz=12_000_003),
    ),
    "one_wire": (
        Case(
            "period=114 ms, resolution=9",
            {0: (*[1] * 60, 0)},
            pause=9000,
            answers=thermometer,
            clocks=900_000,
            clock_hz=1_000_000,
        ),
        Case(
            "period=116 ms, resolution=9, parasite=1, failures_most=1",
            {0: (1,)},
            pause=20_000,
            answers=thermometer,
            clocks=600_000,
            clock_hz=1_000_000,
        ),
    ),
}
