# SPDX-License-Identifier: BSD-3-Clause
"""What is measured: a row a configuration, and the limits of the project."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Row:
    """One configuration: the core with its settings, another entity, or the top level of an example."""

    name: str
    what: str
    top: str = "core"
    settings: Mapping[str, int | str | bool] = field(default_factory=dict)  # that differ from SMALL
    example: str = ""  # the folder in examples/ whose generated design it is, classic
    cells_most: int | None = None  # on iCE40
    mhz_least: float | None = None  # on iCE40, the median of the seeds


# What the rows of the core have in common: the figures of the project are those of a small core.
SMALL: Mapping[str, int | str | bool] = {
    "protocol": "classic",
    "groups": 2,
    "group_size": 16,
    "read_many": 32,
    "exchange_size": 16,
}

ROWS = (
    Row("core", "8-bit address, 32-bit data, two groups of 16", cells_most=1100, mhz_least=100.0),
    Row("no_publishing", "the same without publishing", settings={"publish_mode": 0}, cells_most=700),
    Row("groups_16", "16 groups of 16", settings={"groups": 16}),
    Row("no_checksum", "checksum none", settings={"checksum": "none"}),
    Row("lite", "datalink lite", settings={"datalink": "lite"}),
    Row("none", "datalink none", settings={"datalink": "none"}),
    Row("address_16", "16-bit address", settings={"address_bits": 16}),
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
        mhz_least=48.0,
    ),
    Row("framed", "framed alone, with all there is", settings={"protocol": "framed"}, mhz_least=48.0),
    Row(
        "hello_led",
        "a whole design, classic: UART, FIFOs, core, registers (examples/hello_led)",
        top="hello_led_top",
        example="hello_led",
    ),
    Row(
        "servo",
        "a whole design: the same with PWM, encoder and an event (examples/servo)",
        top="servo_top",
        example="servo",
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
)
