# SPDX-License-Identifier: BSD-3-Clause
"""All mistakes are found in one run, and each gives one diagnostic."""

from __future__ import annotations

import re
from pathlib import Path

from unitylink.spec import compile_text

SCARA = (Path(__file__).parents[3] / "examples" / "scara" / "scara.ul").read_text("utf-8")


def found(text: str) -> list[tuple[str, int]]:
    return [(d.code, d.span.line) for d in compile_text(text).diagnostics]


def test_all_mistakes_in_one_run() -> None:
    text = """public robot(ctrl,comm) {
   TOSNET(CTRL=ctrl, COM=comm, BASE=0);
   j1: joint("joint 1" @ (0x80,0x88);
   j2: joint("joint 2") @ (0x81,0x89)
   j3 joint("joint 3") @ (0x82,0x8A);
   j4: jiont("joint 4") @ (0x83,0x8B);
   j5: joint("joint 5") @ (0x84,130);
   j6: joint(5) @ (0x85,0x8D);
   j7: joint("joint 7") @ (0x86);
   @z = 0x10: read(ID="z");
   all = ALL(joint).cpos, j2.speed;
   v: READ();
}
joint(name): @ (spd,cpos) {
   @cpos: signed READ(ID=nam+":cpos", PUBLISH(4,10));
   @spd: READ(ID=name+":spd, PUBLISH(1,10));
   @acc: READ();
"""
    assert found(text) == [
        ("UL015", 2),
        ("UL010", 3),
        ("UL011", 4),
        ("UL010", 5),
        ("UL024", 6),
        ("UL019", 7),
        ("UL047", 8),
        ("UL031", 9),
        ("UL010", 10),
        ("UL027", 11),
        ("UL010", 12),
        ("UL012", 14),
        ("UL025", 15),
        ("UL061", 15),
        ("UL006", 16),
        ("UL026", 17),
    ]


ONE = {
    "semicolon after constructor": (SCARA.replace("}\njoint", "};\njoint"), "UL010", 7),
    "head without colon": (SCARA.replace("joint(name): @", "joint(name) @"), "UL010", 8),
    "head without brace": (SCARA.replace("spd_sp) {", "spd_sp)"), "UL010", 8),
    "head without bracket": (SCARA.replace("joint(name)", "joint(name"), "UL010", 8),
    "head without parameters": (SCARA.replace("joint(name)", "joint"), "UL010", 8),
    "first brace never closed": (SCARA.replace("}\njoint", "joint"), "UL012", 1),
    "brace too much": (SCARA + "}\n", "UL013", 14),
    "expansion without bracket": (SCARA.replace('"joint 2")', '"joint 2"'), "UL010", 4),
    "address list without bracket": (SCARA.replace("0x95);", "0x95;"), "UL010", 4),
    "element without @": (SCARA.replace("@cpos:", "cpos:"), "UL010", 9),
    "element without semicolon": (SCARA.replace('spd_SP");', 'spd_SP")'), "UL011", 12),
    "string not closed": (SCARA.replace('"joint 3"', '"joint 3'), "UL006", 5),
    "comment not closed": (SCARA.replace("joint(name)", "/* joint(name)"), "UL005", 8),
    "wrong character in a head": (SCARA.replace("joint(name)", "joint[name)"), "UL010", 8),
    "wrong character for a brace": (SCARA.replace("}\njoint", "]\njoint"), "UL010", 7),
    "wrong character in place of public": (SCARA.replace("public", "§"), "UL004", 1),
    "keyword in small letters": (SCARA.replace("TOSNET(", "tosnet("), "UL010", 2),
    "constructor misspelt everywhere": (SCARA.replace("joint(name)", "join(name)"), "UL024", 3),
    "parameter misspelt in its head": (SCARA.replace("joint(name)", "joint(nam)"), "UL025", 9),
    "parameter missing in its head": (
        SCARA.replace("joint(name)", "joint()").replace("name+", ""),
        "UL030",
        8,
    ),
    "comma missing in addresses": (SCARA.replace("(spd,cpos", "(spd cpos"), "UL010", 8),
    "address missing in its head": (
        SCARA.replace("spd_sp) {", ") {").replace("pos_sp,)", "pos_sp)"),
        "UL031",
        8,
    ),
    "semicolon in arguments": (SCARA.replace('"joint 1")', '"joint 1";)'), "UL010", 3),
    "semicolon for a comma": (SCARA.replace("0x80,", "0x80;"), "UL010", 3),
    "semicolon for a colon": (SCARA.replace("j1:", "j1;"), "UL010", 3),
    "semicolon between properties": (SCARA.replace('cpos", ', 'cpos"; '), "UL010", 9),
    "semicolon in PUBLISH": (SCARA.replace("PUBLISH(1,", "PUBLISH(1;", 1), "UL010", 9),
    "semicolon in TOSNET": (SCARA.replace("ctrl, ", "ctrl; "), "UL010", 2),
    "semicolon before addresses": (SCARA.replace('1") @', '1"); @'), "UL010", 3),
    "semicolon after READ": (SCARA.replace("@spd: READ", "@spd: READ;"), "UL010", 10),
    "semicolon after signed": (SCARA.replace("signed READ", "signed; READ"), "UL010", 9),
    "brace in arguments": (SCARA.replace('"joint 1")', '"joint 1"})'), "UL010", 3),
    "brace for a bracket": (SCARA.replace("0x94)", "0x94}"), "UL010", 3),
    "brace in an address list": (SCARA.replace("0x88,", "0x88},"), "UL010", 3),
    "brace for a semicolon": (SCARA.replace("0x94);", "0x94)}"), "UL010", 3),
    "brace between properties": (SCARA.replace('cpos", ', 'cpos"}, '), "UL010", 9),
    "brace too early": (SCARA.replace("0x94);", "0x94);}"), "UL013", 3),
    "braces for brackets": (SCARA.replace('("joint 1")', '{"joint 1"}'), "UL010", 3),
    "head lost": (SCARA.replace("joint(name): @ (spd,cpos,pos_sp,spd_sp) {", ""), "UL013", 7),
    "constructor within another": (
        SCARA.replace("   j1:", "   inner() {\n      @x = 0x98: READ();\n   }\n   j1:").replace(
            "   j4", "   i: inner();\n   j4"
        ),
        "UL010",
        3,
    ),
    "public member": (SCARA.replace("j1:", "public j1:"), "UL010", 3),
    "READ without @": (SCARA.replace('j1: joint("joint 1") @', "j1: WRITE() @"), "UL010", 3),
    "foreign brackets": (SCARA.replace("(0x80,0x88,0x8C,0x94)", "[0x80,0x88,0x8C,0x94]"), "UL010", 3),
    "foreign hexadecimal": (SCARA.replace("0x80", "$80"), "UL004", 3),
    "foreign comment": (SCARA.replace("BASE=0);", "BASE=0);  # node 1; node 2: (left)"), "UL004", 2),
    "nested comment": (SCARA.replace("j1:", "/* /* */ */ j1:"), "UL004", 3),
    "address named twice": (SCARA.replace("(spd,cpos", "(spd,spd"), "UL023", 8),
    "address named once too often": (SCARA.replace("(spd,cpos", "(spd,spd,cpos"), "UL023", 8),
    "member named twice": (
        SCARA.replace("j2:", "j1:").replace("}\njoint", "   g = j2.spd;\n}\njoint"),
        "UL021",
        4,
    ),
    "string not closed takes the last brace": (SCARA.replace('spd_SP");\n}', "spd_SP);}"), "UL006", 12),
    "curly quotes": (SCARA.replace('"joint 2"', "“joint 2”"), "UL004", 4),
    "garbage between": (SCARA.replace("}\njoint", "}\nfoo bar 0x3;\njoint"), "UL010", 8),
}


