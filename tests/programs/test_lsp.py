# SPDX-License-Identifier: BSD-3-Clause
"""The language server as an editor uses it: a process with messages on its standard input and output."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

import pytest
from effort import many
from hypothesis import given, settings
from hypothesis import strategies as st

from unitylink.commands.language_server.completion import completion
from unitylink.commands.language_server.document import Document
from unitylink.commands.language_server.edits import fixes, formatting
from unitylink.commands.language_server.hover import hover
from unitylink.spec import compile_file, compile_text, format_text
from unitylink_lab.bench.figure import BenchError
from unitylink_lab.bench.language_client import LanguageClient

SCARA = (Path(__file__).parents[2] / "examples" / "scara" / "scara.ul").read_text("utf-8")
URI = "file:///robots/scara.ul"


@pytest.fixture(scope="module")
def server() -> Iterator[LanguageClient]:
    with LanguageClient() as client:
        assert client.capabilities["positionEncoding"] == "utf-16"
        yield client


@pytest.fixture
def client(server: LanguageClient) -> Iterator[LanguageClient]:
    """The server with the SCARA's spec open."""
    assert server.open(URI, SCARA) == []
    yield server
    server.notify("textDocument/didClose", {"textDocument": {"uri": URI}})


def position(text: str, at: str, inside: int = 0) -> dict[str, int]:
    """Return the place of the first `at` in a text of ASCII characters."""
    offset = text.index(at) + inside
    return {"line": text.count("\n", 0, offset), "character": offset - (text.rfind("\n", 0, offset) + 1)}


def ask(client: LanguageClient, method: str, at: str, inside: int = 0, text: str = SCARA, **more: Any) -> Any:
    place = {"textDocument": {"uri": URI}, "position": position(text, at, inside), **more}
    return client.request(f"textDocument/{method}", place)


def apply(text: str, edits: list[dict[str, Any]]) -> str:
    """Make the edits in a text of ASCII characters."""
    starts = [0]
    for line in text.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    for edit in sorted(edits, key=lambda e: tuple(e["range"]["start"].values()), reverse=True):
        ends = (edit["range"][key] for key in ("start", "end"))
        first, last = (starts[end["line"]] + end["character"] for end in ends)
        text = text[:first] + edit["newText"] + text[last:]
    return text


def test_diagnostics_follow_every_edit(client: LanguageClient) -> None:
    wrong = SCARA.replace("joint(name)", "jiont(name)").replace("BASE=0);", "BASE=0)")
    found = client.change(URI, 1, wrong)
    assert [(d["code"], d["range"]["start"]["line"], d["severity"]) for d in found] == [
        ("UL011", 1, 1),
        ("UL024", 2, 1),
    ]
    assert "did you mean `jiont`?" in found[1]["message"]
    assert client.change(URI, 2, SCARA) == []


def test_hover_shows_what_a_name_became(client: LanguageClient) -> None:
    value = ask(client, "hover", "@cpos", 2)["contents"]["value"]
    assert "**cpos** (element of `joint`)" in value
    assert "`scara.j1.cpos` at `0x88`" in value and "`scara.j4.cpos` at `0x8B`" in value
    assert "divisor 10" in value
    assert ask(client, "hover", "{") is None


def test_hover_answers_while_the_text_is_wrong(client: LanguageClient) -> None:
    wrong = SCARA.replace("PUBLISH(1,10)", "PUBLISH(1,", 1)
    assert client.change(URI, 1, wrong)
    assert "0x88" in ask(client, "hover", "@cpos", 2, text=wrong)["contents"]["value"]


def test_definition(client: LanguageClient) -> None:
    assert ask(client, "definition", 'joint("joint 1")')["range"]["start"] == position(SCARA, "joint(name)")
    assert ask(client, "definition", "@cpos", 1)["range"]["start"] == position(SCARA, "cpos,pos_sp")
    assert ask(client, "definition", "cpos,pos_sp")["range"]["start"] == position(SCARA, "@cpos", 1)
    assert ask(client, "definition", "0x80") is None


def test_references(client: LanguageClient) -> None:
    context = {"includeDeclaration": False}
    found = ask(client, "references", "joint(name)", context=context)
    assert [place["range"]["start"]["line"] for place in found] == [2, 3, 4, 5]
    assert len(ask(client, "references", "name+", context={"includeDeclaration": True})) == 5


def test_rename_everywhere(client: LanguageClient) -> None:
    edits = ask(client, "rename", "joint(name)", newName="axis")["changes"][URI]
    assert apply(SCARA, edits) == SCARA.replace("joint(", "axis(")
    edits = ask(client, "rename", "@cpos", 1, newName="READ")["changes"][URI]
    renamed = apply(SCARA, edits)
    assert "@^READ: signed" in renamed and "(spd,^READ,pos_sp" in renamed
    assert compile_text(renamed).diagnostics == ()


