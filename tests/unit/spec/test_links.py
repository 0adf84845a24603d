# SPDX-License-Identifier: BSD-3-Clause
"""What a link declares: its physical layer, its engine, and the properties that belong to them."""

from __future__ import annotations

import pytest

from unitylink.spec import Spec, compile_text


def clean(text: str) -> Spec:
    """Compile a text that must give no diagnostic."""
    result = compile_text(text)
    assert [(d.code, d.message) for d in result.diagnostics] == []
    assert result.spec is not None
    return result.spec


def test_what_a_link_stands_on() -> None:
    spec = clean("""
    link elbow (PHYSICAL=rs485, NODE=2, BAUD=3 MHz);
    public a() { @x = 0x1: READ(); }
    """)
    (link,) = spec.links
    assert (link.physical, link.node, link.send_immediate, link.stated) == (
        "rs485",
        2,
        None,
        ("PHYSICAL", "NODE", "BAUD"),
    )
    other = clean("link elbow (PHYSICAL=rs485, NODE=3, BAUD=3 MHz); public a() { @x = 0x1: READ(); }")
    assert other.hash != spec.hash
    chip = clean("link a (PHYSICAL=ft245_sync, SEND_IMMEDIATE=publishes); public a() { @x = 0x1: READ(); }")
    assert (chip.links[0].physical, chip.links[0].send_immediate) == ("ft245_sync", "publishes")
    small = clean("link a (ENGINE=small, BAUD=9600); public a() { @x = 0x1: READ(); }")
    assert small.links[0].engine == "small"
    silent = clean("link a (BAUD=9600); public a() { @x = 0x1: READ(); }")
    assert (silent.links[0].physical, silent.links[0].engine) == (None, None)
    assert silent.hash == small.hash, "an engine moves no word"


@pytest.mark.parametrize(
    ("properties", "code", "message"),
    [
        ("PHYSICAL=usb", "UL093", "PHYSICAL=usb has no meaning"),
        ("ENGINE=tiny", "UL093", "ENGINE=tiny has no meaning"),
        ("PHYSICAL=spl", "UL093", "PHYSICAL=spl has no meaning"),
        ("PHYSICAL=ft245_sync, SEND_IMMEDIATE=always", "UL093", "SEND_IMMEDIATE=always has no meaning"),
        ("PHYSICAL=spi, BAUD=9600", "UL092", "BAUD belongs to a line, but link `a` is not one"),
        ("SEND_IMMEDIATE=never", "UL092", "SEND_IMMEDIATE belongs to an FT245, but link `a` is not one"),
        ("NODE=1, BAUD=9600", "UL092", "NODE belongs to an RS-485 pair, but link `a` is not one"),
        ("PHYSICAL=rs485", "UL092", "which node on the pair is link `a`?"),
        ("PHYSICAL=rs485, NODE=64", "UL049", ""),
    ],
)
def test_what_a_link_cannot_stand_on(properties: str, code: str, message: str) -> None:
    result = compile_text(f"link a ({properties}); public a() {{ @x = 0x1: READ(); }}", "<text>")
    ((found, said),) = [(d.code, d.message) for d in result.diagnostics]
    assert found == code and message in said


SEVEN_RATES = "".join(f"@x{n} = {n + 1:#x}: READ(PUBLISH(1, {n + 1})); " for n in range(7))


@pytest.mark.parametrize(
    ("members", "said"),
    [
        ("@x = 0x1: READ(PUBLISH(10 Hz));", []),
        ("@x = 0x1: u64 READ();", ["the small engine reads one word at a time, and `x` has 2"]),
        (
            "DOUBLE_BUFFER(SIZE=4); @x = 0x1: READ();",
            ["the small engine has no lists, which DOUBLE_BUFFER of"],
        ),
        (SEVEN_RATES, ["the small engine publishes 6 groups of 17 words, and `x6` needs one more"]),
        ("@x = 0x1: READ(PUBLISH(1, 70000));", ["counts to 65535, and the divisor of `x` is 70000"]),
        ("@x = 0x1: READ(PUBLISH(2, 10)); @y = 0x2: u64 WRITE();", []),
    ],
)
def test_what_the_small_engine_cannot_do(members: str, said: list[str]) -> None:
    """It is reported with its place, and once for each reason. With the fast engine, nothing is wrong."""
    text = f"link a (ENGINE=small); public a() {{ {members} }}"
    found = compile_text(text, "<text>").diagnostics
    assert [d.code for d in found] == ["UL105"] * len(said)
    for one, words in zip(found, said, strict=True):
        assert words in one.message and one.span.start > text.index("@")
        assert one.hint.endswith(", or write ENGINE=fast")
    assert not compile_text(text.replace("small", "fast"), "<text>").diagnostics
