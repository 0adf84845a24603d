# SPDX-License-Identifier: BSD-3-Clause
"""Common mistakes in any specification language: each is reported with its place, cause and remedy.

Other tools were tried on the same list. Many give no line for some of these, or stop at the first one.
"""

from __future__ import annotations

from unitylink.spec import compile_text
from unitylink.spec.fix import fix_text


def public(*members: str) -> str:
    return "public a() {\n" + "".join(f"   {member}\n" for member in members) + "}\n"


JOINT = "joint(name): @ (pos) {\n   @pos: READ(ID=name);\n}\n"

# mistake -> text, (code, line, column), a word of the cause, a word of the remedy, whether a fix exists
CORPUS = {
    "missing semicolon": (public("@x = 0x1: READ()"), ("UL011", 2, 20), "missing", "add `;`", True),
    "missing colon": (public("@x = 0x1 READ();"), ("UL010", 2, 13), "expected `:`", "add `:`", True),
    "missing colon before a type": (
        public("@x = 0x1 i16 READ();"),
        ("UL010", 2, 17),
        "expected `:`",
        "add `:`",
        True,
    ),
    "typo in a type": (public("@x = 0x1: boool READ();"), ("UL080", 2, 14), "boool", "`bool`", True),
    "type of another language": (public("@x = 0x1: int16 READ();"), ("UL080", 2, 14), "int16", "`i16`", True),
    "typo in a block": (
        public('j: jiont("one") @ (0x1);') + JOINT,
        ("UL024", 2, 7),
        "jiont",
        "`joint`",
        True,
    ),
    "typo in a property": (public("@x = 0x1: READ(UNTI='rad');"), ("UL015", 2, 19), "UNTI", "`UNIT`", True),
    "bad access word": (public("@x = 0x1: RO();"), ("UL010", 2, 14), "RO", "`READ`", True),
    "bad access word behind a type": (
        public("@x = 0x1: u8 rw();"),
        ("UL010", 2, 17),
        "rw",
        "`READWRITE`",
        True,
    ),
    "bad access word without an address": (
        "public a() {\n   j: j() @ (0x1);\n}\nj(): @ (x) {\n   @x: WO();\n}\n",
        ("UL024", 5, 8),
        "WO",
        "`WRITE`",
        True,
    ),
    "fields overlap": (
        "bits s: u8 { a: u4 @ 3..0; b: u4 @ 6..3; }\n" + public("@x = 0x1: s READ();"),
        ("UL085", 1, 36),
        "overlap those of `a`",
        "bits of its own",
        False,
    ),
    "addresses overlap": (
        public("@x = 0x1: u64 READ();", "@y = 0x2: READ();"),
        ("UL051", 3, 9),
        "where `x` is",
        "another address",
        False,
    ),
    "duplicate": (public("@x = 0x1: READ();", "@x = 0x2: READ();"), ("UL021", 3, 5), "twice", "name", False),
    "default out of the type": (
        public("@x = 0x1: u8 WRITE(INITIAL=300);"),
        ("UL090", 2, 31),
        "from 0 to 255",
        "wider type",
        False,
    ),
    "default out of the limits": (
        public("@x = 0x1: i16 WRITE(MIN=-5, MAX=5, INITIAL=6);"),
        ("UL090", 2, 47),
        "above MAX 5",
        "within the limits",
        False,
    ),
    "field wider than its bits": (
        "bits s: u8 { a: u4 @ 2..0; }\n" + public("@x = 0x1: s READ();"),
        ("UL086", 1, 22),
        "4 bits but is given 3",
        "3..0",
        False,
    ),
    "value too wide": (
        "enum m: u2 { a = 4; }\n" + public("@x = 0x1: m READ();"),
        ("UL049", 1, 18),
        "is 4",
        "0 to 3",
        False,
    ),
    "wrong number of arguments": (
        public("j: joint() @ (0x1);") + JOINT,
        ("UL030", 2, 7),
        "1 argument but is given 0",
        "joint(name)",
        False,
    ),
    "unit of another quantity": (
        public("@x = 0x1: i16 READ(UNIT='rad', MAX=3 A);"),
        ("UL088", 2, 39),
        "does not measure the same",
        "in `rad`",
        False,
    ),
    "unknown unit": (public("@x = 0x1: i16 READ(UNIT='radd');"), ("UL087", 2, 28), "radd", "`rad`", False),
    "unit by its name": (public("@x = 0x1: i16 READ(UNIT='Volt');"), ("UL087", 2, 28), "Volt", "`V`", True),
    "unit by its names": (
        public("@x = 0x1: i16 READ(UNIT='Degrees per second');"),
        ("UL087", 2, 28),
        "Degrees",
        "`deg/s`",
        True,
    ),
    "unit without quotes": (
        public("@x = 0x1: i16 READ(UNIT=rad/s);"),
        ("UL025", 2, 28),
        "`rad/s`",
        '`"rad/s"`',
        True,
    ),
    "unit by its name without quotes": (
        public("@x = 0x1: i16 READ(UNIT=Volt);"),
        ("UL025", 2, 28),
        "`Volt`",
        '`"V"`',
        True,
    ),
    "unit with a power without quotes": (
        public("@x = 0x1: i16 READ(UNIT=m/s^2);"),
        ("UL004", 2, 31),
        "`^`",
        '"m/s^2"',
        False,
    ),
    "rate without its unit": (
        public("@x = 0x1: READ(PUBLISH(100));"),
        ("UL010", 2, 27),
        "rate with its unit",
        "`PUBLISH(100 Hz)`",
        True,
    ),
    "rate in a wrong unit's capitals": (
        public("@x = 0x1: READ(PUBLISH(100hz));"),
        ("UL008", 2, 27),
        "`100hz`",
        "`100 Hz`",
        True,
    ),
    "time for a rate": (
        public("@x = 0x1: READ(PUBLISH(10 ms));"),
        ("UL088", 2, 27),
        "a time",
        "`PUBLISH(100 Hz)`",
        False,
    ),
    "unit of two words without quotes": (
        public("@x = 0x1: i16 READ(UNIT=N m);"),
        ("UL010", 2, 30),
        "`m`",
        '`"N m"`',
        True,
    ),
    "power without its sign": (
        public("@x = 0x1: i16 READ(UNIT='m/s2');"),
        ("UL087", 2, 28),
        "m/s2",
        "`m/s^2`",
        True,
    ),
    "access without brackets": (
        public("@x = 0x1: READ;"),
        ("UL010", 2, 18),
        "expected `(`",
        "`READ()`",
        True,
    ),
    "truth by another name": (
        public("@x = 0x1: bool WRITE(INITIAL=on);"),
        ("UL025", 2, 33),
        "`on`",
        "`true`",
        True,
    ),
    "all words of a block": (
        public("e: quadrature_encoder() @ (0xF0,0xF1);", "f: quadrature_encoder();"),
        ("UL031", 2, 28),
        "block of words",
        "`@ (0xF0)`",
        False,
    ),
    "mode without its divisor": (
        public("@x = 0x1: READ(PUBLISH(1));"),
        ("UL010", 2, 28),
        "divisor",
        "`PUBLISH(1, 10)`",
        False,
    ),
    "nothing in PUBLISH": (
        public("@x = 0x1: READ(PUBLISH());"),
        ("UL010", 2, 27),
        "how it is published",
        "`PUBLISH(100 Hz)`",
        False,
    ),
    "enumeration without a type": (
        "enum mode { idle = 0; run = 1; stop = 4; }\n" + public("@x = 0x1: mode READ();"),
        ("UL010", 1, 6),
        "`mode` has no type",
        "`mode: u3 {`",
        True,
    ),
    "packed value without a type": (
        "bits status { ready: bool @ 0; level: u4 @ 7..4; }\n" + public("@x = 0x1: status READ();"),
        ("UL010", 1, 6),
        "`status` has no type",
        "`status: u8 {`",
        True,
    ),
    "component by a part of its name": (
        public("e: encoder();", "q: quadrature_encoder();"),
        ("UL024", 2, 7),
        "`encoder`",
        "`quadrature_encoder`",
        True,
    ),
    "block never closed": (
        "public a() {\n   j: joint('one') @ (0x1);\n\n" + JOINT,
        ("UL012", 1, 12),
        "never closed",
        "add `}`",
        False,
    ),
    "string never closed": (
        public('@x = 0x1: READ(ID="x);'),
        ("UL006", 2, 22),
        "does not end",
        'with "',
        False,
    ),
    "hexadecimal forgotten": (public("@x = 10: READ();"), ("UL019", 2, 9), "hexadecimal", "0x10", False),
}


