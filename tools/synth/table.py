# SPDX-License-Identifier: BSD-3-Clause
"""The rows to measure, one for each configuration, with the limits of the project."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

SEEDS = (1, 2, 3)  # of placements


@dataclass(frozen=True)
class Row:
    """One configuration: the core with its settings, another entity, or the top level of an example."""

    name: str
    what: str
    top: str = "core"
    settings: Mapping[str, int | str | bool] = field(default_factory=dict)  # settings that differ from SMALL
    example: str = ""  # the folder in examples/ with the spec of its generated design
    protocol: str = "classic"  # protocol of that design; a core has it among its settings
    engine: str = "fast"  # engine of the framed protocol in a core
    chips: tuple[str, ...] = ("ice40", "ecp5")
    seeds: tuple[int, ...] = SEEDS
    cells_most: int | None = None  # on iCE40
    mhz_least: float | None = None  # on iCE40, the median over the seeds
    memories_most: int | None = None  # on iCE40
    ecp5_mhz_least: float | None = None


# The common settings of the core's rows, because the goals of the project are for a small core.
SMALL: Mapping[str, int | str | bool] = {
    "protocol": "classic",
    "groups": 2,
    "group_size": 16,
    "read_many": 32,
    "exchange_size": 16,
}

# The default settings of a spec, framed. The remedies of unitylink.boards.fit are measured on it.
SHIPPED = {**SMALL, "protocol": "framed", "groups": 4, "group_size": 32, "exchange_size": 30}

# The core without the features that the small engine lacks.
SMALL_ENGINE = {
    "protocol": "framed",
    "publish_mode": 0,
    "lists": False,
    "exchanges": 0,
    "window": 8,
}

SMALL_GROUPS = {"publish_mode": 2, "groups": 2, "group_size": 16}


def _smaller(name: str, what: str, **settings: int | bool) -> Row:
    """Return a row that is measured only for its cells. It is placed once, on one chip."""
    changed = {**SHIPPED, **settings}
    return Row(name, f"`shipped` {what}", settings=changed, chips=("ice40",), seeds=SEEDS[:1])


ROWS = (
    Row("core", "8-bit address, 32-bit data, two groups of 16", cells_most=1100, mhz_least=99.0),
    Row("no_publishing", "the same without publishing", settings={"publish_mode": 0}, cells_most=700),
    Row("groups_16", "16 groups of 16", settings={"groups": 16}),
    Row("no_checksum", "checksum none", settings={"checksum": "none"}),
    Row("lite", "datalink lite", settings={"datalink": "lite"}),
    Row("none", "datalink none", settings={"datalink": "none"}),
    Row("address_16", "16-bit address", settings={"address_bits": 16}, memories_most=12),
    Row("data_8", "8-bit data", settings={"data_bits": 8}),
    Row(
        "smallest",
        "datalink lite, no publishing, no read-many, no configuration",
        settings={"datalink": "lite", "publish_mode": 0, "read_many": 0, "configuration_command": False},
    ),
    Row(
        "framed_minimal",
        "framed: reads, writes, posts, registers; no publishing, lists, exchange groups, dead-man",
        settings={
            "protocol": "framed",
            "publish_mode": 0,
            "lists": False,
            "exchanges": 0,
            "deadman": False,
        },
        cells_most=1400,
        mhz_least=100.0,
        ecp5_mhz_least=118.0,
    ),
    Row(
        "small_minimal",
        "`framed_minimal` with the small engine",
        settings={**SMALL_ENGINE, "deadman": False},
        engine="small",
        cells_most=600,
        mhz_least=100.0,
        memories_most=5,
    ),
    Row(
        "small",
        "the same with the dead-man",
        settings=SMALL_ENGINE,
        engine="small",
    ),
    Row(
        "small_publishing_minimal",
        "`small_minimal` with publishing: two groups of 16",
        settings={**SMALL_ENGINE, **SMALL_GROUPS, "deadman": False},
        engine="small",
        cells_most=900,
        mhz_least=100.0,
    ),
    Row(
        "small_publishing",
        "the same with the dead-man and four groups: all that the small engine has",
        settings={**SMALL_ENGINE, **SMALL_GROUPS, "groups": 4},
        engine="small",
        cells_most=900,
    ),
    Row(
        "framed",
        "framed alone, with all features",
        settings={"protocol": "framed"},
        mhz_least=76.0,
        ecp5_mhz_least=98.0,
    ),
    Row(
        "shipped",
        "framed as it is generated for a spec of one or two groups: 4 groups of 32, exchange groups of 30",
        settings=SHIPPED,
        chips=("ice40",),
        seeds=SEEDS[:1],
    ),
    _smaller("no_lists", "without lists", lists=False),
    _smaller("no_exchanges", "without exchange groups", exchanges=0),
    _smaller("groups_2", "with two groups", groups=2),
    _smaller("window_16", "with a window of 16 requests", window=16),
    Row(
        "hello_led",
        "a complete design, classic: UART, FIFOs, core, registers (examples/hello_led)",
        top="hello_led_top",
        example="hello_led",
    ),
    Row(
        "hello_led_framed",
        "the same, framed",
        top="hello_led_top",
        example="hello_led",
        protocol="framed",
        chips=("ice40",),
        seeds=SEEDS[:1],
    ),
    # Both together need more block RAM than an iCE40 has.
    Row(
        "hello_led_both",
        "the same, both protocols",
        top="hello_led_top",
        example="hello_led",
        protocol="both",
        chips=("ecp5",),
        seeds=SEEDS[:1],
    ),
    Row(
        "servo",
        "a complete design, classic: the same with PWM, encoder and an event (examples/servo)",
        top="servo_top",
        example="servo",
    ),
    Row(
        "scara",
        "a complete design, framed: the SCARA of the paper with its TosNet, placed once (examples/scara)",
        top="narrow_scara_top",
        example="scara",
        protocol="framed",
        seeds=SEEDS[:1],
    ),
    # Both together need more block RAM than an iCE40 has.
    Row(
        "scara_both",
        "the same, both protocols",
        top="narrow_scara_top",
        example="scara",
        protocol="both",
        chips=("ecp5",),
        seeds=SEEDS[:1],
    ),
    Row(
        "wishbone_master",
        "the bus: from the application to Wishbone, addresses of 8 bits",
        top="narrow_wishbone_master",
        seeds=SEEDS[:1],
    ),
    Row(
        "axi_lite_master",
        "the same: to AXI4-Lite",
        top="narrow_axi_lite_master",
        seeds=SEEDS[:1],
    ),
    Row(
        "register_slave",
        "the same: a slave with a word to the PC and a word from it",
        top="narrow_register_slave",
        seeds=SEEDS[:1],
    ),
    Row("wishbone_memory", "the same: a memory of 256 words", top="wishbone_memory", seeds=SEEDS[:1]),
    Row("fifo_slave", "the same: a FIFO of 16 words each way", top="fifo_slave", seeds=SEEDS[:1]),
    Row(
        "double_buffer_slave",
        "the same: a table of 16 words with a commit",
        top="double_buffer_slave",
        seeds=SEEDS[:1],
    ),
    Row("interrupt_slave", "the same: interrupts of eight lines", top="interrupt_slave", seeds=SEEDS[:1]),
    Row(
        "axi_lite_slave",
        "the same: AXI4-Lite to Wishbone",
        top="narrow_axi_lite_slave",
        seeds=SEEDS[:1],
    ),
    Row(
        "wishbone_arbiter",
        "the same: two masters share a Wishbone",
        top="narrow_wishbone_arbiter",
        seeds=SEEDS[:1],
    ),
    Row(
        "wishbone_crossing",
        "the same: a Wishbone from one clock to another",
        top="narrow_wishbone_crossing",
        seeds=SEEDS[:1],
    ),
    Row("uart", "a physical layer alone: UART with its buffers of 16 bytes", top="uart"),
    Row("ft245_async", "the same: FT245, asynchronous, buffers of 16 bytes", top="ft245_async"),
    Row(
        "ft245_sync",
        "the same: FT245, synchronous, buffers of 64 bytes between two clocks",
        top="ft245_sync",
    ),
    Row("spi_slave", "the same: SPI slave, buffers of 64 bytes", top="spi_slave"),
    Row("rs485", "the same: RS-485 node, buffers of 64 and 256 bytes", top="rs485"),
    Row(
        "stepgen",
        "a component: step and direction with ramps, four axes",
        top="stepgen",
        cells_most=1000,
        mhz_least=50.0,
        memories_most=6,
        ecp5_mhz_least=100.0,
    ),
    Row(
        "quadrature_encoder",
        "a component: one incremental encoder without index and stamps",
        top="narrow_quadrature_encoder",
        cells_most=160,
        mhz_least=50.0,
        memories_most=4,
    ),
    Row(
        "encoder_bank",
        "a component: eight incremental encoders that share an adder, at most 40 cells each",
        top="encoder_bank",
        cells_most=320,
        mhz_least=50.0,
        memories_most=6,
        ecp5_mhz_least=100.0,
    ),
    Row(
        "position_compare",
        "a component: a pulse at each place of a row of positions",
        top="position_compare",
        mhz_least=50.0,
        ecp5_mhz_least=100.0,
    ),
    Row(
        "pulse_counter",
        "a component: counts and times the pulses of a line, without a frequency",
        top="narrow_pulse_counter",
        mhz_least=50.0,
        ecp5_mhz_least=100.0,
    ),
    Row(
        "modbus_master",
        "a component: reads a register over Modbus, by a table",
        top="modbus_master",
        mhz_least=50.0,
        ecp5_mhz_least=100.0,
    ),
    Row(
        "rc_receiver",
        "a component: the 16 channels of a remote control with S.Bus",
        top="rc_receiver",
        mhz_least=50.0,
    ),
    Row(
        "pulse_generator",
        "a component: pulses of an exact rate and width on a line",
        top="pulse_generator",
        mhz_least=50.0,
    ),
    Row(
        "pwm",
        "a component: four channels of PWM at 20 kHz",
        top="pwm",
        cells_most=240,
        mhz_least=50.0,
        memories_most=2,
    ),
    Row(
        "spi_device",
        "a component: sets a device on SPI up and reads it, by a table",
        top="spi_device",
        cells_most=440,
        mhz_least=50.0,
        memories_most=5,
        ecp5_mhz_least=100.0,
    ),
    Row(
        "three_phase_pwm",
        "a component: three phases with dead time and fault input, at 20 kHz",
        top="narrow_three_phase_pwm",
        cells_most=410,
        mhz_least=50.0,
    ),
    Row(
        "dshot",
        "a component: four speed controllers with DShot, without replies",
        top="dshot",
        mhz_least=50.0,
        ecp5_mhz_least=100.0,
    ),
    Row(
        "absolute_encoder",
        "a component: an absolute encoder of 13 bits with SSI, in Gray code",
        top="absolute_encoder",
        cells_most=720,
        mhz_least=50.0,
    ),
    Row(
        "servo_bus",
        "a component: six servos of Dynamixel on one line",
        top="servo_bus",
        mhz_least=50.0,
        ecp5_mhz_least=100.0,
    ),
    Row(
        "uart_bridge",
        "a component: a serial line with queues of 64 bytes",
        top="uart_bridge",
        mhz_least=50.0,
        memories_most=2,
    ),
    Row(
        "sonar",
        "a component: a distance sensor with trigger and echo",
        top="sonar",
        cells_most=195,
        mhz_least=50.0,
    ),
    Row(
        "hx711",
        "a component: a load cell behind an HX711",
        top="hx711",
        cells_most=250,
        mhz_least=50.0,
    ),
    Row(
        "ws2812",
        "a component: a strip of 60 LEDs",
        top="ws2812",
        cells_most=175,  # the pause after a reset cost 16
        mhz_least=50.0,
        memories_most=2,
    ),
    Row(
        "one_wire",
        "a component: a thermometer on 1-wire",
        top="one_wire",
        cells_most=310,  # a block holds its sample back
        mhz_least=50.0,
    ),
    Row(
        "estop",
        "a component: a stop chain of one contact, without a watchdog",
        top="estop",
        cells_most=80,
        mhz_least=50.0,
    ),
    Row(
        "h_bridge",
        "a component: a DC motor behind four gates, at 20 kHz",
        top="narrow_h_bridge",
        cells_most=300,
        mhz_least=50.0,
    ),
    Row(
        "tosnet_joint",
        "a node of a TosNet ring as a joint has it: never master, at most five nodes, no messages",
        top="narrow_tosnet_joint",
        cells_most=900,
        mhz_least=50.0,
        memories_most=8,
    ),
    Row(
        "tosnet_node",
        "the same with all features: may be master, 15 nodes, messages",
        top="narrow_tosnet_node",
        mhz_least=50.0,
    ),
    Row("gpio", "a component: eight pins", top="gpio", seeds=SEEDS[:1]),
    Row(
        "i2c_device",
        "a component: sets a device on I2C up and reads it, by a table",
        top="i2c_device",
        mhz_least=50.0,
        ecp5_mhz_least=100.0,
    ),
    Row(
        "pid",
        "a component: a control loop between wires",
        top="narrow_pid",
        mhz_least=50.0,
        ecp5_mhz_least=100.0,
    ),
    Row(
        "foc",
        "a component: the current loop of a brushless motor",
        top="narrow_foc",
        mhz_least=50.0,
        ecp5_mhz_least=100.0,
    ),
    Row(
        "sigma_delta_adc",
        "a component: two channels of sinc3 behind sigma-delta modulators, with trips",
        top="narrow_sigma_delta_adc",
        mhz_least=50.0,
    ),
    Row(
        "hall",
        "a component: the Hall sensors of a brushless motor, without the velocity",
        top="narrow_hall",
        mhz_least=50.0,
    ),
    Row(
        "quadrature_encoder_velocity",
        "a part of a component: the velocity of an encoder, or of Hall sensors",
        top="quadrature_encoder_velocity",
        mhz_least=50.0,
        ecp5_mhz_least=100.0,
    ),
)
