# SPDX-License-Identifier: BSD-3-Clause
"""What a device is built with (docs/settings.md).

Generated from protocol/protocol.toml by protocol/generate.py; edit there.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Final


@dataclass(frozen=True)
class Setting:
    """A row of the table; `least` and `most` are those of a count, `choices` those of a choice."""

    name: str
    type: str
    default: Any
    unit: str
    needed_by: tuple[str, ...]
    changed_by: tuple[str, ...]
    what: str
    least: int = 0
    most: int = 0
    choices: tuple[str, ...] = ()
    told: bool = False
    option: str = ""  # its name in a URL


@dataclass(frozen=True)
class Settings:
    """Every setting of a device, under the name that C++, VHDL and URLs have for it, too."""

    address_bits: int = 8
    """bits: width of a word's address"""
    data_bits: int = 32
    """bits: width of a data word"""
    clock_hz: int = 50000000
    """Hz: frequency of the clock"""
    base_hz: int = 1000
    """Hz: base frequency of publishing; two strobes are at least groups + 5 clocks apart"""
    groups: int = 16
    """groups: number of publish groups"""
    group_size: int = 32
    """words: most addresses of a publish group"""
    rate_bytes: int = 2
    """bytes: width of a group's divisor"""
    read_many: int = 255
    """words: most words of a classic read-many; 0: there is no such command"""
    publish_mode: int = 2
    """0 no publishing, 1 prefers requests, 2 prefers publishes"""
    configuration_command: bool = True
    """the classic command RLC exists"""
    protocol: str = "both"
    """protocols that the device speaks; the design contains no other"""
    datalink: str = "full"
    """classic datalink; lite and none check nothing; none sends data as bytes, not as digits"""
    checksum: str = "crc8"
    """checksum of the full datalink"""
    polynomial: int = 7
    """polynomial of crc8"""
    edge_events: tuple[int, ...] = ()
    """groups whose event is an edge of their event input; for the others it is a level"""
    exchanges: int = 2
    """groups: number of exchange groups of the framed protocol; 0: there are none"""
    exchange_size: int = 30
    """words: words of an exchange group, in and out; at most 122, 81, 61 or 49 with 1 to 4 address bytes"""
    lists: bool = True
    """the requests LIST and POST_LIST exist"""
    deadman: bool = True
    """the dead-man exists"""
    window: int = 64
    """requests: most requests in flight; a power of two, and the number of places in the reply cache"""
    gateware_version: int = 65536
    """version that the device reports"""
    build: int = 0
    """number of the build that the device reports"""
    spec_hash: int = 0
    """hash of all that the spec says about the wire; 0: the device reports none"""
    timeout_clocks: int = 100
    """clocks: time after which a bus access without an answer ends"""
    request_max: int = 250
    """bytes: longest payload of a framed request; gateware has the default"""
    reply_max: int = 250
    """bytes: longest payload of a framed reply or publish; gateware has the default"""
    credit: int = 512
    """bytes: most bytes of framed requests without an answer; gateware has the default"""
    cache_bytes: int = 16
    """bytes: most bytes of a reply that is kept for a repeat; gateware has the default"""
    long_frames: bool = False
    """payloads of more than 250 bytes are allowed; gateware has the default"""
    published_2012: bool = False
    """behaves like the gateware of 2012, with its defects; classic protocol only"""
    bench_memory: bool = False
    """memory starts with the values in the recordings of the 2012 gateware, not with zeros"""
    fifo: int = 0
    """bytes: size of the buffer of the physical layer, in each direction, at least 4; 0: large"""
    baud_hz: int = 0
    """baud: baud rate of a serial line; 0: there is no line, and bytes are flow-controlled as over USB"""
    fifo_latency: int = 0
    """clocks: delay of a byte in each of these buffers"""
    honour_flush: bool = False
    """a datalink error empties the receive buffer, as in the UART of 2012"""
    physical: str = "uart"
    """physical layer of the design"""
    engine: str = "fast"
    """engine of the framed protocol; the sizes of the small one are fixed"""
    send_immediate: str = "both"
    """messages after which an FTDI chip sends at once"""
    node: int = 1
    """number of the node on an RS-485 pair"""


