# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink diff`: every kind of difference, which of them break something, and what is no difference."""

from __future__ import annotations

import json
import random
import re
from dataclasses import replace
from pathlib import Path

import pytest

from unitylink import cli
from unitylink.spec import Spec, compile_text, format_text
from unitylink.spec.report.diff import Change, compare
from unitylink.spec.types import EnumType, EnumValue, Field, ValueType

SCARA = (Path(__file__).parents[3] / "examples" / "scara" / "scara.ul").read_text("utf-8")


def spec_of(text: str) -> Spec:
    result = compile_text(text, "scara.ul")
    assert result.spec is not None, result.diagnostics
    return result.spec


def changes(old: str, new: str) -> list[tuple[str, str, str, bool]]:
    return [(c.kind, c.path, c.what, c.compatible) for c in compare(spec_of(old), spec_of(new))]


DIFFERENCES = {
    "address": (("0x88,", "0x98,"), [("moved", "scara.j1.cpos", "address", False)]),
    "one name": (
        ("joint(name): @ (spd,", "joint(name): @ (speed,"),
        [("renamed", f"scara.j{i}.speed", "name", True) for i in range(1, 5)],
    ),
    "access": (
        ("@spd_sp: WRITE(", "@spd_sp: READ("),
        [("changed", f"scara.j{i}.spd_sp", "access", False) for i in range(1, 5)],
    ),
    "sign": (
        ("signed WRITE", "WRITE"),
        [("changed", f"scara.j{i}.pos_sp", "type", False) for i in range(1, 5)],
    ),
    "rate": (
        ('name+":spd", PUBLISH(1,10)', 'name+":spd", PUBLISH(1,20)'),
        [("changed", f"scara.j{i}.spd", "publish", True) for i in range(1, 5)],
    ),
    "display": (
        ('"joint 2"', '"elbow"'),
        [("changed", f"scara.j2.{m}", "display", True) for m in ("cpos", "spd", "pos_sp", "spd_sp")],
    ),
    "removed": (
        ('   j4: joint("joint 4") @ (0x83,0x8B,0x8F,0x97);\n', ""),
        [("removed", f"scara.j4.{m}", "", False) for m in ("cpos", "spd", "pos_sp", "spd_sp")],
    ),
    "added": (
        ("}\njoint", "   @lamp = 0x200: WRITE();\n   both = j1.cpos, j2.cpos;\n}\njoint"),
        [("added", "scara.lamp", "", True), ("added", "scara.both", "group", True)],
    ),
    "link": (
        ("   TOSNET(CTRL=ctrl, COMM=comm, BASE=0);\n", ""),
        [
            ("changed", f"scara.j{i}.{m}", "link", False)
            for i in range(1, 5)
            for m in ("cpos", "spd", "pos_sp", "spd_sp")
        ]
        + [("changed", "scara", "parameters", True)],
    ),
}


@pytest.mark.parametrize("name", DIFFERENCES)
def test_difference(name: str) -> None:
    (before, after), expected = DIFFERENCES[name]
    new = SCARA.replace(before, after, 1).replace("@spd:", "@speed:" if "speed" in after else "@spd:")
    assert new != SCARA
    assert changes(SCARA, new) == expected


def test_layout_order_and_comments_are_no_difference() -> None:
    lines = SCARA.splitlines()
    body = lines[2:6]
    random.Random(1).shuffle(body)
    other = "\n".join(["link other.name;", *lines[:2], "// a comment", *body, *lines[6:]])
    assert changes(SCARA, other.replace("   ", "\t").replace(";", " ;")) == []
    assert changes(SCARA, format_text(SCARA)) == []


def _typed(kind: ValueType) -> Spec:
    """Return a spec with one element of the given type."""
    spec = spec_of("public a() { @x = 0x1: READ(); }")
    (root,) = spec.roots
    return replace(spec, roots=(replace(root, members=(replace(root.elements[0], type=kind),)),))


