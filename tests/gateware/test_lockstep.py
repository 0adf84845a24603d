# SPDX-License-Identifier: BSD-3-Clause
"""The compiled netlist beside GHDL's simulation of its source: equal outputs in every clock.

Some defects of GHDL's Verilog output cause no error. So the same comparison must fail on a netlist that still
has them.
"""

from __future__ import annotations

import ctypes
import random
from collections import deque
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest
from reference.scenario import Scenario
from reference.settings import Settings

from unitylink import protocol as p
from unitylink.gateware import Ghdl, gateware_folder, gateware_sources
from unitylink.gateware.repairs import repaired, with_default_arms, with_sized_constants
from unitylink.layer1_stream import ClassicEncoder
from unitylink.simulate.rtl import compile_netlist
from unitylink.simulate.rtl.verilog import either_edge_will_do

TOP = "lockstep_design"
CLOCKS = 6_000
CLOCKS_OF_A_DEFECT = 2_000  # both defects show in the first messages
PLAIN: dict[str, Any] = {}
# one process, so that the netlist is synthesised once
SHARES_PLAIN = pytest.mark.xdist_group("lockstep plain")
CONFIGURATIONS: list[Any] = [
    pytest.param(PLAIN, marks=SHARES_PLAIN),
    {"address_width": 12, "data_width": 13, "groups": 9, "group_size": 5, "rate_bytes": 1, "publish_mode": 1},
    pytest.param(
        {"address_width": 24, "read_many": 0, "publish_mode": 0, "checksum": "xor"}, marks=pytest.mark.long
    ),
    {"protocol": "both", "address_width": 16},
    {"protocol": "framed"},
]


class Pins(ctypes.Structure):
    _fields_ = [
        (name, ctypes.c_uint8)
        for name in (
            "reset",
            "rx_valid",
            "rx_data",
            "rx_error",
            "tx_ready",
            "rx_ready",
            "tx_valid",
            "tx_data",
        )
    ]


class Table(ctypes.Structure):
    _fields_ = [
        *((name, ctypes.c_uint32) for name in ("abi", "read_words", "write_words", "groups")),
        ("create", ctypes.CFUNCTYPE(ctypes.c_void_p)),
        ("destroy", ctypes.CFUNCTYPE(None, ctypes.c_void_p)),
        ("clock", ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.POINTER(Pins))),
        ("set_word", ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_uint32, ctypes.c_uint32)),
        ("words", ctypes.CFUNCTYPE(ctypes.POINTER(ctypes.c_uint32), ctypes.c_void_p)),
        ("was_written", ctypes.CFUNCTYPE(ctypes.c_uint32, ctypes.c_void_p, ctypes.c_uint32)),
        ("set_event", ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_uint32, ctypes.c_uint32)),
        ("failure", ctypes.CFUNCTYPE(ctypes.c_char_p, ctypes.c_void_p)),
    ]


