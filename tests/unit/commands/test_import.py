# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink import`: the result is the same map, compared with SystemRDL's own tree."""

from __future__ import annotations

from pathlib import Path

import pytest
from systemrdl.node import AddrmapNode, MemNode, RegNode

from unitylink import cli
from unitylink.commands.failure import Failure
from unitylink.commands.systemrdl import read_systemrdl, write_spec
from unitylink.spec import Element, Spec, compile_text, format_text

UART = Path(__file__).parent / "rdl" / "uart.rdl"

# Wide words, nested address maps, names that are keywords of UL-spec, and 16-bit registers.
OTHERS = {
    "nested": """
        regfile pair {
          reg { field {sw=rw;hw=r;} a[3:0]; field {sw=rw;hw=r;} b[9:4]; } low;
          reg { field {sw=r;hw=w;} x[31:0]; } high;
        };
        regfile two { pair left; pair right; };
        addrmap inner { two both[2]; };
        addrmap outer { inner first @0x0; inner second @0x100; };
    """,
    "sixteen": """
        addrmap small {
          default regwidth = 16;
          reg { field {sw=rw;hw=r;} v[15:0] = 3; } a;
          reg { regwidth = 32; field {sw=r;hw=w;} v[31:0]; } wide @0x4;
        };
    """,
    "words": """
        addrmap ALL {
          reg { field {sw=rw;hw=r;} READ[3:0]; field {sw=rw;hw=r;} CRC[9:4]; } ID;
          reg { field {sw=rw;hw=r;} at[31:0]; } at;
        };
    """,
}


def spec_of(text: str) -> Spec:
    result = compile_text(text, "x.ul")
    assert result.spec is not None, result.diagnostics
    return result.spec


def registers(top: AddrmapNode) -> list[tuple[int, int, tuple[tuple[int, int], ...]]]:
    """Return (byte address, bits, fields as (low, high)) of every register, arrays unrolled."""
    found = []
    for node in top.descendants(unroll=True):
        if isinstance(node, RegNode):
            fields = tuple(sorted((field.low, field.high) for field in node.fields()))
            found.append((node.absolute_address, node.get_property("regwidth"), fields))
        elif isinstance(node, MemNode):
            width = node.get_property("memwidth")
            addresses = range(node.get_property("mementries"))
            found += [(node.absolute_address + i * width // 8, width, ((0, width - 1),)) for i in addresses]
    return sorted(found)


def fields_of(element: Element) -> tuple[tuple[int, int], ...]:
    kind = element.type
    if kind.fields:
        return tuple(sorted((field.low, field.high) for field in kind.fields))
    return ((0, kind.width - 1),)


def same_map(top: AddrmapNode, spec: Spec) -> None:
    word = spec.links[0].data_bits // 8
    elements = sorted((e.address * word, fields_of(e)) for _, e in spec.walk())
    assert elements == [(address, fields) for address, _, fields in registers(top)]


def test_uart() -> None:
    top = read_systemrdl(str(UART))
    imported = write_spec(top)
    spec = spec_of(imported.text)
    same_map(top, spec)
    assert format_text(imported.text) == imported.text
    by_path = dict(spec.walk())
    ctrl = by_path["ctrl"]
    assert (ctrl.access, ctrl.initial, ctrl.display) == ("READWRITE", 5, 'Control "x" (i)')
    assert ctrl.documentation == "What the UART does.\nSecond line."
    enable, baud, busy = ctrl.type.fields
    assert (enable.documentation, baud.type.text, busy.type.kind) == ("On or off", "baud_e", "bool")
    assert baud.type.enum is not None and baud.type.enum.open
    assert [(v.name, v.value, v.documentation) for v in baud.type.enum.values] == [
        ("slow", 0, "9600"),
        ("fast", 1, ""),
    ]
    assert by_path["ctrl2"].type == ctrl.type
    assert [
        by_path[p].access for p in ("lost", "READ", "ch[2].flags", "ch[0].start", "time", "ch[1].data")
    ] == [
        "READCLEAR",
        "READWRITE",
        "W1C",
        "PULSE",
        "READ",
        "READ",
    ]
    assert by_path["ch[2].flags"].address == (0x20 + 2 * 0x10 + 4) // 4
    assert (by_path["time"].words, by_path["buffer[7]"].address) == (2, 0x47)
    assert spec.root().documentation == "A serial port."
    assert [note.split(":")[0] for note in imported.notes] == ["uart.ctrl", "uart.ctrl2"]


@pytest.mark.parametrize("name", OTHERS)
def test_other_maps(name: str, tmp_path: Path) -> None:
    file = tmp_path / "x.rdl"
    file.write_text(OTHERS[name], "utf-8")
    top = read_systemrdl(str(file))
    spec = spec_of(write_spec(top).text)
    same_map(top, spec)
    assert spec.name == top.inst_name


def test_equal_blocks_become_one_constructor(tmp_path: Path) -> None:
    file = tmp_path / "x.rdl"
    file.write_text(OTHERS["nested"], "utf-8")
    text = write_spec(read_systemrdl(str(file))).text
    assert text.count("\npair():") == 1 and text.count("\ninner():") == 1


WRONG = {
    "syntax": ("addrmap x { reg { } ", "does not compile as SystemRDL"),
    "unknown type": ("addrmap x { regg r; };", "regg"),
    "two fields at a place": (
        "addrmap x { reg { field {sw=r;hw=w;} a[3:0]; field {sw=r;hw=w;} b[4:2]; } q; };",
        "overlaps",
    ),
    "perl": ("<% print 1; %> addrmap x { reg { field {sw=r;hw=w;} a[3:0]; } q; };", "embeds Perl"),
    "too wide": ("addrmap x { reg { regwidth=128; field {sw=r;hw=w;} a[127:0]; } q; };", "at most 64"),
    "nothing": ("", "does not compile as SystemRDL"),
    "not text": ("\udcff", "not UTF-8"),
    "what the compiler itself ends at": (
        UART.read_text("utf-8").replace("fast = 2'd1", "fast =,;1"),
        "cannot be read|does not compile as SystemRDL",  # its C++ half reads memory that it never wrote
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_cannot_be_imported_is_told(name: str, tmp_path: Path) -> None:
    text, expected = WRONG[name]
    file = tmp_path / "x.rdl"
    file.write_bytes(text.encode("utf-8", "surrogateescape"))
    with pytest.raises(Failure, match=expected):
        write_spec(read_systemrdl(str(file)))


def test_an_error_that_is_not_the_compilers_own_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    def ends(*_: object, **__: object) -> None:
        raise TypeError("CommonToken is not a subtype of type")

    monkeypatch.setattr("systemrdl.compiler.RDLCompiler.compile_file", ends)
    with pytest.raises(Failure, match=r"uart\.rdl cannot be read: CommonToken"):
        read_systemrdl(str(UART))


def test_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "uart.ul"
    assert cli.main(["import", str(UART)]) == 0
    printed, notes = capsys.readouterr()
    assert "note: uart.ctrl: busy cannot be written" in notes
    assert cli.main(["import", str(UART), "--out", str(out)]) == 0
    assert out.read_text("utf-8") == printed
    assert cli.main(["check", str(out)]) == 0
    assert cli.main(["import", str(UART), "--out", str(out)]) == 1
    assert "exists" in capsys.readouterr().err
    assert cli.main(["import", str(UART), "--top", "nowhere"]) == 1
    assert cli.main(["import", str(tmp_path / "none.rdl")]) == 1
    capsys.readouterr()
