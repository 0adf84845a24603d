# SPDX-License-Identifier: BSD-3-Clause
"""A new setting needs only a row in [settings]: every language then has its range and default."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import fields
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from click.testing import CliRunner
from unit.modules import module_of

from unitylink import _native
from unitylink.commands.simulate import command
from unitylink.errors import UrlError, ValueRangeError
from unitylink.interface.board_configuration import BoardConfiguration
from unitylink.settings import SETTINGS, Setting, Settings
from unitylink.simulate import simulated_board

ROOT = Path(__file__).resolve().parents[3]
SCARA = ROOT / "examples" / "scara" / "scara.ul"


@pytest.fixture(scope="module")
def generator() -> ModuleType:
    return module_of(ROOT / "protocol" / "settings.py")


@pytest.fixture(scope="module")
def table(generator: ModuleType) -> dict[str, dict[str, Any]]:
    """Return the table with one more row of each kind."""
    sys.path.insert(0, str(ROOT / "protocol"))
    try:
        from generate import read_table
    finally:
        sys.path.pop(0)
    more = {"unit": "", "needed_by": ["core", "twin"], "changed_by": ["url", "python"], "what": "new"}
    return {
        **read_table()["settings"],
        "depth": {"type": "count", "range": [2, 9], "default": 5, **more},
        "mirrored": {"type": "switch", "default": True, **more},
        "colour": {"type": "choice", "choices": ["red", "xor"], "default": "xor", **more},
        "mark": {"type": "word", "default": 0xABCD, **more},
    }


def test_a_row_is_a_field_in_python(generator: ModuleType, table: Any) -> None:
    made: dict[str, Any] = {"__name__": "made"}
    module = ModuleType("made")
    sys.modules["made"] = module
    try:
        exec(generator.python_text(table), module.__dict__)
    finally:
        del sys.modules["made"]
    made = module.__dict__
    settings = made["Settings"]()
    assert (settings.depth, settings.mirrored, settings.colour, settings.mark) == (5, True, "xor", 0xABCD)
    row = made["SETTINGS"]["depth"]
    assert (row.least, row.most, row.option) == (2, 9, "depth")


def test_a_row_is_a_field_in_cpp_and_is_visited(generator: ModuleType, table: Any, tmp_path: Path) -> None:
    (tmp_path / "settings.hpp").write_text(generator.cpp_text(table))
    source = tmp_path / "use.cpp"
    source.write_text(
        '#include <string>\n#include "settings.hpp"\nusing namespace unitylink::device;\n'
        "static_assert(Settings{}.depth == 5 && Settings{}.mirrored);\n"
        "static_assert(Settings{}.colour == Colour::exclusive_or);\n"
        "static_assert(unitylink::limits_of::depth.most == 9);\n"
        "struct Count { int seen = 0; template <class F> void operator()(const char*, F&) { ++seen; } };\n"
        "int main() { Settings s; Count count; each_setting(s, count); Colour c{};\n"
        '  return count.seen > 25 && choose("red", c) && c == Colour::red && !choose("blue", c) ? 0 : 1; }\n'
    )
    program = tmp_path / "use"
    subprocess.run(["c++", "-std=c++20", "-Wall", "-Werror", str(source), "-o", str(program)], check=True)
    subprocess.run([str(program)], check=True)


def test_a_row_is_a_field_in_vhdl(generator: ModuleType, table: Any, tmp_path: Path) -> None:
    package = tmp_path / "settings_pkg.vhd"
    package.write_text(generator.vhdl_text(table))
    play_vhdl(
        package,
        tmp_path,
        [
            "core_settings.depth = 5 and core_settings.mirrored and core_settings.colour = colour_xor",
            "core_settings(depth => 7).depth = 7 and core_settings(depth => 7).groups = core_settings.groups",
            'core_settings.mark = x"0000ABCD" and text_of(colour_xor) = "xor"',
            'colour_of("red") = colour_red and colour_of("xor") = colour_xor',
        ],
    )


def test_the_defaults_are_the_same_everywhere(tmp_path: Path) -> None:
    claims = []
    for setting in SETTINGS.values():
        if "core" not in setting.needed_by:
            continue
        name = f"core_settings.{setting.name}"
        if setting.type == "choice":
            claims.append(f"{name} = {setting.name}_{setting.default}")
        elif setting.type in {"switch", "count"}:
            claims.append(f"{name} = {setting.default}")
    assert len(claims) > 15
    play_vhdl(ROOT / "gateware" / "common" / "settings_pkg.vhd", tmp_path, claims)
    source = tmp_path / "use.cpp"
    of_twin = [s for s in SETTINGS.values() if {"twin", "line"} & set(s.needed_by) and s.type == "count"]
    source.write_text(
        '#include "unitylink/settings.hpp"\n'
        + "".join(
            f"static_assert(unitylink::device::Settings{{}}.{s.name} == {s.default}"
            f" && unitylink::limits_of::{s.name}.least == {s.least}"
            f" && unitylink::limits_of::{s.name}.most == {s.most});\n"
            for s in of_twin
        )
    )
    include = f"-I{ROOT / 'native' / 'include'}"
    subprocess.run(["c++", "-std=c++20", "-fsyntax-only", include, str(source)], check=True)


def play_vhdl(package: Path, folder: Path, claims: list[str]) -> None:
    bench = folder / "bench.vhd"
    bench.write_text(
        "library ieee;\nuse ieee.std_logic_1164.all;\nuse work.settings_pkg.all;\n"
        "entity bench is end entity;\narchitecture sim of bench is\nbegin\n"
        + "".join(f"  assert {claim} severity failure;\n" for claim in claims)
        + "end architecture;\n"
    )
    for arguments in (["-a", "--std=08", str(package), str(bench)], ["-r", "--std=08", "bench"]):
        subprocess.run(["ghdl", *arguments], cwd=folder, check=True)


@pytest.mark.parametrize("setting", [s for s in SETTINGS.values() if s.type == "count"], ids=lambda s: s.name)
def test_a_range_is_kept_in_python_and_in_the_twin(setting: Setting) -> None:
    for value in (setting.least - 1, setting.most + 1):
        with pytest.raises(ValueRangeError, match=rf"{setting.name} is {value}; choose {setting.least} to"):
            BoardConfiguration(**{setting.name: value})
    if not {"twin", "line"} & set(setting.needed_by):
        return

    class Unchecked:
        """A configuration that Python has not checked."""

        def __getattr__(self, name: str) -> Any:
            return setting.most + 1 if name == setting.name else getattr(BoardConfiguration(), name)

    with pytest.raises(ValueRangeError, match=f"{setting.name} is {setting.most + 1}"):
        _native.Device(Unchecked())


def test_a_board_configuration_has_every_setting() -> None:
    assert {field.name for field in fields(Settings)} == set(SETTINGS)
    assert issubclass(BoardConfiguration, Settings)


def test_urls_and_simulate_have_the_same_options() -> None:
    options = {setting.option for setting in SETTINGS.values() if "url" in setting.changed_by}
    shown = CliRunner().invoke(command, ["--help"]).output
    assert {option for option in options if f"--{option.replace('_', '-')} " not in shown} == set()
    for option in options:
        setting = next(s for s in SETTINGS.values() if s.option == option)
        if setting.type != "count" or setting.name in ("fifo", "baud_hz", "clock_hz"):
            continue
        most = {"exchange_size": 81, "base_hz": 5_000_000}.get(option, setting.most)
        board, url = simulated_board(f"sim:{SCARA}?{option}={most}")
        board.close()
        assert getattr(board.configuration, setting.name) == most
        assert (f"{option}=" in url) == setting.told, "the link is told what the device tells"


@pytest.mark.parametrize(
    ("option", "words"),
    [
        ("groups=257", "groups is 257; choose 1 to 256"),
        ("exchanges=5", "exchanges is 5; choose 0 to 4"),
        ("exchange_size=82", "one frame can define 81 words"),
        ("data_bits=4", "data_bits is 4; choose 8 to 32"),
        ("base_hz=50000000", "choose a BASE_RATE of at most"),
    ],
)
def test_a_url_cannot_ask_for_what_no_gateware_has(option: str, words: str) -> None:
    for kind in ("sim", "rtl"):
        with pytest.raises(ValueRangeError, match=words):
            simulated_board(f"{kind}:{SCARA}?{option}")
    with pytest.raises(UrlError, match="not a whole number"):
        simulated_board(f"sim:{SCARA}?groups=many")