def test_one_mistake_is_one_diagnostic() -> None:
    for name, (text, code, line) in ONE.items():
        assert text != SCARA, name
        assert found(text) == [(code, line)], name


def test_no_wrong_character_anywhere_makes_a_second_diagnostic() -> None:
    """A character that belongs to no token is put between any two tokens.

    It gives one diagnostic and not two.
    """
    for match in re.finditer(r"\w+|[^\w\s]", SCARA):
        inside_string = SCARA.count('"', 0, match.start()) % 2
        if not inside_string:
            text = SCARA[: match.start()] + "§" + SCARA[match.start() :]
            assert [code for code, _ in found(text)] == ["UL004"], text[: match.start() + 20]


def test_a_lost_token_is_seldom_more_than_one_diagnostic() -> None:
    counts: list[int] = []
    for match in re.finditer(r'"[^"]*"|\w+|[^\w\s]', SCARA):
        text = SCARA[: match.start()] + " " + SCARA[match.end() :]
        counts.append(len(found(text)))
    # Without `signed`, the spec is different but still valid.
    assert counts.count(0) <= 2
    assert sum(count > 1 for count in counts) <= len(counts) * 0.05


def test_broken_member_keeps_its_name() -> None:
    text = "public a() {\n   @x = 0x1: READ(;\n   both = x, y;\n   @y = 0x2: READ();\n}\n"
    assert found(text) == [("UL010", 2)]


def test_unused_things_are_not_reported_beside_errors() -> None:
    text = "public a(unused) {\n   @x: READ();\n}\nalso(): @ (unused) {\n}\n"
    assert found(text) == [("UL026", 2)]


def test_near_misses() -> None:
    def hint(text: str) -> str:
        return compile_text(text).diagnostics[0].hint

    assert hint("public a() { x: red(); }") == "did you mean `READ`?"
    assert (
        hint("public a() { j: Joint() @ (0x1); } joint(): @ (x) { @x: READ(); }") == "did you mean `joint`?"
    )
    assert hint("public a() { @x = 0x1: READ(Id='x'); }") == "did you mean `ID`?"
    assert hint("public a(c) { TOSNET(BAES=1); }") == "did you mean `BASE`?"
    assert hint("public a() { @x = 0x1: READ(); g = qqqq; }") == "its members are `x`"
    assert "capitals" in hint("public a() { @x: read(ID='x'); }")
    assert hint("public a() { @x = 0x1: RAED(); }") == "did you mean `READ`?"
    assert hint("public a() { @x = 0x1: Signed READ(); }") == "did you mean `signed`?"
    assert (
        hint("public a() { @x = 0x1: unsigned READ(); }") == "words are unsigned without `signed`: remove it"
    )
    assert hint("public a() { @x = 0x1: READ signed(); }") == "write `signed READ`"
    assert hint("Public a() { @x = 0x1: READ(); }") == "did you mean `public`?"
    assert hint("public a(c) { tosnet(CTRL=c); }") == "did you mean `TOSNET`?"
    assert hint("public a() { g = all(j); }") == "did you mean `ALL`?"
    assert hint("public a() { j = joint(); }") == "an expansion is written `j: joint(…)`"
    assert hint("public a() { @x = 0x1: READ(CRC,); }") == "remove the `,`"
    assert "comments are" in hint("public a() { # comment\n }")


def test_what_cannot_begin_anything_is_pointed_at() -> None:
    diagnostics = compile_text("public a() {\n   @x = 0x1: READ();\n   link b;\n}\n").diagnostics
    assert [(d.span.line, d.span.column) for d in diagnostics] == [(3, 4)]
