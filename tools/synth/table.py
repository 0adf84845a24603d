# SPDX-License-Identifier: BSD-3-Clause
"""The rows to measure, one for each configuration, with the limits of the project."""

from __future__ import annotations

from collections.abc import Mapping

from component_rows import COMPONENT_ROWS
from row import SEEDS, Row

# The common settings of the core's rows, because the goals of the project are for a small core.
SMALL: Mapping[str, int | str | bool] = {
    "protocol": "classic",
    "groups": 2,
    "group_size": 16,
    "read_many": 32,
    "exchange_size": 16,
}

# This placer of nextpnr puts registers nearer to their block RAM than the default one.
STATIC = ("--placer", "static")

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


# A limit on the clock is a goal of the project, or about the slowest seed of a row that has no such goal.
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
        ecp5_mhz_least=130.0,
        ecp5_options=STATIC,
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
        mhz_least=97.0,
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
        mhz_least=90.0,
    ),
    Row(
        "framed",
        "framed alone, with all features",
        settings={"protocol": "framed"},
        mhz_least=73.0,
        ecp5_mhz_least=93.0,
        ecp5_options=STATIC,
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
    *COMPONENT_ROWS,
)
