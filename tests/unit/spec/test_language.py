# SPDX-License-Identifier: BSD-3-Clause
"""The meaning of specs: the examples, and each construct of the language."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import pytest

from unitylink.errors import SpecError
from unitylink.spec import Element, LinkBinding, Publish, Spec, compile_file, compile_text, load

ROOT = Path(__file__).parents[3]
SCARA = ROOT / "examples" / "scara" / "scara.ul"
GOLDEN = Path(__file__).parent / "golden" / "scara.json"


def clean(text: str, file: str = "<text>") -> Spec:
    """Compile a text that must give no diagnostic."""
    result = compile_text(text, file)
    assert result.diagnostics == ()
    assert result.spec is not None
    return result.spec


def words(spec: Spec) -> dict[str, int]:
    return {path: element.address for path, element in spec.walk()}


# --- the examples -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("path", sorted(ROOT.glob("examples/*/*.ul")), ids=lambda p: p.stem)
def test_examples_are_without_diagnostic(path: Path) -> None:
    result = compile_file(path)
    assert result.diagnostics == ()
    assert result.spec is not None
    assert result.spec.name == path.stem
    assert result.spec.source == path.name


def test_figure_1_as_printed_has_one_error_at_the_brace_of_joint() -> None:
    text = SCARA.read_text("utf-8")
    printed = text.rstrip().removesuffix("}")
    diagnostics = compile_text(printed, "scara.ul").diagnostics
    assert [d.code for d in diagnostics] == ["UL012"]
    brace = printed.index("{", printed.index("joint(name)"))
    assert diagnostics[0].span.start == brace
    assert (diagnostics[0].span.line, diagnostics[0].span.column) == (8, 41)
    assert "joint" in diagnostics[0].message
    assert diagnostics[0].hint == "add `}` at the end of the file"


def test_figure_1_compiles_to_the_golden_model() -> None:
    spec = clean(SCARA.read_text("utf-8"), "scara.ul")
    assert json.loads(GOLDEN.read_text("utf-8")) == json.loads(json.dumps(dataclasses.asdict(spec)))


def test_scara_in_words() -> None:
    root = load(SCARA).root()
    assert (root.name, root.constructor, root.parameters) == ("scara", "scara", ("ctrl", "comm"))
    assert root.link == LinkBinding("tosnet", 0, "ctrl", "comm")
    assert [instance.name for instance in root.instances] == ["j1", "j2", "j3", "j4"]
    j3 = root.instances[2]
    assert (j3.display, j3.constructor, j3.path, j3.parameters) == ("joint 3", "joint", "j3", ())
    assert {e.name: e.address for e in j3.elements} == {
        "spd": 0x82,
        "cpos": 0x8A,
        "pos_sp": 0x8E,
        "spd_sp": 0x96,
    }
    cpos = j3.elements[0]
    assert (cpos.path, cpos.access, cpos.signed, cpos.display) == ("j3.cpos", "READ", True, "joint 3:cpos")
    assert cpos.publish == Publish(1, 10, 100)
    assert j3.elements[1].signed is False
    assert j3.elements[2].publish is None


def test_walker_has_18_joints_in_about_23_lines() -> None:
    path = ROOT / "examples" / "walker18" / "walker18.ul"
    assert len(path.read_text("utf-8").splitlines()) <= 23
    spec = load(path)
    root = spec.root()
    groups = {group.name: group for group in root.groups}
    assert len(groups["pos"].elements) == len(groups["sp"].elements) == 18
    assert [e.access for e in groups["sp"].elements] == ["WRITE"] * 18
    assert words(spec)["rear.r.knee_sp"] == 0x185
    assert groups["pos"].elements[4].display == "front right:knee"


# --- headers, names, roots ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("header", "file", "package", "name"),
    [
        ("", "my-robot.ul", "", "my_robot"),
        ("", "3dof.ul", "", "_3dof"),
        ("", "<text>", "", "text"),
        ("link arm;", "x.ul", "", "arm"),
        ("link robots.arm;", "x.ul", "robots", "arm"),
        ("link lab.robots . arm ;", "x.ul", "lab.robots", "arm"),
    ],
)
def test_header(header: str, file: str, package: str, name: str) -> None:
    spec = clean(header + "public a() { @x = 0x1: READ(); }", file)
    assert (spec.package, spec.name, spec.source) == (package, name, file)


def test_two_public_constructors() -> None:
    spec = clean("public a() { @x = 0x1: READ(); } public b() { @x = 0x1: WRITE(); }")
    assert words(spec) == {"a.x": 1, "b.x": 1}
    assert spec.root("b").elements[0].access == "WRITE"
    with pytest.raises(KeyError, match="a, b"):
        spec.root("c")


def test_public_constructor_may_be_expanded_too() -> None:
    spec = clean("public a() { inner: b(); } public b() { @x = 0x1: READ(); }")
    assert words(spec) == {"a.inner.x": 1, "b.x": 1}


def test_without_arguments_tosnet_and_id() -> None:
    root = clean("public a() { @x = 0x10: READ(); b: b() @ (0x20); } b(): @ (y) { @y: READ(); }").root()
    assert root.link == LinkBinding("memory", 0, None, None)
    assert [e.display for e in root.walk()] == ["x", "b.y"]
    assert root.instances[0].display == "b"
    assert root.display == "a"


@pytest.mark.parametrize(
    "words_of",
    [
        "class def lambda None import self match async print",  # Python
        "int struct template volatile namespace operator NULL",  # C, C++
        "signal entity std_logic process architecture out",  # VHDL
        "Header header msg srv string float64 uint32",  # ROS
        "function end parfor",  # MATLAB
    ],
)
def test_keywords_of_target_languages_are_names_like_others(words_of: str) -> None:
    names = words_of.split()
    members = "".join(f"@{name} = 0x{i:X}: READ(ID={names[0]});" for i, name in enumerate(names))
    inner = "".join(f"{name}_: {name}(); " for name in names)
    others = "".join(f"{name}() {{ @{name} = 0x{i:X}: READ(); }}" for i, name in enumerate(names, 100))
    text = f"public start() {{ {inner} all: all_('n'); }} all_({names[0]}) {{ {members} }} {others}"
    assert len(words(clean(text))) == 2 * len(names)


def test_caret_makes_a_name_of_a_keyword() -> None:
    root = clean("public ^public() { @^READ = 0x1: READ(); ^ID = ^READ; }").root()
    assert (root.name, root.elements[0].name, root.groups[0].name) == ("public", "READ", "ID")


def test_white_space_comments_and_byte_order_mark() -> None:
    text = "\ufeffpublic/**/a ( ) {\r\n\t@ x\r=0x1 // one\n:READ ( ) ; /* * / \n */ }"
    assert words(clean(text)) == {"x": 1}


def test_strings_and_escapes() -> None:
    root = clean(r"public a() { @x = 0x1: READ(ID='it\'s' ); }").root()
    assert root.elements[0].display == "it's"
    root = clean(r'public a() { @x = 0x1: READ(ID="\t\u00b5 \"\\ // no comment"); }').root()
    assert root.elements[0].display == '\tµ "\\ // no comment'


# --- parameters ---------------------------------------------------------------------------------------------


def test_strings_are_put_together_through_levels() -> None:
    text = """
    public a() { b: b("left" + " " + "front") @ (0x1); }
    b(n): @ (x) { @x: c("the "+n, n); }
    c(n,m): @ (y) { @y: READ(ID=n+"/"+m); }
    """
    root = clean(text).root()
    assert next(iter(root.walk())).display == "the left front/left front"
    assert root.instances[0].display == "left front"


def test_run_time_parameters_are_handed_down() -> None:
    text = """
    public a(ctrl,left,right) {
        l: arm("left", ctrl, left);
        r: arm("right", ctrl, right);
    }
    arm(name,c,link_) { TOSNET(CTRL=c, COMM=link_, BASE=0); j: joint(name) @ (0x80); }
    joint(name): @ (pos) { @pos: READ(ID=name); }
    """
    root = clean(text).root()
    assert root.parameters == ("ctrl", "left", "right")
    assert [e.link for e in root.walk()] == [
        LinkBinding("tosnet", 0, "ctrl", "left"),
        LinkBinding("tosnet", 0, "ctrl", "right"),
    ]
    assert [i.display for i in root.instances] == ["left", "right"]


# --- addresses and links ------------------------------------------------------------------------------------

PAIR = "pair(): @l, @r { @l: leg(); @r: leg(); } leg(): @ (hip,foot) { @hip: READ(); @foot: READ(); }"


@pytest.mark.parametrize(
    "binding",
    [
        "@l=(0x1,0x2), @r=(0x3,0x4)",
        "@r=(0x3,0x4), @l=(0x1,0x2)",
        "@ (0x1,0x2), @ (0x3,0x4)",
    ],
)
def test_named_vectors(binding: str) -> None:
    spec = clean(f"public a() {{ p: pair() {binding}; }} {PAIR}")
    assert words(spec) == {"p.l.hip": 1, "p.l.foot": 2, "p.r.hip": 3, "p.r.foot": 4}


@pytest.mark.parametrize("binding", ["@ (0x1,0x2)", "@foot=0x2, @hip=0x1", "@hip=(0x1), @foot=(0x2)"])
def test_tuple_is_taken_apart_by_position_or_bound_by_name(binding: str) -> None:
    spec = clean(
        f"public a() {{ l: leg() {binding}; }} leg(): @ (hip,foot) {{ @foot: READ(); @hip: READ(); }}"
    )
    assert words(spec) == {"l.hip": 1, "l.foot": 2}


def test_vector_is_forwarded_through_levels() -> None:
    spec = clean(
        "public a() { p: outer() @v=(0x1,0x2); } outer(): @v { @v: middle(); }"
        "middle(): @w { @w: leg(); } leg(): @ (hip,foot) { @hip: READ(); @foot: READ(); }"
    )
    assert words(spec) == {"p.v.w.hip": 1, "p.v.w.foot": 2}


@pytest.mark.parametrize(
    ("text", "at"),
    [
        ("public a() { p: pair() @l=(0x1,0x2), @r=(0x3); } " + PAIR, "@r=(0x3)"),
        ("public a() { x: x() @v=(0x1,0x2); } x(): @v { @v: READ(); }", "@v=(0x1"),
        (
            "public a() { x: x() @ (0x1); } x(): @ (v) { @v: leg(); } " + PAIR[PAIR.index("leg():") :],
            "v: leg",
        ),
    ],
)
def test_wrong_length_of_a_forwarded_vector(text: str, at: str) -> None:
    diagnostics = [d for d in compile_text(text).diagnostics if d.severity == "error"]
    assert [(d.code, d.span.start) for d in diagnostics] == [("UL031", text.index(at))]


@pytest.mark.parametrize(
    ("leg", "code", "at"),
    [
        ("leg(): @ (a,b,c) { @a: READ(); @b: READ(); @c: READ(); }", "UL031", "leg(): @ (a"),
        ("leg(): @a { @a: READ(); }", "UL031", "a { @a"),
    ],
)
def test_all_forwarded_vectors_of_one_wrong_length_are_one_mistake(leg: str, code: str, at: str) -> None:
    text = (
        "public a() { p: pair() @l=(0x1,0x2), @r=(0x3,0x4); q: pair() @l=(0x5,0x6), @r=(0x7,0x8); }"
        "pair(): @l, @r { @l: leg(); @r: leg(); } " + leg
    )
    diagnostics = compile_text(text).diagnostics
    assert [(d.code, d.span.start) for d in diagnostics] == [(code, text.index(at))]
    assert "all 4 vectors" in diagnostics[0].message


def test_base_is_added_and_inner_tosnet_takes_over() -> None:
    text = """
    public a(ctrl,comm) {
        TOSNET(CTRL=ctrl, UART=comm, BASE=0x800);
        @x = 0x81: READ();
        b: b();
    }
    b() { @y = 0x82: READ(); TOSNET(BASE=4096); }
    """
    spec = clean(text)
    root = spec.root()
    assert words(spec) == {"x": 0x881, "b.y": 0x1082}
    assert root.instances[0].link == LinkBinding("tosnet", 0x1000, "ctrl", "comm")


def test_base_beyond_32_bits() -> None:
    text = "public a() { TOSNET(BASE=0xFFFFFFFF); @x = 0x1: READ(); }"
    diagnostics = compile_text(text).diagnostics
    assert "UL050" in [d.code for d in diagnostics]


def test_one_word_on_two_links_is_no_overlap() -> None:
    text = """public a(one,two) { l: b(one); r: b(two); } b(c) { TOSNET(COMM=c); @x = 0x80: READ(); }"""
    assert words(clean(text)) == {"l.x": 0x80, "r.x": 0x80}


def test_statement_copied_whole_is_one_overlap() -> None:
    text = """public a() { j1: j() @ (0x1,0x2,0x3); j2: j() @ (0x1,0x2,0x3); }
    j(): @ (x,y,z) { @x: READ(); @y: READ(); @z: READ(); }"""
    diagnostics = compile_text(text).diagnostics
    assert [d.code for d in diagnostics] == ["UL051"]
    assert "2 more" in diagnostics[0].message


# --- elements and groups ------------------------------------------------------------------------------------


def test_element_properties() -> None:
    element = clean("public a() { @x = 0x1: signed READ(PUBLISH(2,0x10), CRC, ID='x'); }").root().elements[0]
    assert (element.checked, element.signed, element.publish) == (True, True, Publish(2, 16, 62.5))


def test_groups() -> None:
    text = f"""
    public a() {{
        feet = ALL(pair).ALL(leg).foot;
        p: pair() @l=(0x1,0x2), @r=(0x3,0x4);
        q: pair() @l=(0x5,0x6), @r=(0x7,0x8);
        left = q.l, p.l.hip;
        more = left, p.r;
    }}
    {PAIR}
    """
    groups = {g.name: [e.path for e in g.elements] for g in clean(text).root().groups}
    assert groups == {
        "feet": ["p.l.foot", "p.r.foot", "q.l.foot", "q.r.foot"],
        "left": ["q.l.hip", "q.l.foot", "p.l.hip"],
        "more": ["q.l.hip", "q.l.foot", "p.l.hip", "p.r.hip", "p.r.foot"],
    }


def test_members_keep_the_order_of_the_text() -> None:
    root = clean(
        "public a() { g = y; @y = 0x2: READ(); b: b(); @x = 0x1: READ(); } b() { @z = 0x3: READ(); }"
    ).root()
    assert [member.name for member in root.members] == ["g", "y", "b", "x"]


def test_group_of_an_inner_group() -> None:
    text = "public a() { b: b(); g = b.g; } b() { @x = 0x1: READ(); @y = 0x2: READ(); g = y, x; }"
    assert [e.path for e in clean(text).root().groups[0].elements] == ["b.y", "b.x"]


# --- results ------------------------------------------------------------------------------------------------


def test_load_raises_with_report_and_diagnostics(tmp_path: Path) -> None:
    path = tmp_path / "bad.ul"
    path.write_text("public a() { @x: READ(); }", "utf-8")
    with pytest.raises(SpecError, match=r"error\[UL026\]") as caught:
        load(path)
    assert len(caught.value.diagnostics) == 1


def test_bytes_and_text_give_the_same() -> None:
    text = SCARA.read_text("utf-8")
    assert compile_text(text) == compile_text(text.encode())


BASE = (
    'public a(c) { TOSNET(COMM=c, BASE=0); j: j("one") @ (0x80); g = j.x; } j(n): @ (x) { @x: READ(ID=n); }'
)


@pytest.mark.parametrize(
    ("old", "new", "same"),
    [
        ("{ TOSNET", "{\n // comment\n TOSNET", True),
        ('"one"', '"two"', True),
        ("public", "link other; public", True),
        ("ID=n", "ID='x'+n", True),
        ("0x80", "0x81", False),
        ("0x80", "0X080", True),
        ("a(c)", "^a ( c )", True),
        ("g = j.x", "h = j.x", False),
        ("@x: READ", "@x: WRITE", False),
        ("BASE=0", "BASE=2048", False),
        ("@x: READ", "@x: signed READ", False),
        ("ID=n", "ID=n, CRC", False),
        ("ID=n", "ID=n, PUBLISH(1,10)", False),
        ("g = j.x; ", "", False),
        ("TOSNET(COMM=c, BASE=0);", "", False),
        ("(c)", "(d)", False),
    ],
)
def test_hash_is_of_wire_and_interface(old: str, new: str, same: bool) -> None:
    assert old in BASE
    changed = BASE.replace(old, new)
    changed = changed.replace("COMM=c", "COMM=d") if "(d)" in changed else changed
    before, after = compile_text(BASE).spec, compile_text(changed).spec
    assert isinstance(before, Spec)
    assert isinstance(after, Spec)
    assert (before.hash == after.hash) is same
    assert len(before.hash) == 16


def test_hash_does_not_depend_on_the_run() -> None:
    assert load(SCARA).hash == json.loads(GOLDEN.read_text("utf-8"))["hash"]


def test_model_is_complete() -> None:
    fields = {field.name for field in dataclasses.fields(Element)}
    assert fields >= {
        "name",
        "path",
        "address",
        "access",
        "type",
        "display",
        "checked",
        "publish",
        "link",
        "span",
    }
