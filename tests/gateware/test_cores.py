# SPDX-License-Identifier: BSD-3-Clause
"""The components, and what they stand on."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from unitylink.interface.components import placed_components
from unitylink.spec import compile_text
from unitylink.spec.text.imports import component_names


@pytest.mark.parametrize("stable_clocks", [1, 2, 5])
def test_input_filter(ghdl: Any, stable_clocks: int) -> None:
    ghdl.run("input_filter_tb", stable_clocks=stable_clocks)


@pytest.mark.parametrize(("pins", "stable_clocks"), [(1, 2), (8, 1), (32, 3)])
def test_gpio(ghdl: Any, pins: int, stable_clocks: int) -> None:
    ghdl.run("gpio_tb", pins=pins, stable_clocks=stable_clocks)


@pytest.mark.parametrize(("clock_hz", "frequency_hz"), [(1_000_000, 20_000), (3_333_333, 17_000)])
def test_pwm(ghdl: Any, clock_hz: int, frequency_hz: int) -> None:
    ghdl.run("pwm_tb", clock_hz=clock_hz, frequency_hz=frequency_hz)


def test_pwm_of_servos(ghdl: Any) -> None:
    ghdl.run("pwm_tb", clock_hz=1_300_000, servo=1, rounds=1)


def test_a_frequency_that_is_too_high_for_the_channels_stops_elaboration(ghdl: Any) -> None:
    ghdl.refuse(
        "pwm_tb", "3 channels need a period of more than 45 clocks", clock_hz=2_000_000, frequency_hz=50_000
    )


@pytest.mark.parametrize(
    "generics",
    [{}, {"channels": 1, "rate_hz": 4_900_000, "pulse_ns": 0, "bits": 4, "start": 16}],
    ids=["three", "one_fast"],
)
def test_pdm(ghdl: Any, generics: dict[str, int]) -> None:
    ghdl.run("pdm_tb", **generics)


def test_what_pdm_cannot_do_stops_elaboration(ghdl: Any) -> None:
    ghdl.refuse("pdm_tb", "3 channels take at least 6 clocks, and rate_hz gives 5", clock_hz=5_500_000)
    ghdl.refuse("pdm_tb", "a bit at rate_hz 1100000 is shorter than pulse_ns 910", pulse_ns=910)
    ghdl.refuse("pdm_tb", "start is at most 32768, got 32769", start=32_769)


@pytest.mark.parametrize(("kbaud", "bidirectional"), [(600, 1), (300, 0)])
def test_dshot(ghdl: Any, kbaud: int, bidirectional: int) -> None:
    ghdl.run("dshot_tb", kbaud=kbaud, bidirectional=bidirectional)


def test_more_frames_than_fit_stop_elaboration(ghdl: Any) -> None:
    ghdl.refuse("dshot_tb", "cannot have 5000 frames a second", frame_hz=5000)
    ghdl.refuse("dshot_tb", "at least 16 times the bit rate, 9600000", clock_hz=9_000_000)


@pytest.mark.parametrize(
    ("kind", "generics"),
    [
        (0, {}),
        (0, {"bits": 12, "lead_bits": 3, "tail_bits": 2, "gray": 0, "clock_hz": 12_000_000, "zero": 100}),
        (1, {"bits": 18, "gray": 0, "sclk_hz": 5_000_000}),
        (1, {"bits": 26, "gray": 0, "sclk_hz": 8_333_333}),
        (2, {"bits": 14, "gray": 0, "sclk_hz": 8_333_333}),
        (2, {"bits": 14, "gray": 0, "sclk_hz": 1_900_000, "clock_hz": 12_000_000, "zero": -5}),
    ],
)
def test_absolute_encoder(ghdl: Any, kind: int, generics: dict[str, int]) -> None:
    ghdl.run("absolute_encoder_tb", kind=kind, **generics)


def test_more_bits_than_the_chip_has_stop_elaboration(ghdl: Any) -> None:
    ghdl.refuse("absolute_encoder_tb", "a device of kind 2 has at most 14 bits, got 15", kind=2, bits=15)


@pytest.mark.parametrize(("clock_hz", "rate_hz"), [(12_000_000, 1_000_000), (2_000_001, 300_000), (7, 7)])
def test_ticker(ghdl: Any, clock_hz: int, rate_hz: int) -> None:
    ghdl.run("ticker_tb", clock_hz=clock_hz, rate_hz=rate_hz)


@pytest.mark.parametrize(("clock_hz", "settle"), [(8_000_000, 4), (4_100_003, 0)])
def test_hx711(ghdl: Any, clock_hz: int, settle: int) -> None:
    ghdl.run("hx711_tb", clock_hz=clock_hz, settle=settle)


def test_a_clock_that_is_too_slow_for_a_load_cell_stops_elaboration(ghdl: Any) -> None:
    ghdl.refuse("hx711_tb", "clock_hz must be 4 MHz or more", clock_hz=3_999_999)


@pytest.mark.parametrize(
    "generics",
    [
        {},
        {"clock_hz": 8_000_000, "leds": 1, "reset_us": 50},
        {"clock_hz": 12_000_003, "leds": 3, "channels": 4},
    ],
)
def test_ws2812(ghdl: Any, generics: dict[str, int]) -> None:
    ghdl.run("ws2812_tb", **generics)


def test_a_clock_that_is_too_slow_for_a_strip_stops_elaboration(ghdl: Any) -> None:
    ghdl.refuse("ws2812_tb", "clock_hz must be 8 to 200 MHz", clock_hz=7_999_999)


@pytest.mark.parametrize("parasite", [0, pytest.param(1, marks=pytest.mark.long)])
def test_one_wire(ghdl: Any, parasite: int) -> None:
    ghdl.run("one_wire_tb", parasite=parasite)


def test_a_period_without_time_to_convert_stops_elaboration(ghdl: Any) -> None:
    ghdl.refuse("one_wire_tb", "period_ms must be 208 or more", resolution=10, period_ms=200)


@pytest.mark.parametrize("failures_most", [1, 3])
def test_sample_state(ghdl: Any, failures_most: int) -> None:
    ghdl.run("sample_state_tb", failures_most=failures_most)


@pytest.mark.parametrize("clock_hz", [4_000_000, 12_000_003])
def test_sonar(ghdl: Any, clock_hz: int) -> None:
    ghdl.run("sonar_tb", clock_hz=clock_hz)


def test_an_echo_that_outlasts_the_period_stops_elaboration(ghdl: Any) -> None:
    ghdl.refuse("sonar_tb", "must be over within period_us", timeout_us=2000)


@pytest.mark.parametrize(
    ("stable_clocks", "generics"),
    [(2, {}), (1, {"time_hz": 4_000_000, "with_gate": 0, "with_frequency": 1})],
)
def test_pulse_counter(ghdl: Any, stable_clocks: int, generics: dict[str, int]) -> None:
    ghdl.run("pulse_counter_tb", stable_clocks=stable_clocks, **generics)


def test_a_timeout_that_does_not_fit_stops_elaboration(ghdl: Any) -> None:
    ghdl.refuse("pulse_counter_tb", "the timeout is 64 ticks to half of", timeout_ms=400, data_width=16)
    ghdl.refuse(
        "pulse_counter_tb", "with a frequency, timeout_ms is at most 500", timeout_ms=501, with_frequency=1
    )


@pytest.mark.parametrize(
    "generics",
    [
        {},
        {"clock_hz": 4_194_304, "time_hz": 2_000_000, "active_level": 0, "data_width": 28},
        {"clock_hz": 4_000_000, "time_hz": 4_000_000, "seed": 2},
    ],
)
def test_pulse_generator(ghdl: Any, generics: dict[str, int]) -> None:
    ghdl.run("pulse_generator_tb", **generics)


def test_pulses_that_the_clock_cannot_give_stop_elaboration(ghdl: Any) -> None:
    ghdl.refuse("pulse_generator_tb", "1000000 Hz needs a clock of 4 times that rate", clock_hz=3_999_999)
    ghdl.refuse("pulse_generator_tb", "time_hz is at most clock_hz, got 4700001", time_hz=4_700_001)
    ghdl.refuse("pulse_generator_tb", "a word of 27 bits is too short for maximum_hz", data_width=27)


@pytest.mark.parametrize(
    "generics",
    [
        {},
        {"parity": 0, "stop_bits": 2, "baud_hz": 57_600, "clock_hz": 1_500_000},
        pytest.param(
            {"parity": 2}, marks=pytest.mark.long
        ),  # uart_bridge has this parity with the same receiver
    ],
)
def test_modbus_master(ghdl: Any, generics: dict[str, int]) -> None:
    ghdl.run("modbus_master_tb", **generics)


def test_a_clock_that_is_too_slow_for_modbus_stops_elaboration(ghdl: Any) -> None:
    ghdl.refuse("modbus_master_tb", "a rate of 1000000 Hz is above its clock of 999999", clock_hz=999_999)


@pytest.mark.parametrize(
    "generics",
    [
        {},
        {"clock_hz": 1_000_000, "channels": 5, "inverted": 0, "lost_us": 0},
        {"protocol": 0, "channels": 3, "inverted": 0, "seed": 2},
        # test_clock_true has the other edges, too
        pytest.param(
            {"protocol": 0, "channels": 2, "inverted": 1, "clock_hz": 9_000_000}, marks=pytest.mark.long
        ),
    ],
)
def test_rc_receiver(ghdl: Any, generics: dict[str, int]) -> None:
    ghdl.run("rc_receiver_tb", **generics)


def test_a_clock_that_is_too_slow_for_a_remote_control_stops_elaboration(ghdl: Any) -> None:
    ghdl.refuse("rc_receiver_tb", "a rate of 8000000 Hz is above its clock", protocol=0, clock_hz=7_999_999)
    ghdl.refuse("rc_receiver_tb", "a rate of 1000000 Hz is above its clock of 999999", clock_hz=999_999)


@pytest.mark.parametrize(
    ("clock_hz", "modulator_hz", "osr"), [(50_000_000, 10_000_000, 64), (48_000_000, 12_000_000, 40)]
)
def test_sigma_delta_adc(ghdl: Any, clock_hz: int, modulator_hz: int, osr: int) -> None:
    ghdl.run("sigma_delta_adc_tb", clock_hz=clock_hz, modulator_hz=modulator_hz, osr=osr)


@pytest.mark.parametrize(
    ("protocol", "clock_hz", "baud_hz"), [(0, 16_000_000, 2_000_000), (1, 12_000_000, 1_000_000)]
)
def test_servo_bus(ghdl: Any, protocol: int, clock_hz: int, baud_hz: int) -> None:
    ghdl.run("servo_bus_tb", protocol=protocol, clock_hz=clock_hz, baud_hz=baud_hz)


def test_a_clock_that_is_too_slow_for_the_bus_of_servos_stops_elaboration(ghdl: Any) -> None:
    ghdl.refuse("servo_bus_tb", "a bit needs 8 clocks or more; 2000000 baud", clock_hz=15_000_000)


@pytest.mark.parametrize(
    "generics",
    [
        {},
        {"parity": 1, "half_duplex": 1, "hold_us": 0},
        {"clock_hz": 9_000_000, "baud_hz": 1_000_000, "parity": 2, "stop_bits": 2},
    ],
)
def test_uart_bridge(ghdl: Any, generics: dict[str, int]) -> None:
    ghdl.run("uart_bridge_tb", **generics)


def test_a_clock_that_is_too_slow_for_the_line_stops_elaboration(ghdl: Any) -> None:
    ghdl.refuse("uart_bridge_tb", "500000 baud needs a clock of 500000 * 8 Hz", clock_hz=3_900_000)


@pytest.mark.parametrize(("clock_hz", "fault_level"), [(50_000_000, 1), (12_000_000, 0)])
def test_bridge_gates(ghdl: Any, clock_hz: int, fault_level: int) -> None:
    ghdl.run("bridge_gates_tb", clock_hz=clock_hz, fault_level=fault_level)


@pytest.mark.parametrize(("clock_hz", "fault_level"), [(10_000_000, 1), (7_300_000, 0)])
def test_three_phase_pwm(ghdl: Any, clock_hz: int, fault_level: int) -> None:
    ghdl.run("three_phase_pwm_tb", clock_hz=clock_hz, fault_level=fault_level)


@pytest.mark.parametrize(("pole_pairs", "seed"), [(7, 1), pytest.param(1, 2, marks=pytest.mark.long)])
def test_foc(ghdl: Any, pole_pairs: int, seed: int) -> None:
    ghdl.run("foc_tb", pole_pairs=pole_pairs, seed=seed)


def test_a_period_that_is_too_short_for_the_sums_stops_elaboration(ghdl: Any) -> None:
    ghdl.refuse("foc_tb", "a period is at least 384 clocks", period=383)


@pytest.mark.parametrize("closed_level", [0, 1])
def test_estop(ghdl: Any, closed_level: int) -> None:
    ghdl.run("estop_tb", closed_level=closed_level)


@pytest.mark.parametrize("with_velocity", [0, 1])
def test_hall(ghdl: Any, with_velocity: int) -> None:
    ghdl.run("hall_tb", with_velocity=with_velocity)


@pytest.mark.parametrize("coast", [0, 1])
def test_h_bridge(ghdl: Any, coast: int) -> None:
    ghdl.run("h_bridge_tb", coast=coast)


@pytest.mark.parametrize(("data_width", "stable_clocks", "extras"), [(32, 1, 1), (32, 2, 0), (16, 5, 1)])
def test_quadrature_encoder(ghdl: Any, data_width: int, stable_clocks: int, extras: int) -> None:
    ghdl.run(
        "quadrature_encoder_tb",
        data_width=data_width,
        stable_clocks=stable_clocks,
        with_index=extras,
        with_stamps=extras,
    )


@pytest.mark.parametrize(("channels", "filter_ns", "data_width"), [(6, 0, 32), (3, 300, 16)])
def test_encoder_bank(ghdl: Any, channels: int, filter_ns: int, data_width: int) -> None:
    ghdl.run("encoder_bank_tb", channels=channels, filter_ns=filter_ns, data_width=data_width)


@pytest.mark.long
def test_encoder_bank_of_32(ghdl: Any) -> None:
    ghdl.run("encoder_bank_tb", channels=32, seed=2)


@pytest.mark.parametrize(("active_level", "seed"), [(1, 1), (0, 2)])
def test_position_compare(ghdl: Any, active_level: int, seed: int) -> None:
    ghdl.run("position_compare_tb", active_level=active_level, seed=seed)


def test_quadrature_encoder_velocity(ghdl: Any) -> None:
    ghdl.run("quadrature_encoder_velocity_tb")


def test_pid(ghdl: Any) -> None:
    ghdl.run("pid_tb")


def test_motion_profile(ghdl: Any) -> None:
    ghdl.run("motion_profile_tb")


def test_stepgen(ghdl: Any) -> None:
    ghdl.run("stepgen_tb")


@pytest.mark.long
@pytest.mark.parametrize(("axes", "clock_mhz", "seed"), [(1, 8, 2), (3, 20, 3), (4, 25, 4)])
def test_stepgen_for_long(ghdl: Any, axes: int, clock_mhz: int, seed: int) -> None:
    ghdl.run("stepgen_tb", axes=axes, clock_hz=clock_mhz * 1_000_000, seed=seed, rounds=20)


@pytest.mark.parametrize(("axes", "clock_hz"), [(2, 11_000_000), (4, 5_000_000)])
def test_a_clock_that_is_too_slow_for_stepgen_stops_elaboration(ghdl: Any, axes: int, clock_hz: int) -> None:
    ghdl.refuse("stepgen_tb", "is too slow for", axes=axes, clock_hz=clock_hz)


@pytest.mark.parametrize(("data_width", "depth", "seed"), [(32, 8, 1), (32, 2, 2), (16, 32, 3), (8, 4, 4)])
def test_fifo_slave(ghdl: Any, data_width: int, depth: int, seed: int) -> None:
    ghdl.run("fifo_slave_tb", data_width=data_width, depth=depth, seed=seed)


def test_a_depth_the_word_cannot_count_stops_elaboration(ghdl: Any) -> None:
    ghdl.refuse("fifo_slave_tb", "does not fit a word of 8 bits", data_width=8, depth=256)


NETLISTS = {
    "gpio": {"stable_clocks": 1},
    "quadrature_encoder": {"with_index": 0, "with_stamps": 0},
}  # generics that differ from the bench's
OTHERS = [
    name
    for name in (*component_names(), "fifo_slave", "input_filter", "bridge_gates")
    if name not in NETLISTS
]


@pytest.mark.parametrize(("entity", "generics"), NETLISTS.items())
def test_netlist(ghdl: Any, tmp_path: Path, entity: str, generics: dict[str, int]) -> None:
    ghdl.run_netlist(entity, tmp_path, **generics)


@pytest.mark.parametrize("entity", OTHERS)
def test_synthesis(ghdl: Any, entity: str) -> None:
    assert f"entity {entity} is" in ghdl.synthesise(entity)


def device_program(text: str) -> str:
    """Return the program of the one device in a spec."""
    spec = compile_text(f"link l(ADDRESS=8); public a() {{ one: {text}; }}").spec
    assert spec is not None
    (component,) = placed_components(spec)
    return str(dict(component.generics)["program"])


@pytest.mark.parametrize(("mode", "sclk_hz"), [(0, 5_000_000), (1, 5_000_000), (2, 1_700_000), (3, 900_000)])
def test_spi_master(ghdl: Any, mode: int, sclk_hz: int) -> None:
    ghdl.run("spi_master_tb", mode=mode, sclk_hz=sclk_hz)


@pytest.mark.parametrize("seed", [1, 2])
def test_bus_sequencer(ghdl: Any, seed: int) -> None:
    ghdl.run("bus_sequencer_tb", seed=seed)


@pytest.mark.parametrize(
    ("clock_hz", "sclk_hz", "mode", "data_width"),
    [(16_000_000, 1_700_000, 3, 32), (8_000_000, 24_000_000, 0, 16)],
)
def test_spi_device(ghdl: Any, clock_hz: int, sclk_hz: int, mode: int, data_width: int) -> None:
    program = device_program("icm42688(period=300 us, start=250 us)")
    given = {"clock_hz": clock_hz, "sclk_hz": sclk_hz, "mode": mode, "data_width": data_width}
    ghdl.run("spi_device_tb", program=program, **given)


@pytest.mark.parametrize("clock_hz", [8_000_000, pytest.param(13_000_000, marks=pytest.mark.long)])
def test_i2c_device(ghdl: Any, clock_hz: int) -> None:
    ghdl.run("i2c_device_tb", program=device_program("mpu6050(start=200 us)"), clock_hz=clock_hz)