@pytest.mark.parametrize("name", ["spd", "1x", "a b", "", "x" * 101])
def test_rename_that_would_break_the_spec_is_refused(client: LanguageClient, name: str) -> None:
    with pytest.raises(BenchError, match=r"cannot be called|is not a name"):
        ask(client, "rename", "@cpos", 1, newName=name)


COMPLETIONS = {
    "top": ("", {"public", "link"}),
    "member": ("public a(c) {\n", {"TOSNET"}),
    "element": ("j(): @ (pos,spd) {\n@", {"pos", "spd"}),
    "after the colon": ("j(): @ (pos) {\n@pos: ", {"READ", "WRITE", "signed", "j"}),
    "property": ("j(n): @ (pos) {\n@pos: READ(", {"ID", "CRC", "PUBLISH"}),
    "second property": ("j(n): @ (pos) {\n@pos: READ(CRC, ", {"ID", "CRC", "PUBLISH"}),
    "argument": ("j(n,m): @ (pos) {\n@pos: READ(ID=", {"n", "m"}),
    "TOSNET": ("public a(c) {\nTOSNET(", {"CTRL", "COMM", "BASE"}),
    "COMM": ("public a(c) {\nTOSNET(COMM=", {"c"}),
    "constructor": ("j() {}\npublic a() {\nx: ", {"j", "a"}),
    "binding": ("j(): @l, @r {}\npublic a() {\nx: j() @", {"l", "r"}),
    "group": ("public a() {\n@x = 0x1: READ();\ng = ", {"x", "ALL"}),
    "path": ("j(): @ (p) { @p: READ(); }\npublic a() {\nx: j() @ (0x1);\ng = x.", {"p"}),
    "ALL": ("j() {}\npublic a() {\ng = ALL(", {"j", "a"}),
    "type": ("bits s: u8 { a: bool @ 0; }\npublic a() {\n@x = 0x1: ", {"s", "i16", "fixed", "READWRITE"}),
    "access": ("public a() {\n@x = 0x1: u8 ", {"READ", "W1C"}),
    "enum type": ("enum m: ", {"u8"}),
    "field": ("bits s: u8 { a: u4 @ 3..0 (", {"UNIT", "SCALE"}),
    "link": ("link a (", {"DATA", "BAUD"}),
    "value": ("enum m: u1 { on = 1; }\npublic a() {\n@x = 0x1: m WRITE(INITIAL=", {"on"}),
    "physical": ("link a (PHYSICAL=", {"rs485", "ft245_sync"}),
    "overflow": ("public a() {\n@x = 0x1: u8 WRITE(OVERFLOW=", {"saturate"}),
    "constant": ("const N = 3;\npublic a() {\n@x[", {"N"}),
    "argument by name": ("j(gear: int = 1) {}\npublic a() {\nx: j(", {"gear="}),
    "string": ('public a() {\n@x = 0x1: READ(ID="', set()),
    "comment": ("public a() {\n// ", set()),
}


@pytest.mark.parametrize("name", COMPLETIONS)
def test_completion(client: LanguageClient, name: str) -> None:
    text, expected = COMPLETIONS[name]
    for typed in ("", "p") if expected else ("",):
        client.change(URI, 1, text + typed)
        place = {"textDocument": {"uri": URI}, "position": position(text + typed + "$", "$")}
        found = {item["label"] for item in client.request("textDocument/completion", place) or ()}
        assert found >= expected and bool(found) == bool(expected)


def test_formatting(client: LanguageClient) -> None:
    ugly = SCARA.replace("   ", "").replace(", ", ",")
    client.change(URI, 1, ugly)
    parameters = {"textDocument": {"uri": URI}, "options": {"tabSize": 3, "insertSpaces": True}}
    assert apply(ugly, client.request("textDocument/formatting", parameters)) == format_text(ugly) == SCARA
    client.change(URI, 2, SCARA)
    assert client.request("textDocument/formatting", parameters) == []
    client.change(URI, 3, SCARA[:-3])
    assert client.request("textDocument/formatting", parameters) == []


def test_quick_fix_mends_the_text(client: LanguageClient) -> None:
    wrong = SCARA.replace("BASE=0);", "BASE=0)")
    client.change(URI, 1, wrong)
    place = position(wrong, "BASE=0)", 7)
    parameters = {
        "textDocument": {"uri": URI},
        "range": {"start": place, "end": place},
        "context": {"diagnostics": []},
    }
    (action,) = client.request("textDocument/codeAction", parameters)
    assert action["kind"] == "quickfix" and action["diagnostics"][0]["code"] == "UL011"
    assert apply(wrong, action["edit"]["changes"][URI]) == SCARA


