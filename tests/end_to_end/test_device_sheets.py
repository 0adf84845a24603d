# SPDX-License-Identifier: BSD-3-Clause
"""Every device of the library against what its datasheet says, on the twin and the compiled VHDL alike.

`components/*/devices/NAME.toml` is the sheet: registers after power-up, what the set-up must have written,
the shortest times that the device allows, and what it sends with the values that it means.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import pytest

from unitylink import Link
from unitylink.layer4_data import load_spec_objects
from unitylink.simulate import Board
from unitylink.simulate.rtl import RtlBoard
from unitylink.simulate.rtl.board import rtl_configuration
from unitylink.spec import compile_text
from unitylink.spec.text.imports import device_files

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

pytestmark = pytest.mark.xdist_group("rtl")

CLOCK_HZ = 8_000_000
BOARDS = 5  # a board of few devices is quick: each of its events asks all of them
PERIOD = "period=20 ms"
FAST_MODE_NS = {  # fast mode in UM10204 of NXP
    "scl_high": 600,
    "scl_low": 1300,
    "data_setup": 100,
    "start_setup": 600,
    "start_hold": 600,
    "stop_setup": 600,
    "bus_free": 1300,
}
SEQUENCED = {name: file for name, file in device_files().items() if "@sequence" in file.read_text("utf-8")}
SHEETS = {
    name: tomllib.loads(file.with_suffix(".toml").read_text("utf-8"))
    for name, file in SEQUENCED.items()
    if file.with_suffix(".toml").is_file()
}
ADDRESSED = {name for name, file in SEQUENCED.items() if "i2c_device" in file.parts}


class Bench:
    """A board with all devices, and what a program reads of them."""

    def __init__(self, board: Board, link: Link, sheets: dict[str, dict[str, Any]]) -> None:
        self.sheets = sheets
        self.devices = {
            name: board.components[name].device_with(**sheet.get("device", {}))
            for name, sheet in sheets.items()
        }
        assert board.spec is not None
        self.objects: Any = load_spec_objects(board.spec, link)

    def value(self, device: str, path: str) -> float:
        item, _, field = path.partition(".")
        found = self.objects[f"{device}.{item}"].read()
        return float(getattr(found, field) if field else found)

    def valid(self, device: str) -> bool:
        return bool(self.objects[f"{device}.status"].read().valid)

    def gone(self, device: str) -> bool:
        return not self.valid(device)

    def failure(self, device: str) -> str:
        return str(self.objects[f"{device}.status"].read().failure.name)

    def shows(self, device: str, values: dict[str, float]) -> bool:
        return all(self.value(device, path) == pytest.approx(value, 1e-4) for path, value in values.items())

    def put(self, device: str, what: dict[str, Any]) -> None:
        for number, bits in what.get("words", {}).items():
            self.devices[device].set_word(int(number), bits)
        # First those that the set-up writes: it may begin as soon as the device says who it is.
        written = what.get("written", {})
        registers = sorted(what.get("registers", {}).items(), key=lambda item: item[0] not in written)
        for first, octets in _octets(device, dict(registers)):
            self.devices[device][first : first + len(octets)] = octets


def _arguments(sheet: dict[str, Any]) -> Iterator[str]:
    if not sheet.get("slow"):
        yield PERIOD
    if "arguments" in sheet:
        yield sheet["arguments"]


def _octets(device: str, registers: dict[str, str]) -> Iterator[tuple[int, bytes]]:
    size = SHEETS[device].get("device", {}).get("register_bytes", 1)
    for number, octets in registers.items():
        yield int(number, 16) * size, bytes.fromhex(octets)


def _until(true: Callable[[], object], what: str) -> None:
    end = time.monotonic() + 60
    while not true():
        assert time.monotonic() < end, what
        time.sleep(0.002)


@pytest.fixture(
    scope="module",
    params=[
        pytest.param(
            (kind, group), marks=pytest.mark.long if kind is RtlBoard else (), id=f"{kind.__name__}-{group}"
        )
        for kind in (Board, RtlBoard)
        for group in range(BOARDS)
    ],
)
def bench(request: pytest.FixtureRequest) -> Iterator[Bench]:
    kind, group = request.param
    sheets = {name: SHEETS[name] for name in sorted(SHEETS)[group::BOARDS]}
    lines = [f"   {name}: {name}({', '.join(_arguments(sheet))});" for name, sheet in sheets.items()]
    text = "link body (ADDRESS=10);\npublic body() {\n" + "\n".join(lines) + "\n}\n"
    result = compile_text(text, "body.ul")
    assert result.spec is not None, [one.message for one in result.diagnostics]
    configuration = rtl_configuration(result.spec, clock_hz=CLOCK_HZ)
    with (
        kind(result.spec, configuration=configuration, endpoint="tcp") as board,
        Link(f"{board.url}?timeout=20") as link,
    ):
        yield Bench(board, link, sheets)


def test_every_device_has_a_sheet() -> None:
    assert sorted(SHEETS) == sorted(SEQUENCED)
    assert len(SHEETS) >= 20


def test_devices_do_what_their_datasheets_say(bench: Bench) -> None:
    for name, sheet in bench.sheets.items():
        if set(sheet.get("registers", {})) - set(sheet.get("written", {})):
            assert not bench.valid(name), f"{name} does not yet say who it is"
    for name, sheet in bench.sheets.items():
        bench.put(name, sheet)
        bench.put(name, sheet["sample"][0])
    for name, sheet in bench.sheets.items():
        _until(partial(bench.valid, name), f"{name} is set up")
        _until(partial(bench.shows, name, sheet["sample"][0]["values"]), f"{name} has its first sample")
        for first, octets in _octets(name, sheet.get("written", {})):
            assert bytes(bench.devices[name][first : first + len(octets)]) == octets, f"{name} at {first:02X}"


def test_further_samples(bench: Bench) -> None:
    for name, sheet in bench.sheets.items():
        for sample in sheet["sample"][1:]:
            bench.put(name, sample)
            _until(partial(bench.shows, name, sample["values"]), f"{name} shows {sample['values']}")


def test_no_time_is_shorter_than_the_datasheet_allows(bench: Bench) -> None:
    for name, sheet in bench.sheets.items():
        least = {**(FAST_MODE_NS if name in ADDRESSED else {}), **sheet.get("shortest_ns", {})}
        seen = bench.devices[name].shortest_s
        assert set(seen) >= set(least), name
        for what, ns in least.items():
            assert seen[what] >= ns * 1e-9, f"{what} of {name} is {seen[what] * 1e9:.0f} ns"


def test_a_device_that_is_gone_is_told_from_one_that_is_there(bench: Bench) -> None:
    told = dict.fromkeys(ADDRESSED & {*bench.sheets}, "no_answer")
    told |= {name: sheet["unplugged"] for name, sheet in bench.sheets.items() if "unplugged" in sheet}
    for name in told:
        bench.devices[name].plugged = False
    for name, failure in told.items():
        _until(partial(bench.gone, name), f"{name} is gone")
        assert bench.failure(name) == failure, name
    for name in told:
        bench.devices[name].plugged = True
    for name in told:
        _until(partial(bench.valid, name), f"{name} is back")
