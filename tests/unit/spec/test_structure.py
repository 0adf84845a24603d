# SPDX-License-Identifier: BSD-3-Clause
"""Constants, expressions, arrays, parameters, imports, links, notes and components: what they mean."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from effort import many
from hypothesis import given, settings
from hypothesis import strategies as st

from unitylink.spec import Annotation, LinkBinding, Spec, compile_file, compile_text

ROOT = Path(__file__).parents[3]


def clean(text: str, file: str = "<text>", include: tuple[Path, ...] = ()) -> Spec:
    """Compile a text that must give no diagnostic."""
    result = compile_text(text, file, include)
    assert [(d.code, d.message) for d in result.diagnostics] == []
    assert result.spec is not None
    return result.spec


def words(spec: Spec) -> dict[str, int]:
    return {path: element.address for path, element in spec.walk()}


def codes(text: str) -> list[str]:
    return [d.code for d in compile_text(text).diagnostics]


# --- expressions --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("expression", "value"),
    [
        ("0x10+2*3", 22),
        ("(0x10+2)*3", 54),
        ("100-10-1", 89),
        ("2*3%4", 2),
        ("7/2*2", 7),
        ("1<<4|3", 19),
        ("0xFF&0x0F+1", 16),
        ("0x80>>3", 16),
        ("-1+3", 2),
        ("0b101*0x1", 5),
        ("1e3+0", 1000),
        ("N*N", 36),
        ("(N<<1)-(N>>1)", 9),
    ],
)
def test_expressions(expression: str, value: int) -> None:
    assert (
        words(clean(f"const N = 6;\npublic a() {{ @_n = N: READ(); @x = 0x400+({expression}): READ(); }}"))[
            "x"
        ]
        == 0x400 + value
    )


@given(
    st.recursive(
        st.integers(0, 99).map(str),
        lambda inner: st.tuples(inner, st.sampled_from(["+", "-", "*"]), inner).map(
            lambda t: f"({t[0]}{t[1]}{t[2]})"
        ),
        max_leaves=20,
    )
)
@settings(max_examples=many(60), deadline=None)
def test_arithmetic_is_that_of_python(expression: str) -> None:
    wanted = eval(expression)  # safe: the test made this sum of small numbers
    text = f"const N = {expression};\npublic a() {{ @x[1+N*0] = 0x0: i64 WRITE(INITIAL=N % 1000000); }}"
    assert clean(text).root().elements[0].initial == wanted % 1000000


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("public a() { @x = 7/2+0x1: READ(); }", "UL046"),
        ("public a() { @x = 0x1-2: READ(); }", "UL049"),
        ("public a() { @x = 1<<65: READ(); }", "UL048"),
        ("public a() { @x = 1 rad + 0x1: READ(); }", "UL088"),
        ("public a() { @x = n+1: READ(); }", "UL025"),
        ('public a() { @x = "1"+1: READ(); }', "UL047"),
        ("const A = B; const B = 1; public a() { @x = A+B: READ(); }", "UL097"),
        ("public a() { @x = 0x1" + "*1" * 300 + ": READ(); }", "UL045"),
    ],
)
def test_wrong_expressions(text: str, code: str) -> None:
    assert codes(text) == [code]


# --- arrays and parameters ----------------------------------------------------------------------------------


def test_arrays_of_instances_and_elements() -> None:
    spec = clean(
        """
    const LEGS = 3;
    public robot() {
       leg[LEGS]: leg("leg {i+1}", i) @ (0x10+4*i, 0x11+4*i);
       @lamp[2] = 0x80: WRITE(ID="lamp {{{i}}}");
       @wide[2] = 0x90: u64 READ();
       @apart[2] = 0xA0+8*i: READ();
       all = leg.hip, ALL(leg).knee;
       rear = leg[LEGS-1], lamp;
    }
    leg(name: string, number: int): @ (hip,knee) {
       @hip: READ(ID=name+" hip");
       @knee: READ(ID="knee "+number);
    }
    """
    )
    root = spec.root()
    assert words(spec) == {
        "leg[0].hip": 0x10, "leg[0].knee": 0x11, "leg[1].hip": 0x14, "leg[1].knee": 0x15,
        "leg[2].hip": 0x18, "leg[2].knee": 0x19, "lamp[0]": 0x80, "lamp[1]": 0x81,
        "wide[0]": 0x90, "wide[1]": 0x92, "apart[0]": 0xA0, "apart[1]": 0xA8,
    }  # fmt: skip
    third = root.instances[2]
    assert (third.name, third.array, third.index, third.path, third.display) == (
        "leg[2]",
        "leg",
        2,
        "leg[2]",
        "leg 3",
    )
    assert [e.display for e in third.elements] == ["leg 3 hip", "knee 2"]
    assert [(e.array, e.index, e.display) for e in root.elements[:2]] == [
        ("lamp", 0, "lamp {0}"),
        ("lamp", 1, "lamp {1}"),
    ]
    groups = {group.name: [element.path for element in group.elements] for group in root.groups}
    assert groups["all"] == [
        "leg[0].hip",
        "leg[1].hip",
        "leg[2].hip",
        "leg[0].knee",
        "leg[1].knee",
        "leg[2].knee",
    ]
    assert groups["rear"] == ["leg[2].hip", "leg[2].knee", "lamp[0]", "lamp[1]"]


def test_braces_in_a_classic_string_are_braces() -> None:
    assert clean('public a() { @x = 0x1: READ(ID="{i}"); }').root().elements[0].display == "{i}"


def test_parameters_with_types_defaults_and_names() -> None:
    spec = clean("""
    public a() {
       x: part("x") @ (0x1);
       y: part("y", on=true, scale=0.5, base=3) @ (0x2);
       z: part(name="z", limit=90 deg) @ (0x3);
    }
    part(name: string, base: int = 2, scale: real = 2*base, on: bool = false, limit: real = 1): @ (v) {
       @v: i16 WRITE(ID=name+on, SCALE=scale, UNIT="rad", MAX=limit, MIN=-base);
    }
    """)
    found = [(e.display, e.scale, e.minimum, e.maximum) for _, e in spec.walk()]
    assert found == [("x0", 4, -2, 1), ("y1", 0.5, -3, 1), ("z0", 4, -2, pytest.approx(1.5707963267948966))]


@pytest.mark.parametrize(
    ("call", "code"),
    [
        ("part()", "UL030"),
        ('part("a", 1, 2)', "UL030"),
        ('part("a", gaer=1)', "UL094"),
        ('part("a", name="b")', "UL094"),
        ('part(gear=1, "a")', "UL094"),
        ("part(gear=1)", "UL030"),
        ('part("a", "b")', "UL047"),
        ('part("a", 1/2)', "UL046"),
    ],
)
def test_wrong_arguments(call: str, code: str) -> None:
    part = "part(name: string, gear: int = 1): @ (v) { @v: READ(ID=name+gear); }"
    text = f"public a() {{ p: {call} @ (0x1); }} {part}"
    assert codes(text) == [code]


def test_an_array_whose_size_is_a_parameter_cannot_grow_without_end() -> None:
    levels = "".join(f"a{k}(n: int) {{ x[n]: a{k + 1}(n); }}\n" for k in range(8))
    text = f"public r() {{ x: a0(50); }} {levels} a8(n: int) {{ @x[n] = 0x0: READ(); }}"
    assert codes(text) == ["UL038"]
    assert codes("public r() { x[100000]: b(); } b() { @y = 0x1: READ(); }") == ["UL049"]


# --- imports ------------------------------------------------------------------------------------------------


def test_imports_bring_constructors_types_and_constants(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "joint.ul").write_text(
        'import "base.ul";\nlink other;\nconst STEP = 2*ONE;\n'
        "public joint(n): @ (p) { @p: mode READ(ID=n); }\n"
    )
    (tmp_path / "parts" / "base.ul").write_text("const ONE = 1;\nenum mode: u2 { on = ONE }\nunused() { }\n")
    text = (
        'import "parts/joint.ul";\nimport "parts/base.ul";\npublic arm() { j: joint("a") @ (0x10+STEP); }\n'
    )
    spec = clean(text, str(tmp_path / "arm.ul"))
    assert (spec.name, [root.name for root in spec.roots], words(spec)) == ("arm", ["arm"], {"j.p": 0x12})
    element = spec.root().instances[0].elements[0]
    assert element.span.file == str(tmp_path / "parts" / "joint.ul")
    assert (element.span.line, element.span.column) == (4, 27)
    elsewhere = clean(text, str(tmp_path / "elsewhere" / "arm.ul"), (tmp_path / "none", tmp_path))
    assert elsewhere.hash == spec.hash


def test_mistakes_of_an_imported_file_stand_in_that_file(tmp_path: Path) -> None:
    (tmp_path / "joint.ul").write_text("joint(): @ (p) {\n   @p: READ()\n}\njoint() { }\n")
    (tmp_path / "arm.ul").write_text(
        'import "joint.ul";\npublic arm() {\n   j: joint() @ (0x1);\n   @x: READ();\n}\n'
    )
    found = compile_file(tmp_path / "arm.ul").diagnostics
    assert [(d.code, Path(d.span.file).name, d.span.line) for d in found] == [
        ("UL026", "arm.ul", 4),
        ("UL011", "joint.ul", 2),
        ("UL020", "joint.ul", 4),
    ]
    assert found[2].labels[0].span.line == 1
    assert [(f.span.start, f.replacement) for f in found[1].fixes] == [(30, ";")]


@pytest.mark.parametrize(
    "name",
    [
        "../joint.ul",
        "/etc/passwd",
        "a/../../b.ul",
        "./a.ul",
        "a//b.ul",
        "",
        "C:/a.ul",
        "a\\\\b.ul",
        "a\\u0000.ul",
    ],
)
def test_imports_stay_below_the_search_path(name: str) -> None:
    assert codes(f'import "{name}";\npublic a() {{ @x = 0x1: READ(); }}') == ["UL044"]


def test_search_path_of_the_environment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "joint.ul").write_text("joint(): @ (p) { @p: READ(); }\n")
    monkeypatch.setenv("UNITYLINK_PATH", str(tmp_path))
    clean('import "joint.ul"; public a() { j: joint() @ (0x1); }')


# --- links --------------------------------------------------------------------------------------------------


def test_links() -> None:
    spec = clean("""
    link lab.cell;
    /// the left one
    link left (DATA=16, ADDRESS=12, BASE_RATE=2 kHz, BAUD=3 MHz);
    link right (BAUD=115200);
    public one(c,l,r) { a: arm(c, l); b: table(c, r); }
    arm(c,l) { MEMORY(CTRL=c, COMM=l, BASE=0x100, LINK=left); @x = 0x1: u32 READ(PUBLISH(2 kHz)); }
    table(c,r) { TOSNET(CTRL=c, COMM=r, LINK=right); @y = 0x80: READ(PUBLISH(100 Hz)); }
    """)
    assert (spec.package, spec.name) == ("lab", "cell")
    left, right = spec.links
    assert (left.data_bits, left.address_bits, left.base_hz, left.baud_hz, left.documentation) == (
        16,
        12,
        2000,
        3_000_000,
        "the left one",
    )
    assert (right.data_bits, right.address_bits, right.stated) == (32, None, ("BAUD",))
    assert [(d.root, d.comm, d.link.name) for d in spec.devices] == [
        ("one", "l", "left"),
        ("one", "r", "right"),
    ]
    assert spec.devices[0].groups[0].addresses == (0x101, 0x102)
    assert spec.devices[0].groups[0].rate_hz == 2000


def test_link_kinds() -> None:
    spec = clean("""
    const PLACE = 0x300;
    public a(c,u) { MEMORY(CTRL=c, COMM=u); t: table(); q: queue(); }
    table() { DOUBLE_BUFFER(BASE=PLACE, SIZE=16); @v[16] = 0x0: WRITE(); }
    queue() {
       FIFO(BASE=PLACE+0x20, DEPTH=64);
       @take = 0x0: READCLEAR();
       @put = 0x0: PULSE();
       @count = 0x1: READ();
    }
    """)
    table, queue = spec.root().instances
    assert table.link == LinkBinding("double_buffer", 0x300, "c", "u", 16)
    assert queue.link == LinkBinding("fifo", 0x320, "c", "u", 64)
    assert [e.address for e in queue.elements] == [0x320, 0x320, 0x321]


@pytest.mark.parametrize(
    ("members", "code", "words"),
    [
        ("@x = 0x302: READ();", "UL057", "`x` lies at 0x302, among the words of `q`"),
        ("@x = 0x204: READ();", "UL057", "`x` lies at 0x204, among the words of `t`"),
        ("r: other();", "UL057", "the words of `r` overlap those of `t`"),
    ],
)
def test_queues_and_tables_have_their_words_for_themselves(members: str, code: str, words: str) -> None:
    text = f"""
    public a(c,u) {{ MEMORY(CTRL=c, COMM=u); q: queue(); t: table(); {members} }}
    queue() {{ FIFO(BASE=0x300, DEPTH=64); @take = 0x0: READCLEAR(); }}
    table() {{ DOUBLE_BUFFER(BASE=0x200, SIZE=4); @v = 0x0: WRITE(); }}
    """
    text += "other() { FIFO(BASE=0x202); @take = 0x0: READCLEAR(); }" if "other" in members else ""
    assert [(d.code, d.message) for d in compile_text(text).diagnostics] == [(code, words)]


def test_components_find_room_beside_queues_and_tables() -> None:
    spec = clean("""
    public a(c,u) { MEMORY(CTRL=c, COMM=u); t: table(); p: pwm(channels=2); q: queue(); }
    table() { DOUBLE_BUFFER(SIZE=4); @v = 0x0: WRITE(); }
    queue() { FIFO(BASE=0x8); @take = 0x0: READCLEAR(); }
    """)
    component = spec.root().instances[1].component
    assert component is not None and component.base == 0xC


def test_a_queue_holds_a_power_of_two() -> None:
    (diagnostic,) = compile_text("public a() { FIFO(DEPTH=100); @n = 0x0: READCLEAR(); }").diagnostics
    assert (diagnostic.code, diagnostic.hint) == ("UL058", "write 128, or 64")


def test_the_arrival_of_a_word_is_an_event() -> None:
    spec = clean("""
    public a(c,u) {
       MEMORY(CTRL=c, COMM=u);
       q: queue();
       @x = 0x0: READ(PUBLISH(on q.arrival));
       @y = 0x1: READ(PUBLISH(on arrival));
    }
    queue() { FIFO(BASE=0x8); @n = 0x0: READCLEAR(PUBLISH(on arrival)); }
    """)
    groups = {element.path: group.event for group in spec.devices[0].groups for element in group.elements}
    assert groups == {"q.n": "q.arrival", "x": "q.arrival", "y": "arrival"}  # y takes the event of the design
    (diagnostic,) = compile_text("public a() { @x = 0x0: READ(PUBLISH(on q.arrival)); }").diagnostics
    assert (diagnostic.code, diagnostic.message) == ("UL102", "nothing has the event `q.arrival`")


def test_an_event_of_one_of_an_array_is_named_by_its_index() -> None:
    text = """
    link l(ADDRESS=8);
    public a() { pad[2]: gpio(pins=4); rest: levels(1); @each[2] = 0x80+i: READ(PUBLISH(on pad[i].changed)); }
    levels(n: int): @base[12] { @of = base: READ(PUBLISH(on pads[n].changed)); pads[2]: gpio(pins=1); }
    """
    spec = clean(text)
    assert [element.publish.event for element in spec.root().elements if element.publish is not None] == [
        "pad[0].changed",
        "pad[1].changed",
    ]
    wrong = text.replace("pad[i].changed", "pad[2].changed")
    assert [one.message for one in compile_text(wrong).diagnostics] == [
        "nothing has the event `pad[2].changed`"
    ]
    wrong = text.replace("pad[i].changed", "pad[j].changed")
    assert [one.code for one in compile_text(wrong).diagnostics] == ["UL025"]


# --- notes --------------------------------------------------------------------------------------------------


def test_documentation_and_annotations_reach_the_model() -> None:
    spec = clean(
        """
    /// A joint.
    /// It turns.
    @ros(type="JointState", frame="joint")
    joint(n: int): @ (p) {
       /// where
       @p: READ(); /// it is
    }
    public arm() {
       @ui("slider", order=i) j[2]: joint(i) @ (0x1+i);
       /// left
       k: joint(7) @ (0x9);
       @plot(width=0.5)
       g = j.p; /// both
    }
    """.replace("joint(n: int)", "joint(_n: int)")
    )
    first, second, third = spec.root().instances
    ros = Annotation("ros", (), (("type", "JointState"), ("frame", "joint")))
    assert first.documentation == "A joint.\nIt turns."
    assert second.annotations == (ros, Annotation("ui", ("slider",), (("order", 1),)))
    assert (third.documentation, third.annotations) == ("left", (ros,))
    assert first.elements[0].documentation == "where\nit is"
    group = spec.root().groups[0]
    assert (group.documentation, group.annotations) == ("both", (Annotation("plot", (), (("width", 0.5),)),))


NEW_WORDS = (
    "const enum bits import open on change i true pwm u8 bool string int MEMORY FIFO DOUBLE_BUFFER "
    "READWRITE W1C PULSE READCLEAR UNIT SCALE MIN GROUP LINK"
)


def test_new_words_are_names_as_well() -> None:
    names = re.split(" ", NEW_WORDS)
    members = "".join(f"@{name} = 0x{n:X}: READ(); {name}_g = {name}; " for n, name in enumerate(names))
    constructors = "".join(f"{name}(n): @ (v) {{ @v: READ(ID=n); }}\n" for name in names)
    uses = "".join(f'{name}_e: {name}("x") @ (0x{n + 64:X}); ' for n, name in enumerate(names))
    forwards = "".join(f"two_{n}: by_{n}() @ (0x{n + 128:X}); " for n in range(len(names)))
    by = "".join(f'by_{n}(): @v {{ @v: {name}("y"); }}\n' for n, name in enumerate(names))
    spec = clean(f"public a() {{ {members} {uses} {forwards} }}\n{constructors}{by}")
    assert len(words(spec)) == 3 * len(names)
    assert all(element.type.bus for _, element in spec.walk())


def test_a_classic_spec_keeps_its_hash() -> None:
    hashes = {path.stem: compile_file(path).spec for path in (ROOT / "examples" / "scara").glob("scara.ul")}
    assert hashes["scara"] is not None
    assert hashes["scara"].hash == "bba6528006aa96af"