def test_outline(client: LanguageClient) -> None:
    found = client.request("textDocument/documentSymbol", {"textDocument": {"uri": URI}})
    assert [(one["name"], len(one["children"])) for one in found] == [("scara", 4), ("joint", 4)]


ARM = (Path(__file__).parents[1] / "unit" / "generate" / "rich" / "arm.ul").read_text("utf-8")


def test_names_of_types_constants_and_values(client: LanguageClient) -> None:
    assert client.change(URI, 1, ARM) == []
    value = ask(client, "hover", "SAFE=stop", 6, text=ARM)["contents"]["value"]
    assert "**stop** (value of `mode`)" in value and "brakes on" in value
    value = ask(client, "hover", "@pos:", 1, text=ARM)["contents"]["value"]
    assert "Angle of the motor's shaft." in value
    assert "`arm.j[2].pos` at `0x90`, i16 READ, in rad, raw × 0.001, -3.14159 to 3.14159" in value
    target = ask(client, "definition", "SAFE=stop", 6, text=ARM)["range"]["start"]
    assert target == position(ARM, "stop = 3")
    target = ask(client, "definition", "j[JOINTS]", 3, text=ARM)["range"]["start"]
    assert target == position(ARM, "JOINTS = 3")
    edits = ask(client, "rename", "status: u16", text=ARM, newName="state_word")["changes"][URI]
    renamed = apply(ARM, edits)
    assert "bits state_word: u16" in renamed and "@state: state_word READ" in renamed
    assert compile_text(renamed).diagnostics == ()


def test_imported_files_are_followed(server: LanguageClient, tmp_path: Path) -> None:
    joint = tmp_path / "joint.ul"
    joint.write_text("/// One axis.\njoint(): @ (pos) {\n   @pos: READ();\n}\n", "utf-8")
    text = 'import "joint.ul";\npublic a() {\n   j: joint() @ (0x1);\n   all = j.pos;\n}\n'
    uri = (tmp_path / "a.ul").as_uri()
    assert server.open(uri, text) == []
    place = {"textDocument": {"uri": uri}, "position": {"line": 2, "character": 8}}
    found = server.request("textDocument/definition", place)
    assert found["uri"] == joint.as_uri() and found["range"]["start"] == {"line": 1, "character": 0}
    assert "One axis." in server.request("textDocument/hover", place)["contents"]["value"]
    joint.write_text("joint(): @ (pos) {\n   @pos: READ()\n}\n", "utf-8")
    (told,) = server.change(uri, 1, text)
    assert "joint.ul has 1 error" in told["message"]


@pytest.fixture
def workspace(tmp_path: Path) -> Path:
    """Two robots that share a joint, and a file that has nothing to do with it."""
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "joint.ul").write_text(
        "const STEP = 2;\njoint(n): @ (pos) {\n   @pos: READ(ID=n);\n}\n", "utf-8"
    )
    body = 'public {0}() {{\n   j: joint("x") @ (STEP);\n   all = ALL(joint).pos;\n}}\n'
    for name in ("left", "right"):
        (tmp_path / f"{name}.ul").write_text('import "parts/joint.ul";\n' + body.format(name), "utf-8")
    (tmp_path / "other.ul").write_text("public other() {\n   @joint = 0x1: READ();\n}\n", "utf-8")
    return tmp_path


def renamed(server: LanguageClient, folder: Path, at: tuple[str, str], new_name: str) -> dict[str, str]:
    """Open a file and rename what stands at `at`. Return the texts that change, by name."""
    file, what = at
    text = (folder / file).read_text("utf-8")
    uri = (folder / file).as_uri()
    server.open(uri, text)
    place = {"textDocument": {"uri": uri}, "position": position(text, what)}
    try:
        edits = server.request("textDocument/rename", {**place, "newName": new_name})["changes"]
    finally:
        server.notify("textDocument/didClose", {"textDocument": {"uri": uri}})
    texts = {}
    for changed, ours in edits.items():
        path = Path(unquote(urlsplit(changed).path))
        texts[str(path.relative_to(folder))] = apply(path.read_text("utf-8"), ours)
    return texts


def test_rename_reaches_every_spec_that_imports_the_name(server: LanguageClient, workspace: Path) -> None:
    texts = renamed(server, workspace, ("left.ul", "joint("), "axis")
    assert set(texts) == {"left.ul", "right.ul", "parts/joint.ul"}
    for name, text in texts.items():
        assert "axis(" in text and "joint(" not in text
        (workspace / name).write_text(text, "utf-8")
    for name in ("left.ul", "right.ul"):
        assert compile_file(workspace / name).diagnostics == ()


