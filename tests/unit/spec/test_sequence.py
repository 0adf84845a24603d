# SPDX-License-Identifier: BSD-3-Clause
"""The program of a device: its words are those of sequencer_pkg.vhd, and each mistake names its step."""

from __future__ import annotations

import pytest

from unitylink.spec import Result, compile_text
from unitylink.spec.text.imports import component_names, device_files

SPI = '@sequence("spi", period=100 us)'
READ = '@cycle("read", 0x9D)'


def compiled(notes: str, entity: str = "") -> Result:
    lines = notes.replace(") @", ")\n@")
    bus = "i2c" if notes.startswith('@sequence("i2c"') else "spi"
    return compile_text(f"""
public a() {{ one: gauge(); }}
@component("{entity or bus + "_device"}")
{lines}
gauge(): @base[6] {{ @v = base+5: READ(); }}
""")


def program(notes: str) -> tuple[list[str], int]:
    """Return the words behind the pause before the set-up, and how many values they give."""
    result = compiled(notes)
    assert [one.message for one in result.diagnostics] == []
    assert result.spec is not None
    component = result.spec.root().instances[0].component
    assert component is not None
    generics = dict(component.generics)
    text = str(generics["program"])
    words = [text[at : at + 4] for at in range(0, len(text), 4)]
    assert words[:3] == ["C0E8", "C403", "C000"]  # 1 ms
    return words[3:], int(generics["values"])


def test_a_program_of_all_steps() -> None:
    words, values = program(
        f"""{SPI} @setup("write", 0x11, 1) @setup("wait", 2 us) @setup("check", 0xF5, reply=0x47)
        @cycle("read", 0x9D, words=2, bytes=2) @cycle("read", 1, bytes=3, order="little")
        @cycle("exchange", 6, 0x40, 0, keep=2)"""
    )
    assert values == 4
    assert words == [
        *("2011", "1001"),  # the first byte begins the frame, the last ends it
        *("C002", "C000"),
        *("20F5", "5847"),
        *("D800", "C064", "C800"),  # set up; each 100 us; a sample
        *("209D", "0D00", "0C01", "0D00", "1C01"),
        *("2001", "0C00", "0D00", "1E01"),
        *("2006", "0540", "1400"),
        "D00A",  # go on with the period: its place counts from the pause
    ]


def test_an_exchange_gives_several_words() -> None:
    words, values = program(f'{SPI} @cycle("exchange", 0, 1, 2, 3, words=2, keep=2)')
    assert values == 2
    assert words[-5:-1] == ["2500", "0401", "0502", "1403"]


def test_a_program_on_i2c_says_the_address_in_each_direction() -> None:
    words, values = program(
        '@sequence("i2c", address=0x68, period=70 ms) @setup("write", 0x6B, 0) @cycle("read", 0x3B, bytes=2)'
    )
    assert values == 1
    assert words[:3] == ["20D0", "006B", "1000"]
    assert words[3:8] == ["D800", "C070", "C412", "C4FF", "C800"]  # the longest part of 70 ms is the last
    assert words[8:12] == ["20D0", "003B", "20D1", "0D00"]
    assert words[12:] == ["1C01", "D007"]


@pytest.mark.parametrize(
    ("notes", "message"),
    [
        (READ, "a program has one `@sequence`"),
        (f"{SPI} {SPI} {READ}", "a program has one `@sequence`"),
        (f'@sequence("can", period=1 ms) {READ}', "this is no `@sequence` of a program"),
        (f'@sequence("i2c", period=1 ms) {READ}', "this is no `@sequence` of a program"),
        (f'@sequence("spi", address=0x68, period=1 ms) {READ}', "this is no `@sequence` of a program"),
        (f'@sequence("i2c", address=0x80, period=1 ms) {READ}', "the address of a device is 128"),
        (f'@sequence("spi", period=3 s) {READ}', "a period is 3e+06 us"),
        (f'@sequence("spi", period=1.5 us) {READ}', "a period is 1.5 us"),
        (f'@sequence("spi", period=0) {READ}', "a period is 0 us"),
        (f'@sequence("spi", period=1 V) {READ}', "a period is in `s`, and this does not measure the same"),
        (f'@sequence("spi", rate=1 ms, period=1 ms) {READ}', "`@sequence` has no `rate`"),
        (SPI, "this program gives 0 values"),
        (f'{SPI} {READ} @cycle("read", 1, words=27)', "this program gives 28 values"),
        (f'{SPI} @cycle("read", 1, words=28)', "`words` is 28"),
        (f'{SPI} @cycle("read", 1, bytes=5)', "`bytes` is 5"),
        (f'{SPI} @cycle("read", 1, order="mixed")', "`order` is the order of the bytes of a word"),
        (f'{SPI} @cycle("read")', "this is no step of a program on spi"),
        (f'{SPI} {READ} @setup("read", 1)', "`read` is a step of each period"),
        (f'{SPI} {READ} @setup("dance", 1)', "this is no step of a program on spi"),
        (f'{SPI} {READ} @setup("write", 256)', "a byte is 256"),
        (f'{SPI} {READ} @setup("check", 1)', "this is no step of a program on spi"),
        (f'{SPI} {READ} @setup("check", 1, reply=-1)', "a reply is -1"),
        (f'{SPI} {READ} @setup("wait", 3 s)', "a wait is 3e+06 us"),
        (f'{SPI} @cycle("exchange", 1, 2, keep=3)', "`keep` is 3"),
        (f'{SPI} @cycle("exchange", 1, 2, 3, words=2, keep=2)', "`keep` is 2"),
        (f'{SPI} @cycle("exchange", 1, 2, words=3)', "`words` is 3"),
        (
            '@sequence("i2c", address=8, period=1 ms) @cycle("exchange", 1, keep=1)',
            "no step of a program on i2c",
        ),
        pytest.param(
            f"{SPI} {READ}" + ' @setup("write", 1, 2, 3, 4, 5, 6)' * 50,
            "this program has 309 words",
            id="long",
        ),
    ],
)
def test_a_mistake_names_the_step(notes: str, message: str) -> None:
    diagnostics = compiled(notes).diagnostics
    assert message in diagnostics[0].message
    assert diagnostics[0].hint


def test_a_program_for_the_other_bus_is_refused() -> None:
    (diagnostic,) = compiled(f"{SPI} {READ}", "i2c_device").diagnostics
    assert "this is a program for spi, and the component is `i2c_device`" in diagnostic.message
    assert '@component("spi_device")' in (diagnostic.hint or "")


@pytest.mark.parametrize("name", device_files())
def test_a_device_of_the_library_is_whole(name: str) -> None:
    assert name not in component_names()
    page = device_files()[name].with_name("README.md").read_text("utf-8")
    assert f"| `{name}.ul` |" in page
    sequenced = "@sequence" in device_files()[name].read_text("utf-8")
    arguments = "rate=10 Hz" if sequenced else ""
    result = compile_text(f"link l(ADDRESS=8); public a() {{ one: {name}({arguments}); }}")
    assert [one.message for one in result.diagnostics] == []
    assert result.spec is not None
    (instance,) = result.spec.root().instances
    assert instance.component is not None
    generics = dict(instance.component.generics)
    assert ("program" in generics) == sequenced
    if not sequenced:
        return
    values = [one for one in result.spec.root().walk() if one.address >= instance.component.base + 5]
    assert sum(one.words for one in values) == generics["values"] == instance.component.words - 5
    numbers = [one for one in values if one.type.numeric]
    assert numbers and all(one.unit for one in numbers), "each number has a unit"
    assert all(one.publish for one in values), "each value is published"