def _change(old: ValueType, new: ValueType) -> Change | None:
    found = compare(_typed(old), _typed(new))
    assert len(found) <= 1
    return found[0] if found else None


def test_enumerations_and_fields() -> None:
    def enum(*names: str, opened: bool = False) -> ValueType:
        values = tuple(EnumValue(name, number) for number, name in enumerate(names))
        return ValueType("enum", 8, enum=EnumType("mode", 8, values, opened), name="mode")

    closed = _change(enum("idle", "run"), enum("idle", "run", "stop"))
    assert closed is not None and not closed.compatible and "stop=2" in closed.after
    opened = _change(enum("idle", opened=True), enum("idle", "run", opened=True))
    assert opened is not None and opened.compatible
    documented = EnumType("mode", 8, (EnumValue("idle", 0, "rests"), EnumValue("run", 1)), documentation="x")
    assert _change(enum("idle", "run"), replace(enum("idle"), enum=documented)) is None

    def bits(*fields: Field) -> ValueType:
        return ValueType("bits", 8, fields=fields, name="status")

    ready, count = Field("ready", ValueType("bool", 1), 0, 0), Field("count", ValueType("uint", 4), 4, 7)
    added = _change(bits(ready), bits(ready, count))
    assert added is not None and added.compatible
    moved = _change(bits(ready), bits(replace(ready, low=1, high=1)))
    assert moved is not None and not moved.compatible and moved.after == "ready bool @ 1..1"
    narrowed = _change(ValueType("int", 32), ValueType("int", 16))
    assert (
        narrowed is not None
        and (narrowed.before, narrowed.after) == ("i32", "i16")
        and not narrowed.compatible
    )


def test_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    old, new = tmp_path / "old.ul", tmp_path / "new.ul"
    old.write_text(SCARA, "utf-8")
    new.write_text(SCARA.replace("0x88,", "0x98,").replace('"joint 2"', '"elbow"'), "utf-8")
    assert cli.main(["diff", str(old), str(new)]) == 1
    out = capsys.readouterr().out
    assert re.search(r"moved +breaks +scara\.j1\.cpos +address +0x0088 -> 0x0098\n", out)
    assert "5 differences, 1 of them break" in out
    assert cli.main(["diff", str(old), str(old)]) == 0
    assert "no difference" in capsys.readouterr().out
    new.write_text(SCARA.replace('"joint 2"', '"elbow"'), "utf-8")
    assert cli.main(["diff", str(old), str(new)]) == 0
    assert "4 differences, wire-compatible" in capsys.readouterr().out
    assert cli.main(["diff", str(old), str(new), "--strict", "--json"]) == 1
    report = json.loads(capsys.readouterr().out)
    assert report["compatible"] is True and len(report["changes"]) == 4
    assert report["changes"][0] == {
        "kind": "changed",
        "path": "scara.j2.cpos",
        "what": "display",
        "before": "joint 2:cpos",
        "after": "elbow:cpos",
        "compatible": True,
    }
    new.write_text("public", "utf-8")
    assert cli.main(["diff", str(old), str(new)]) == 1
    assert "UL010" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "what", "shown"),
    [
        ("RINGS=2", "rings", ("1", "2")),
        ("CHECK_BYTES=2", "check_bytes", ("1", "2")),
        ("TIME=0x40", "time", ("", "64")),
        ("BAUD=25 MHz", "baud_hz", ("", "25000000")),
    ],
)
def test_what_a_ring_is_like_is_a_difference(options: str, what: str, shown: tuple[str, str]) -> None:
    text = "public net(u) { TOSNET(COMM=u, NODES=ring); @a = 0x80: READ(); }"
    (one,) = compare(spec_of(text), spec_of(text.replace("=ring", f"=ring, {options}")))
    assert (one.path, one.what) == ("net(u)", f"{what} of the ring at 0x0")
    assert (one.before, one.after, one.compatible) == (*shown, False)