def test_rename_where_a_name_is_declared_reaches_those_who_import_it(
    server: LanguageClient, workspace: Path
) -> None:
    for path in [workspace / "left.ul", workspace / "right.ul", workspace / "other.ul"]:
        text = path.read_text("utf-8").replace("parts/joint.ul", "joint.ul")
        # the folder of the file becomes the workspace
        (workspace / "parts" / path.name).write_text(text, "utf-8")
    texts = renamed(server, workspace / "parts", ("joint.ul", "joint(n)"), "axis")
    assert set(texts) == {"left.ul", "right.ul", "joint.ul"}


def test_rename_is_refused_where_another_spec_would_be_wrong(server: LanguageClient, workspace: Path) -> None:
    right = workspace / "right.ul"
    right.write_text(right.read_text("utf-8") + "axis() { @x = 0x9: READ(); }\n", "utf-8")
    with pytest.raises(BenchError, match=r"cannot be called `axis`: .* in .*right\.ul"):
        renamed(server, workspace, ("left.ul", "joint("), "axis")
    assert set(renamed(server, workspace, ("left.ul", "STEP"), "STRIDE")) == {
        "left.ul", "right.ul", "parts/joint.ul",
    }  # fmt: skip


def test_rename_sees_what_the_editor_has_not_saved(server: LanguageClient, workspace: Path) -> None:
    joint = workspace / "parts" / "joint.ul"
    uri = joint.as_uri()
    # in the editor, the text is two lines further down than on the disk
    server.open(uri, "\n\n" + joint.read_text("utf-8"))
    try:
        text = (workspace / "left.ul").read_text("utf-8")
        ours = (workspace / "left.ul").as_uri()
        server.open(ours, text)
        place = {"textDocument": {"uri": ours}, "position": position(text, "joint(")}
        edits = server.request("textDocument/rename", {**place, "newName": "axis"})["changes"]
        assert [edit["range"]["start"]["line"] for edit in edits[uri]] == [3]
    finally:
        for one in (uri, ours):
            server.notify("textDocument/didClose", {"textDocument": {"uri": one}})


def test_names_of_the_library_stay(server: LanguageClient, workspace: Path) -> None:
    (workspace / "keys.ul").write_text("public keys() {\n   k: gpio(pins=4);\n}\n", "utf-8")
    with pytest.raises(BenchError, match="belongs to the component library"):
        renamed(server, workspace, ("keys.ul", "gpio"), "buttons")


def test_second_places_are_told(client: LanguageClient) -> None:
    (found,) = client.change(URI, 1, SCARA.replace("j2:", "j1:"))
    (label,) = found["relatedInformation"]
    assert label["location"]["range"]["start"] == position(SCARA, "j1:")


def test_columns_count_in_the_encoding_of_the_client(server: LanguageClient) -> None:
    text = 'public a() {\n   @x = 0x1: READ(ID="😀é", CRCC);\n}\n'
    before = '   @x = 0x1: READ(ID="😀é", '
    (found,) = server.open(URI, text)
    assert found["range"]["start"] == {"line": 1, "character": len(before.encode("utf-16-le")) // 2}
    with LanguageClient(encodings=["utf-8"]) as client:
        (found,) = client.open(URI, text)
        assert found["range"]["start"] == {"line": 1, "character": len(before.encode())}


def test_hostile_texts_and_places_are_answered(client: LanguageClient) -> None:
    for version, text in enumerate(["", "\0", "}" * 2000, "public a(" * 500, "é\u2028\x0b{", SCARA * 20]):
        client.change(URI, version, text)
        for line, character in ((0, 0), (0, 10**6), (10**6, 0)):
            place = {"textDocument": {"uri": URI}, "position": {"line": line, "character": character}}
            client.request("textDocument/hover", place)
            client.request("textDocument/completion", place)


@given(data=st.data())
@settings(max_examples=many(60), deadline=None)
def test_any_damaged_text_is_answered(data: st.DataObject) -> None:
    """While a user types, most texts are wrong.

    Whatever the editor asks about them, the server answers, if only with nothing.
    """
    from pygls.workspace import PositionCodec  # this takes long, so only one worker imports it

    text = data.draw(st.sampled_from([SCARA, ARM]))
    start = data.draw(st.integers(0, len(text)))
    end = data.draw(st.integers(start, min(len(text), start + 40)))
    document = Document(text[:start] + data.draw(st.text(max_size=4)) + text[end:], "x.ul", PositionCodec())
    for place in data.draw(st.lists(st.integers(0, len(document.text)), min_size=1, max_size=5)):
        assert document.offset(document.position(place)) <= len(document.text)
        completion(document, place)
        fixes(document, place, place)
        hover(document, place)
    formatting(document)