def test_place_cause_and_remedy() -> None:
    for mistake, (text, place, cause, remedy, _) in CORPUS.items():
        found = compile_text(text).diagnostics
        assert [(one.code, one.span.line, one.span.column) for one in found] == [place], mistake
        assert cause in found[0].message, mistake
        assert remedy in found[0].hint, mistake


def test_what_a_machine_can_mend_it_mends() -> None:
    mendable = {mistake: text for mistake, (text, *_, mends) in CORPUS.items() if mends}
    assert len(mendable) > 20
    for mistake, text in mendable.items():
        fixed = fix_text(text)
        assert len(fixed.made) == 1, mistake
        assert fixed.result.diagnostics == (), mistake


def test_all_of_them_in_one_run() -> None:
    """Ten different mistakes in the members of one constructor give ten diagnostics, each in its line."""
    lines = [text.splitlines()[1].strip() for text, place, *_ in CORPUS.values() if place[1] == 2]
    mistakes = [
        line.replace("@x", f"@x{i}").replace("0x1:", f"0x{i + 16:X}:") for i, line in enumerate(lines)
    ]
    found = compile_text(public(*mistakes) + JOINT).diagnostics
    assert len(mistakes) >= 10
    assert [one.span.line for one in found] == list(range(2, len(mistakes) + 2))