# fmt: off
SETTINGS: Final = MappingProxyType(
    {
        "address_bits": Setting(
            "address_bits", "count", 8, "bits", ("core", "twin"), ("spec", "python"),
            "width of a word's address",
            least=1, most=32),
        "data_bits": Setting(
            "data_bits", "count", 32, "bits", ("core", "twin"), ("spec", "url", "python"),
            "width of a data word",
            least=8, most=32, option="data_bits"),
        "clock_hz": Setting(
            "clock_hz", "count", 50000000, "Hz", ("core", "twin"), ("url", "python"),
            "frequency of the clock",
            least=1000, most=1000000000, option="clock_hz"),
        "base_hz": Setting(
            "base_hz", "count", 1000, "Hz", ("core", "twin"), ("spec", "url", "python"),
            "base frequency of publishing; two strobes are at least groups + 5 clocks apart",
            least=1, most=1000000000, told=True, option="base_hz"),
        "groups": Setting(
            "groups", "count", 16, "groups", ("core", "twin"), ("spec", "url", "python"),
            "number of publish groups",
            least=1, most=256, told=True, option="groups"),
        "group_size": Setting(
            "group_size", "count", 32, "words", ("core", "twin"), ("spec", "url", "python"),
            "most addresses of a publish group",
            least=1, most=255, told=True, option="group_size"),
        "rate_bytes": Setting(
            "rate_bytes", "count", 2, "bytes", ("core", "twin"), ("spec", "url", "python"),
            "width of a group's divisor",
            least=1, most=4, told=True, option="rate_bytes"),
        "read_many": Setting(
            "read_many", "count", 255, "words", ("core", "twin"), ("spec", "url", "python"),
            "most words of a classic read-many; 0: there is no such command",
            least=0, most=255, told=True, option="read_many"),
        "publish_mode": Setting(
            "publish_mode", "count", 2, "", ("core", "twin"), ("url", "python"),
            "0 no publishing, 1 prefers requests, 2 prefers publishes",
            least=0, most=2, told=True, option="publish_mode"),
        "configuration_command": Setting(
            "configuration_command", "switch", True, "", ("core", "twin"), ("python",),
            "the classic command RLC exists"),
        "protocol": Setting(
            "protocol", "choice", "both", "", ("core", "twin"), ("python",),
            "protocols that the device speaks; the design contains no other",
            choices=("both", "framed", "classic")),
        "datalink": Setting(
            "datalink", "choice", "full", "", ("core", "twin"), ("python",),
            "classic datalink; lite and none check nothing; none sends data as bytes, not as digits",
            choices=("full", "lite", "none")),
        "checksum": Setting(
            "checksum", "choice", "crc8", "", ("core", "twin"), ("python",),
            "checksum of the full datalink",
            choices=("crc8", "xor", "none")),
        "polynomial": Setting(
            "polynomial", "count", 7, "", ("core", "twin"), ("python",),
            "polynomial of crc8",
            least=0, most=255),
        "edge_events": Setting(
            "edge_events", "groups", (), "", ("core", "twin"), ("spec", "python"),
            "groups whose event is an edge of their event input; for the others it is a level"),
        "exchanges": Setting(
            "exchanges", "count", 2, "groups", ("core", "twin"), ("url", "python"),
            "number of exchange groups of the framed protocol; 0: there are none",
            least=0, most=4, option="exchanges"),
        "exchange_size": Setting(
            "exchange_size", "count", 30, "words", ("core", "twin"), ("spec", "url", "python"),
            "words of an exchange group, in and out; at most 122, 81, 61 or 49 with 1 to 4 address bytes",
            least=1, most=122, option="exchange_size"),
        "lists": Setting(
            "lists", "switch", True, "", ("core", "twin"), ("python",),
            "the requests LIST and POST_LIST exist"),
        "deadman": Setting(
            "deadman", "switch", True, "", ("core", "twin"), ("python",),
            "the dead-man exists"),
        "window": Setting(
            "window", "count", 64, "requests", ("core", "twin"), ("python",),
            "most requests in flight; a power of two, and the number of places in the reply cache",
            least=2, most=128),
        "gateware_version": Setting(
            "gateware_version", "word", 65536, "", ("core", "twin"), ("python",),
            "version that the device reports"),
        "build": Setting(
            "build", "word", 0, "", ("core", "twin"), ("python",),
            "number of the build that the device reports"),
        "spec_hash": Setting(
            "spec_hash", "hash", 0, "", ("core", "twin"), ("spec", "python"),
            "hash of all that the spec says about the wire; 0: the device reports none"),
        "timeout_clocks": Setting(
            "timeout_clocks", "count", 100, "clocks", ("core",), (),
            "time after which a bus access without an answer ends",
            least=1, most=1000000),
        "request_max": Setting(
            "request_max", "count", 250, "bytes", ("twin",), ("python",),
            "longest payload of a framed request; gateware has the default",
            least=16, most=4072),
        "reply_max": Setting(
            "reply_max", "count", 250, "bytes", ("twin",), ("python",),
            "longest payload of a framed reply or publish; gateware has the default",
            least=16, most=4072),
        "credit": Setting(
            "credit", "count", 512, "bytes", ("twin",), ("python",),
            "most bytes of framed requests without an answer; gateware has the default",
            least=64, most=65535),
        "cache_bytes": Setting(
            "cache_bytes", "count", 16, "bytes", ("twin",), ("python",),
            "most bytes of a reply that is kept for a repeat; gateware has the default",
            least=8, most=255),
        "long_frames": Setting(
            "long_frames", "switch", False, "", ("twin",), ("python",),
            "payloads of more than 250 bytes are allowed; gateware has the default"),
        "published_2012": Setting(
            "published_2012", "switch", False, "", ("twin",), ("python",),
            "behaves like the gateware of 2012, with its defects; classic protocol only"),
        "bench_memory": Setting(
            "bench_memory", "switch", False, "", ("twin",), ("python",),
            "memory starts with the values in the recordings of the 2012 gateware, not with zeros"),
        "fifo": Setting(
            "fifo", "count", 0, "bytes", ("line",), ("url", "python"),
            "size of the buffer of the physical layer, in each direction, at least 4; 0: large",
            least=0, most=1048576, told=True, option="fifo"),
        "baud_hz": Setting(
            "baud_hz", "count", 0, "baud", ("line",), ("spec", "url", "python"),
            "baud rate of a serial line; 0: there is no line, and bytes are flow-controlled as over USB",
            least=0, most=1000000000, option="baud"),
        "fifo_latency": Setting(
            "fifo_latency", "count", 0, "clocks", ("line",), ("python",),
            "delay of a byte in each of these buffers",
            least=0, most=1000),
        "honour_flush": Setting(
            "honour_flush", "switch", False, "", ("line",), ("python",),
            "a datalink error empties the receive buffer, as in the UART of 2012"),
        "physical": Setting(
            "physical", "choice", "uart", "", ("top",), ("spec", "url", "python"),
            "physical layer of the design",
            choices=("uart", "ft245_async", "ft245_sync", "spi", "rs485"), option="physical"),
        "engine": Setting(
            "engine", "choice", "fast", "", ("top",), ("spec", "url", "python"),
            "engine of the framed protocol; the sizes of the small one are fixed",
            choices=("fast", "small"), option="engine"),
        "send_immediate": Setting(
            "send_immediate", "choice", "both", "", ("top",), ("spec", "url", "python"),
            "messages after which an FTDI chip sends at once",
            choices=("never", "publishes", "replies", "both"), option="send_immediate"),
        "node": Setting(
            "node", "count", 1, "", ("top",), ("spec", "python"),
            "number of the node on an RS-485 pair",
            least=1, most=63),
    }
)
# fmt: on