class Requests:
    """Bytes that a host might send: most are correct requests, some are nearly correct, some are noise."""

    def __init__(self, seed: int, address_width: int, data_width: int) -> None:
        self.random = random.Random(seed)
        self.address_bytes, self.data_bytes = -(-address_width // 8), -(-data_width // 8)
        self.encoders = [ClassicEncoder(checked=checked) for checked in (False, True)]

    def address(self) -> bytes:
        return self.random.choice((*range(18), 64, 79, 80)).to_bytes(self.address_bytes, "big")

    def message(self) -> bytes:
        r = self.random
        count = r.randint(1, 5)
        several = b"".join(self.address() for _ in range(count))
        command, data = r.choice(
            [
                ("R", self.address()),
                ("RM", bytes([count]) + several),
                (
                    "W",
                    self.address() + r.randrange(1 << 8 * self.data_bytes).to_bytes(self.data_bytes, "big"),
                ),
                ("RLC", b""),
                ("WSA", bytes([r.randrange(2), count]) + several),
                ("WSR", bytes([r.randrange(2), 0, r.randrange(3)])),
                ("RSI", bytes([r.randrange(3)])),
                ("EPS", b""),
                ("EPC", b""),
                ("DPS", b""),
                ("WIC", b"\xff\xff"),
                ("RIC", b""),
            ]
        )
        message = bytearray(r.choice(self.encoders).encode(command, data))
        if r.random() < 0.15:
            message[r.randrange(len(message))] = r.randrange(256)
        return bytes(message)


class Frames:
    """Frames that a host might send. Sessions begin and end, groups publish, and the dead-man runs."""

    def __init__(self, seed: int, address_width: int, data_width: int) -> None:
        self.random = random.Random(seed)
        settings = Settings(-(-address_width // 8), -(-data_width // 8), groups=2)
        self.steps = iter(Scenario(seed, settings, steps=CLOCKS, addresses=18, timed=True))

    def message(self) -> bytes:
        return next(self.steps)


class Model:
    """A compiled lockstep_design, driven clock by clock."""

    def __init__(self, library: Path) -> None:
        entry = ctypes.CDLL(str(library)).unitylink_rtl_model
        entry.restype = ctypes.POINTER(Table)
        self.table: Any = entry().contents
        self.state = self.table.create()
        self.pins = Pins()

    def clock(self, stimulus: Sequence[int]) -> str:
        pins = self.pins
        pins.reset, pins.rx_valid, pins.rx_data, pins.rx_error, pins.tx_ready, events, word, value = stimulus
        for group in range(self.table.groups):
            self.table.set_event(self.state, group, events >> group & 1)
        self.table.set_word(self.state, word, value)
        self.table.clock(self.state, pins)
        words = " ".join(f"{word:08X}" for word in self.table.words(self.state)[:8])
        return f"{pins.rx_ready} {pins.tx_valid} {pins.tx_data if pins.tx_valid else 0} {words}"


def play(model: Model, requests: Requests | Frames, clocks: int) -> tuple[list[str], list[str]]:
    """Talk to `model`, which may do anything. Return the stimulus and the response of each clock."""
    r = requests.random
    waiting: deque[int] = deque()
    stimuli, responses = [], []
    events = 0
    for clock in range(clocks):
        taken = model.pins.rx_valid and model.pins.rx_ready
        if taken:
            waiting.popleft()
        if not waiting and r.random() < 0.1:
            waiting.extend(requests.message())
        offered = bool(waiting) and ((model.pins.rx_valid and not taken) or r.random() < 0.9)
        if r.random() < 0.004:
            events = r.randrange(1 << model.table.groups)
        rx_error = r.randrange(8) if r.random() < 0.001 else 0
        stimulus = (
            int(clock < 4 or clock == clocks // 2),
            int(offered),
            waiting[0] if waiting else r.randrange(256),
            rx_error,
            int(r.random() < 0.9),
            events,
            r.randrange(8),
            r.randrange(1 << 31),
        )
        stimuli.append(" ".join(map(str, stimulus)))
        responses.append(model.clock(stimulus))
    return stimuli, responses


@cache
def synthesised(generics: tuple[tuple[str, Any], ...]) -> tuple[str, str]:
    """Return the netlist as GHDL prints it in Verilog and in VHDL."""
    sources = [*gateware_sources(), gateware_folder() / "test" / f"{TOP}.vhd"]
    with TemporaryDirectory(prefix="unitylink-lockstep-") as work:
        synthesis = Ghdl(Path(work), sources)
        verilog, vhdl = (
            synthesis.synthesise(TOP, language, dict(generics)) for language in ("verilog", "vhdl")
        )
    return verilog, vhdl


class Lockstep:
    """Run one netlist of lockstep_design, and GHDL on its source, with the same stimulus."""

    def __init__(self, ghdl: Any, folder: Path, generics: dict[str, Any]) -> None:
        self.ghdl, self.folder, self.generics = ghdl, folder, generics
        self.verilog, self.vhdl = synthesised(tuple(generics.items()))

    def compare(self, verilog: str, clocks: int) -> tuple[list[str], list[str]]:
        library = self.folder / f"model_{len(list(self.folder.glob('*.so')))}.so"
        compile_netlist(verilog, TOP, library)
        told = {"address_width": 8, "data_width": 32, "protocol": "classic", **self.generics}
        kind = Requests if told["protocol"] == "classic" else Frames
        requests = kind(6, told["address_width"], told["data_width"])
        stimuli, compiled = play(Model(library), requests, clocks)
        stimulus_file, response_file = self.folder / "stimulus.txt", self.folder / "response.txt"
        stimulus_file.write_text("\n".join(stimuli) + "\n")
        # After a message that was cut short, the address is unknown. The bus decodes it, though nothing
        # strobes.
        quiet = "--ieee-asserts=disable"
        self.ghdl.run(
            "lockstep_tb", quiet, stimulus_file=stimulus_file, response_file=response_file, **self.generics
        )
        return compiled, response_file.read_text().splitlines()


def first_difference(compiled: Sequence[str], source: Sequence[str]) -> int | None:
    """Return the first clock in which the two differ. Clocks before the reset do not count."""
    assert len(compiled) == len(source)
    return next((clock for clock in range(4, len(source)) if compiled[clock] != source[clock]), None)


@pytest.mark.parametrize(
    "generics", CONFIGURATIONS, ids=["plain", "narrow", "without-publishing", "both", "framed"]
)
@pytest.mark.takes(15)
def test_netlist_and_source(ghdl: Any, tmp_path: Path, generics: dict[str, Any]) -> None:
    lockstep = Lockstep(ghdl, tmp_path, generics)
    verilog = repaired(lockstep.verilog, lockstep.vhdl)
    if "data_width" in generics:  # once with a clock that passes through logic, as a user's clock may
        verilog = verilog.replace(".clock(clock)", ".clock(~(~clock))")
        assert not either_edge_will_do(verilog)
    compiled, source = lockstep.compare(verilog, CLOCKS)
    differs = first_difference(compiled, source)
    assert differs is None, f"clock {differs}\nnetlist {compiled[differs]}\nsource  {source[differs]}"
    sent = bytes(int(line.split()[2]) for line in source if line.split()[1] == "1")
    assert len(sent) > CLOCKS / 16, "nothing has been compared"
    if "protocol" in generics:
        kinds = {piece[0] for piece in sent.split(b"\0") if piece}
        seen = {p.DEVICE_KIND_HELLO, p.DEVICE_KIND_OPEN, p.DEVICE_KIND_REPLY, p.DEVICE_KIND_PUBLISH}
        assert kinds >= seen, f"only {sorted(map(hex, kinds))}"
        return
    assert b"S_R:" in sent
    assert (b"PUB:" in sent) == (generics.get("publish_mode") != 0)
    assert len(sent) > CLOCKS / 8


@SHARES_PLAIN
@pytest.mark.parametrize("defect", [pytest.param("default arms", marks=pytest.mark.long), "wide constants"])
def test_netlist_as_ghdl_prints_it_differs(ghdl: Any, tmp_path: Path, defect: str) -> None:
    """If this fails, GHDL has mended the defect and our repair can go."""
    lockstep = Lockstep(ghdl, tmp_path, PLAIN)
    if defect == "default arms":
        verilog = with_sized_constants(lockstep.verilog)
    else:
        verilog = with_default_arms(lockstep.verilog, lockstep.vhdl)
    assert verilog != repaired(lockstep.verilog, lockstep.vhdl)
    assert first_difference(*lockstep.compare(verilog, CLOCKS_OF_A_DEFECT)) is not None
