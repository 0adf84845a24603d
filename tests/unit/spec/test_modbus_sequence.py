# SPDX-License-Identifier: BSD-3-Clause
"""The program of a master of Modbus: its words are those of sequencer_pkg.vhd, a mistake names its step."""

from __future__ import annotations

import pytest

from unitylink.spec import Result, compile_text

BUS = '@sequence("modbus", address=17, period=100 ms)'
READ = '@cycle("read", 0x6B, words=3)'


def compiled(notes: str, entity: str = "modbus_master") -> Result:
    lines = notes.replace(") @", ")\n@")
    return compile_text(f"""
public a() {{ one: drive(); }}
@component("{entity}")
{lines}
drive(): @base[6] {{ @v = base+5: u16 READ(); }}
""")


def generics_of(result: Result) -> dict[str, int | str]:
    assert [one.message for one in result.diagnostics] == []
    assert result.spec is not None
    component = result.spec.root().instances[0].component
    assert component is not None
    return dict(component.generics)


def program(notes: str) -> tuple[list[str], int, int]:
    """Return the words behind those of the waits and before the end, the values and the outputs."""
    result = compiled(notes)
    generics = generics_of(result)
    text = str(generics["program"])
    words = [text[place : place + 4] for place in range(0, len(text), 4)]
    assert words[-1][:2] == "D0"
    return words[words.index("C800") + 1 : -1], int(generics["values"]), int(generics["outputs"])


def test_registers_are_read() -> None:
    words, values, outputs = program(f"{BUS} {READ}")
    assert (values, outputs) == (3, 0)
    assert words[:6] == ["2011", "0003", "0000", "006B", "0000", "0003"]
    assert words[6:9] == ["4811", "4803", "4806"]
    assert words[9:] == ["0D00", "0C01", "0D00", "0C01", "0D00", "1C01"]


def test_values_of_two_registers_in_both_orders() -> None:
    words, values, _ = program(f'{BUS} @cycle("read", 0, bytes=4, unit=2, function=4)')
    assert values == 1
    assert words[:2] == ["2002", "0004"] and words[5] == "0002"
    assert words[9:] == ["0F00", "0E00", "0D00", "1C01"]
    words, _, _ = program(f'{BUS} @cycle("read", 0, bytes=4, order="little")')
    assert words[9:] == ["0D00", "0C00", "0F00", "1E01"]


def test_outputs_are_written_and_skipped_until_they_are_set() -> None:
    words, values, outputs = program(f'{BUS} {READ} @cycle("write", 0x2001) @cycle("write", 7, function=16)')
    assert (values, outputs) == (3, 2)
    first = words[15:]
    assert first[0][:2] == "E0" and first[13][:2] == "E1"
    assert int(first[13][2:], 16) - int(first[0][2:], 16) == 16
    assert first[1:7] == ["2011", "0006", "0020", "0001", "8500", "8000"]
    assert first[7:13] == ["4811", "4806", "4820", "4801", "0800", "1800"]
    assert first[14:23] == ["2011", "0010", "0000", "0007", "0000", "0001", "0002", "8501", "8001"]
    assert first[23:] == ["4811", "4810", "4800", "4807", "4800", "5801"]


def test_a_register_is_set_at_the_start() -> None:
    result = compiled(f'{BUS} @setup("write", 1, 0x1234, unit=3) {READ}')
    text = str(generics_of(result)["program"])
    assert "20030006000000010012003448034806480048010800" + "1800D800" in text


@pytest.mark.parametrize(
    ("notes", "message"),
    [
        (f'@sequence("modbus", period=1 ms) {READ}', "this is no `@sequence` of a program"),
        (f'@sequence("modbus", address=0, period=1 ms) {READ}', "the address of a device is 0"),
        (BUS, "this program gives 0 values"),
        (f'{BUS} @cycle("read")', "this is no step of a program on modbus"),
        (f'{BUS} {READ} @cycle("check", 1)', "this is no step of a program on modbus"),
        (f'{BUS} {READ} @cycle("write", 1, 2)', "this is no step of a program on modbus"),
        (f'{BUS} {READ} @cycle("write", 1, words=2)', "this is no step of a program on modbus"),
        (f'{BUS} {READ} @setup("write", 1)', "this is no step of a program on modbus"),
        (f'{BUS} {READ} @setup("read", 1)', "`read` is a step of each period"),
        (f'{BUS} {READ} @setup("write", 1, 65536)', "the value of a register is 65,536"),
        (f'{BUS} @cycle("read", 65536)', "a register is 65,536"),
        (f'{BUS} @cycle("read", 1, unit=248)', "`unit` is 248"),
        (f'{BUS} @cycle("read", 1, bytes=3)', "`bytes` is 3"),
        (f'{BUS} @cycle("read", 1, function=5)', "`function` is 5"),
        (f'{BUS} {READ} @cycle("write", 1, function=7)', "`function` is 7"),
        (f"{BUS} {READ}" + ' @cycle("write", 1)' * 9, "this program writes 9 registers"),
        (f'{BUS} {READ} @setup("wait", 3 s)', "a wait is 3e+06 us"),
    ],
)
def test_a_mistake_names_the_step(notes: str, message: str) -> None:
    diagnostics = compiled(notes).diagnostics
    assert message in diagnostics[0].message
    assert diagnostics[0].hint


def test_a_program_for_another_bus_is_refused() -> None:
    diagnostics = compiled(f"{BUS} {READ}", "spi_device").diagnostics
    assert "this is a program for modbus, and the component is `spi_device`" in diagnostics[0].message
