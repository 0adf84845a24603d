# SPDX-License-Identifier: BSD-3-Clause
"""What each component is played with, beside its VHDL, in test_clock_true.py."""

from __future__ import annotations

from gateware.absolute_encoder_line import frames_of_as5047p, frames_of_biss
from gateware.clock_true import Case
from gateware.clock_true_sensors import SENSOR_CASES
from gateware.clock_true_serial import SERIAL_CASES
from gateware.clock_true_words import (
    ABSOLUTE_ENCODER,
    CHECKED,
    COMPARE,
    FOC,
    FOC_START,
    FOC_WIRES,
    GENERATOR,
    H_BRIDGE,
    PID,
    PROFILE,
    PULSES,
    SHAFT,
    SHORT,
    THREE_PHASE,
    stepgen_start,
    stepgen_values,
)
from gateware.dshot_line import replies_of_dshot
from gateware.hall_lines import hall_lines
from gateware.random_wires import random_wires

CASES = {
    **SENSOR_CASES,
    **SERIAL_CASES,
    "stepgen": (
        Case(
            "axes=2",
            stepgen_values(2),
            90,
            3000,
            start=70,
            slow=40,
            first=stepgen_start(2),
            still=(6,),
            clocks=60_000,
            clock_hz=12_000_003,
        ),
        Case(
            "axes=1, step_len_ns=1900, step_space_ns=990, dir_setup_ns=650, dir_hold_ns=650, stable_clocks=3",
            stepgen_values(1),
            300,
            9000,
            start=70,
            slow=40,
            first=stepgen_start(1),
            still=(3,),
            clocks=60_000,
            clock_hz=8_000_000,
        ),
        Case(
            "axes=5",
            stepgen_values(5),
            900,
            9000,
            start=140,
            slow=40,
            first=stepgen_start(5),
            still=range(16),
            clocks=90_000,
            clock_hz=48_000_000,
        ),
        # a base rate of 2**23 Hz would leave no room for the carry of a phase
        Case(
            "axes=1",
            stepgen_values(1),
            900,
            start=70,
            slow=40,
            first=stepgen_start(1),
            still=range(4),
            clocks=90_000,
            clock_hz=100_000_000,
        ),
    ),
    "gpio": (
        Case("pins=8"),
        Case("pins=1, stable_clocks=3", pause=2000),
        Case("pins=32, stable_clocks=2"),
    ),
    "pwm": (
        Case(
            "channels=3, frequency_hz=40000",
            {0: (0, 1, 1, 1, 1, 3)} | dict.fromkeys((2, 3, 4), (0, 1, 70, 2048, 4000, 4095, 4096, 4097)),
            pause=300,
            start=8,
        ),
        Case("channels=1, frequency_hz=143750", {0: (0, 1, 1, 1), 2: (0, 1, 256, 257, 4096)}, start=4),
        Case(
            "channels=2, minimum=1 us, maximum=9 us",
            {0: (0, 1, 1, 1, 1, 1, 1)} | dict.fromkeys((2, 3), (0, 1, 5, 9, 400)),
            pause=900,
            start=4,
            device="rc_servo",
        ),
    ),
    "pdm": (
        Case(
            "channels=3, rate_hz=230000, start=9000",
            dict.fromkeys(range(3), (0, 1, 900, 16384, 30000, 32767, 32768, 32769, 65535)),
            pause=300,
            start=8,
        ),
        Case("channels=1, rate_hz=2200000, bits=4", {0: (0, 1, 5, 8, 15, 16, 17, 31)}, start=8),
        Case(
            "channels=8, rate_hz=100000, bits=16, start=65536",
            dict.fromkeys(range(8), (0, 700, 32768, 65535, 65536, 65537)),
            pause=900,
            start=8,
        ),
    ),
    "three_phase_pwm": (
        Case(
            "frequency_hz=100000, duty_bits=6, dead_minimum_ns=900",
            THREE_PHASE,
            slow=4,
            start=6,
            pause=300,
            outside=random_wires(3, 900, pins=1),
        ),
        Case(
            "frequency_hz=3000, duty_bits=9, dead_minimum_ns=0, fault_level=0",
            THREE_PHASE,
            slow=4,
            start=6,
            pause=90,
            outside=random_wires(3, 4000, pins=1, high=0.9),
        ),
        Case(
            "frequency_hz=9000, duty_bits=7, dead_minimum_ns=900",
            THREE_PHASE,
            slow=4,
            start=6,
            pause=300,
            outside=random_wires(3, 900, pins=1),
        ),
    ),
    "estop": (
        Case("inputs=2, filter=5 us", {0: (0, 1, 1)}, pause=300, quiet=900, rest=1),
        Case(
            "inputs=1, closed_level=0, filter=0 us, watchdog=1 ms",
            {0: (0, 1)},
            pause=6000,
            quiet=20_000,
            rest=0,
            clocks=200_000,
        ),
        Case("inputs=16, filter=3 us, watchdog=2 ms", {0: (0, 1)}, pause=1500, quiet=9000, rest=1),
    ),
    "hall": (
        Case(
            "filter_ns=0, with_velocity=1, velocity_us=120, stall_us=260", outside=hall_lines, clocks=60_000
        ),
        Case("filter_ns=1500", outside=hall_lines, clocks=500_000, pause=400),
    ),
    "h_bridge": (
        Case("frequency_hz=40000, duty_bits=6, dead_minimum_ns=900", H_BRIDGE, pause=300, quiet=3000),
        Case("frequency_hz=9000, duty_bits=9, form=1", H_BRIDGE, pause=90, quiet=9000),
        Case("frequency_hz=9000, duty_bits=9, form=2, fault_level=0", H_BRIDGE, pause=900, quiet=9000),
    ),
    "dshot": (
        Case(
            "channels=2, kbaud=100, frame_hz=2500, command_frames=2",
            {k: v for n in (0, 4) for k, v in ((n, (0, 0, 0, 1, 2000, 2047)), (n + 1, (0, 1, 47, 48)))},
            pause=400,
        ),
        Case(
            "channels=2, kbaud=100, frame_hz=1100, bidirectional=1, failures_most=3",
            {0: (0, 0, 0, 700), 1: (0, 12)},
            pause=90,
            outside=replies_of_dshot,
        ),
        Case("channels=1, kbaud=120, frame_hz=1500, bidirectional=1", pause=200, quiet=400),
    ),
    "i2c_device": (
        Case(values={0: (0, *[1] * 30)}, pause=1200, quiet=2, program=SHORT),
        Case("scl_hz=100000, stretch_us=100, period=300 us, failures_most=2", {0: (1,)}, 200, 900),
        Case("start=100 us", {0: (1,)}, 300, 5, device="mpu6050"),
    ),
    "spi_device": (
        Case(
            'words=3, bytes=2, order="little", period=700 us, sclk_hz=300000, mode=1',
            {0: (0, 1, 1, 1, 1)},
            pause=900,
        ),
        Case("command=0x85, words=5, bytes=4, period=1 ms, sclk_hz=9000000, mode=2", {0: (1,)}, quiet=9),
        Case("period=900 us, sclk_hz=250000, start=100 us", {0: (1,)}, 300, 1500, device="icm42688"),
        Case("failures_most=2", {0: (0, *[1] * 30)}, 300, 9000, program=CHECKED),
    ),
    "pid": (
        Case("feedback=from.position, output=to.duty, loop_hz=17000", PID, pause=200, quiet=2000),
        Case(
            "feedback=from.position, output=to.duty, loop_hz=9000, filter_bits=0, safe=-7",
            PID,
            pause=30,
            quiet=9000,
        ),
        Case(
            "feedback=from.position, output=other.target, filter_bits=8, loop_hz=3000",
            PID,
            pause=90,
            quiet=9000,
        ),
    ),
    "foc": (
        Case(
            f"{FOC_WIRES}, pole_pairs=7, angle_bits=14, loop_hz=5900",
            FOC,
            pause=300,
            outside=random_wires(4, 400),
            first=FOC_START,
            clocks=60_000,
        ),
        Case(
            f"{FOC_WIRES}, pole_pairs=63, angle_bits=4, loop_hz=3000, current_shift=0",
            FOC,
            pause=90,
            outside=random_wires(4, 900, lost=0.1),
            first=FOC_START,
            clocks=40_000,
        ),
    ),
    "motion_profile": (
        Case(
            "feedback=from.position, output=other.target, loop_hz=2000000",
            PROFILE,
            pause=3000,
            quiet=2000,
            first={0: 1, 3: 1 << 26, 4: 1 << 22},
            still=range(9, 32),
            clocks=60_000,
            clock_hz=50_000_000,
        ),
        Case(
            "from.position, other.target, other.target_velocity, other.target_acceleration, loop_hz=380000, "
            "smooth_bits=3",
            PROFILE,
            pause=9000,
            quiet=900,
            first={0: 1, 3: 1 << 26, 4: 1 << 22},
            still=range(9, 32),
            clocks=160_000,
            clock_hz=50_000_000,
        ),
    ),
    "absolute_encoder": (
        Case(
            "bits=5, lead_bits=2, tail_bits=1, sclk_hz=300000, sample_hz=9000, pause_us=5, failures_most=2",
            ABSOLUTE_ENCODER,
            pause=90,
            quiet=400,
        ),
        Case(
            "bits=9, sclk_hz=300000, sample_hz=7000, pause_us=10, zero=300",
            ABSOLUTE_ENCODER,
            pause=300,
            outside=frames_of_biss,
            device="biss_encoder",
            clocks=40_000,
        ),
        Case(
            "sclk_hz=300000, sample_hz=7000, zero=-70000",
            ABSOLUTE_ENCODER,
            pause=60,
            outside=frames_of_as5047p,
            device="as5047p",
            clocks=60_000,
        ),
    ),
    "sigma_delta_adc": (
        Case(
            "modulator_hz=500000, osr=8, trip_osr=4",
            {0: (0, 1, 1, 1, 1), 2: (0, 0, 32, 32), 4: (0, 0, 30), 5: (0, 0, -9 & 0xFFFFFFFF)},
            quiet=900,
        ),
        Case(
            "channels=3, modulator_hz=1000000, osr=10", {0: (0, 1, 1), 2: (0, 0, 200)}, pause=300, quiet=300
        ),
        Case("channels=1, modulator_hz=290000, osr=12, trip_osr=12", {0: (0, 1, 1), 2: (0,)}, 90, 2000),
    ),
    "pulse_counter": (
        Case("filter_ns=800, time_hz=100000, timeout_ms=1", PULSES, 200, 4000, wait=34, clocks=60_000),
        Case("filter_ns=0, time_hz=2300000, timeout_ms=1, with_gate=1", PULSES, 900, 200, wait=34),
        Case(
            "filter_ns=0, time_hz=1000000, timeout_ms=1, with_frequency=1, frequency_us=180",
            PULSES,
            pause=300,
            quiet=2000,
            wait=34,
        ),
    ),
    "pulse_generator": (
        Case("maximum_hz=500000, time_hz=500000, filter_ns=800", GENERATOR, 200, 900, still=(1,)),
        Case("maximum_hz=575000, time_hz=2300000, active_level=0, filter_ns=0", GENERATOR, 90, 4000, rest=0),
        Case("maximum_hz=20000, time_hz=1000, filter_ns=0", GENERATOR, 90, 3000, still=(1,)),
    ),
    "encoder_bank": (
        Case("channels=3", {3: (0,)}, pause=90, wait=18),
        Case("channels=2, filter_ns=2000", pause=40, quiet=30, wait=10),
        Case("channels=9, filter_ns=2000", pause=900, quiet=900, wait=66, clocks=40_000, clock_hz=50_000_000),
    ),
    "position_compare": (
        Case("position=from.position, pulse_ns=2000", COMPARE, 90, outside=random_wires(1, 60)),
        Case(
            "position=from.position, pulse_ns=9000, active_level=0",
            COMPARE,
            pause=2000,
            outside=random_wires(1, 90, lost=0.1),
        ),
    ),
    "quadrature_encoder": (
        Case("filter_ns=800, with_index=1, with_stamps=1", {3: (0,)}, wait=34),
        Case("filter_ns=0, with_index=1", pause=2000, wait=34),
        Case("filter_ns=2000", wait=34),
        Case("with_index=1", pause=5, quiet=400, wait=34),
        Case("filter_ns=0, with_velocity=1, velocity_us=107, stall_us=220", wait=34, shaft=SHAFT),
        Case("filter_ns=800, with_velocity=1, velocity_us=130, stall_us=300", pause=20, quiet=900, wait=34),
        Case("filter_ns=0, with_velocity=1, velocity_us=127, stall_us=260", pause=5, wait=34, shaft=SHAFT),
    ),
}
