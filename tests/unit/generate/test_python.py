# SPDX-License-Identifier: BSD-3-Clause
"""Generated proxies: equal to the golden files, refused if stale, the same tree as without a file.

tests/programs tries them with a type checker.
"""

from __future__ import annotations

import ast
import importlib.util
import keyword
import os
import string
import sys
from dataclasses import replace
from itertools import count
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from unitylink.errors import BindingError
from unitylink.generate import generate, generate_python, stale, write
from unitylink.generate.python.modules import RESERVED, module_name
from unitylink.generate.python.text import call, docstring
from unitylink.generate.quoting import Python
from unitylink.layer4_data import Node, ReadValue, Value, ValueGroup, load_spec_objects
from unitylink.layer4_data.binding import BINDING_VERSION
from unitylink.layer4_data.names import NODE_NAMES, python_names
from unitylink.spec import compile_text, load
from unitylink.spec.model import Spec
from unitylink.spec.types import UINT32

ROOT = Path(__file__).resolve().parents[3]
GOLDEN = ROOT / "tests" / "golden" / "python"
SPECS = [*sorted((ROOT / "examples").glob("*/*.ul")), *sorted(Path(__file__).parent.glob("*.ul"))]
# Names that would meet in the generated module.
MEETING = "public ab(^super) { TOSNET(CTRL=^super, BASE=0); @str = 0x10: READ(); part: warning(); }\n"
MEETING += "public AB() { @x = 0x820: READ(); @y = 0x821: READ(); }\nwarning() { @w = 0x11: READ(); }"
_serial = count()
LETTERS = string.ascii_letters + "_"  # of names; `from_regex` draws half as fast


def golden(spec: Path) -> Path:
    """Return the file with the expected text. It is beside an example that ships it, else in tests/golden."""
    beside = spec.with_name(f"{module_name(spec.stem)}.py")
    return beside if beside.exists() else GOLDEN / beside.name


def spec_of(text: str, file: str = "robot.ul") -> Spec:
    result = compile_text(text, file)
    assert result.spec is not None, result.diagnostics
    return result.spec


def imported(path: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location(f"generated_{next(_serial)}", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[module.__name__] = module  # dataclasses look up annotations there
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("path", SPECS, ids=lambda p: p.stem)
def test_golden(path: Path) -> None:
    (name, text), *rest = generate_python(load(path)).items()
    assert not rest
    assert name == golden(path).name
    if os.environ.get("UPDATE_GOLDEN"):
        golden(path).write_text(text, encoding="utf-8")
    assert text == golden(path).read_text(encoding="utf-8")
    assert text == generate_python(load(path))[name], "the same spec gives the same text"


def facts(node: Node) -> list[tuple[Any, ...]]:
    """Return everything that matters about a tree, groups included."""
    found: list[tuple[Any, ...]] = []
    for name, member in node._members.items():
        attribute = next(
            k
            for k, v in vars(node).items()
            if v is member or (isinstance(v, tuple) and any(one is member for one in v))
        )
        if isinstance(member, Node):
            found += [(attribute, member.path, member.display), *facts(member)]
        elif isinstance(member, ValueGroup):
            found.append((attribute, name, member.path, tuple(member.values)))
        else:
            assert isinstance(member, Value)
            publish = member.publish if isinstance(member, ReadValue) else None
            where = (member.address, member.hardware.kind, member.hardware.base)
            about = (member.checked, publish, member.line, member.display, member.codec.words)
            of_user = replace(member.quantity, type=UINT32), member.quantity.type.text, member.minimum
            about = (*about, *of_user, member.maximum)
            found.append((attribute, member.path, member.access, *where, *about))
    return found


@pytest.mark.parametrize("path", SPECS, ids=lambda p: p.stem)
def test_generated_and_loaded_trees_are_the_same(fake: ModuleType, tmp_path: Path, path: Path) -> None:
    spec = load(path)
    (file,) = write(spec, tmp_path)
    module = imported(file)
    for root in spec.roots:
        link = fake.FakeLink()
        loaded = load_spec_objects(spec, link, root=root.name)
        made = next(c for n, c in vars(module).items() if n.lower() == root.name.replace("_", ""))(link)
        assert facts(made) == facts(loaded)
        assert [value.path for value in made] == [element.path for element in root.walk()]
        for element in root.walk():
            assert made[element.path].address == element.address


def test_links_go_where_the_spec_says(fake: ModuleType, tmp_path: Path) -> None:
    text = "public robot(control, data) { TOSNET(CTRL=control, COMM=data, BASE=0); j: joint() @ (0x84); }\n"
    text += "joint(): @ (sp) { @sp: WRITE(); }"
    spec = spec_of(text)
    (file,) = write(spec, tmp_path)
    plain, control, data = (fake.FakeLink(fake.TosNetModel(), url=name) for name in ("a", "b", "c"))
    robot = imported(file).Robot(plain, control, data)
    assert robot.j.sp.hardware.link is data and robot.j.sp.hardware.control is control
    robot = imported(file).Robot(plain)
    assert robot.j.sp.hardware.link is plain and robot.j.sp.hardware.control is plain
    other = load_spec_objects(spec, plain, links={"data": data})
    assert other["j.sp"].hardware.link is data  # type: ignore[union-attr]
    with pytest.raises(BindingError, match="no parameter 'uart'; there are control, data"):
        load_spec_objects(spec, plain, links={"uart": data})
    with pytest.raises(BindingError, match="no public constructor 'arm'; there are: robot"):
        load_spec_objects(spec, plain, root="arm")


def test_two_trees_share_one_shadow(fake: ModuleType) -> None:
    text = "public left() { TOSNET(BASE=0); @a = 0x84: WRITE(); }\n"
    text += "public right() { TOSNET(BASE=0); @b = 0x85: WRITE(); }"
    model = fake.TosNetModel()
    both = load_spec_objects(spec_of(text), fake.FakeLink(model))
    both["left.a"].write(1)  # type: ignore[union-attr]
    both["right.b"].write(2)  # type: ignore[union-attr]
    both["right.b"].write(3)  # type: ignore[union-attr]
    assert model.outputs[0] == {0x84: 1, 0x85: 3}


def test_node(fake: ModuleType) -> None:
    robot = load_spec_objects(load(ROOT / "examples" / "scara" / "scara.ul"), fake.FakeLink())
    assert robot["j1"].display == "joint 1"  # type: ignore[union-attr]
    assert robot["j1"]["cpos"] is robot["j1.cpos"]  # type: ignore[index]
    with pytest.raises(KeyError, match=r"no 'j1.cpo' in scara; did you mean j1.cpos\?"):
        robot["j1.cpo"]
    robot["j1"]._tree.link.bus.words = {0x89: 5}  # type: ignore[union-attr]
    snapshot = robot.snapshot()
    assert snapshot["j2.cpos"] == 5 and len(snapshot) == 8
    assert dict(robot["j2"].snapshot()) == {"cpos": 5, "spd": 0}  # type: ignore[union-attr]
    seen: list[Any] = []
    robot.on_publish(lambda time_s, values: seen.append((time_s, values["j2.cpos"])))
    robot.on_change(lambda values: seen.append(len(values)))
    robot["j1"]._tree.link.publish(1.0)  # type: ignore[union-attr]
    assert seen == [(1.0, 5), 8]
    robot.stop_publishing()
    with robot.publishing() as publishing, robot.record() as recording:
        robot["j1"]._tree.link.publish(2.0)  # type: ignore[union-attr]
    assert publishing is robot and recording.series("j2.cpos")[1].tolist() == [5]


def test_reserved_names_are_those_of_node(fake: ModuleType) -> None:
    node = load_spec_objects(spec_of("public p() { @a = 0x0: READ(); }"), fake.FakeLink())
    public = {name for name in dir(node) if not name.startswith("_")} - {"a"}
    assert public == NODE_NAMES


@given(
    st.lists(
        st.builds(str.__add__, st.sampled_from(LETTERS), st.text(LETTERS + string.digits, max_size=8))
        | st.sampled_from(
            ["class", "class_", "class__", "snapshot", "snapshot_", "_", "__", "__init__", "_tree", "None"]
        ),
        unique=True,
    )
)
def test_python_names_are_usable_and_distinct(names: list[str]) -> None:
    attributes = python_names(names)
    assert list(attributes) == names
    assert len(set(attributes.values())) == len(names)
    for attribute in attributes.values():
        assert attribute not in NODE_NAMES and not attribute.startswith("_")
        assert attribute.isidentifier() and not keyword.iskeyword(attribute)


@given(st.text())
def test_any_text_survives_quoting(text: str) -> None:
    assert ast.literal_eval(Python.text(text)) == text


@given(st.lists(st.text(), min_size=1))
def test_any_text_makes_a_docstring(paragraphs: list[str]) -> None:
    for last in ("End.", 'the arm is "parked"', ">>> once", '"', '""', "\\"):
        code = f"def f():\n    {docstring(4, *paragraphs, last)}\n    return 1\n"
        function = ast.parse(code).body[0]
        assert isinstance(function, ast.FunctionDef) and len(function.body) == 2


def test_long_calls_are_one_argument_a_line() -> None:
    assert call(0, "f", ["a" * 50, "b" * 50]) == f"f(\n    {'a' * 50},\n    {'b' * 50},\n)"


def test_files_are_written_once_and_only_over_ours(tmp_path: Path) -> None:
    spec = spec_of("public p() { @a = 0x0: READ(); }")
    assert stale(spec, tmp_path) == [f"{tmp_path / 'robot.py'} is missing"]
    (path,) = write(spec, tmp_path)
    before = path.stat().st_mtime_ns
    assert write(spec, tmp_path) == [] and stale(spec, tmp_path) == []
    assert path.stat().st_mtime_ns == before
    path.write_text(path.read_text().replace("0x000", "0x001"))
    assert stale(spec, tmp_path) == [f"{path} is stale or was edited"]
    assert write(spec, tmp_path) == [path]
    path.write_text("precious = 1\n")
    assert stale(spec, tmp_path) == [f"{path} is not a generated file"]
    with pytest.raises(BindingError, match="is not a generated file and was not overwritten"):
        write(spec, tmp_path)
    assert path.read_text() == "precious = 1\n"
    with pytest.raises(BindingError, match="no artefact is called 'cobol'; there are: python"):
        write(spec, tmp_path, "cobol")
    with pytest.raises(BindingError, match="cannot write to"):
        write(spec_of("public q() { @a = 0x0: READ(); }", "q.ul"), path)
    assert [p.name for p in tmp_path.iterdir()] == ["robot.py"], "no temporary file is left"


def test_a_stale_or_foreign_file_is_refused(tmp_path: Path) -> None:
    source = tmp_path / "robot.ul"
    source.write_text("public p() { @a = 0x0: READ(); }")
    (path,) = write(load(source), tmp_path)
    imported(path)
    source.write_text("public p() { @a = 0x0: READ(); } // a comment is no change")
    imported(path)
    source.write_text("public p() { @a = 0x1: READ(); }")
    with pytest.raises(
        BindingError, match=r"robot.py is stale: .* run: unitylink generate \S*robot.ul --out"
    ):
        imported(path)
    source.write_text("public p() { @a = ")
    with pytest.raises(BindingError, match="which has errors; run: unitylink check"):
        imported(path)
    source.unlink()
    text = path.read_text().replace(f"binding_version={BINDING_VERSION})", "binding_version=99)")
    path.write_text(text)
    with pytest.raises(BindingError, match=r"generated for binding version 99, this library has"):
        imported(path)


def test_names_that_meet_in_the_module_stay_apart(fake: ModuleType, tmp_path: Path) -> None:
    spec = spec_of(MEETING)
    (file,) = write(spec, tmp_path)
    module = imported(file)
    first, second = module.Ab(fake.FakeLink()), module.AB(fake.FakeLink())
    assert {v.path: v.address for v in first} == {"str": 0x10, "part.w": 0x11}
    assert {v.path: v.address for v in second} == {"x": 0x820, "y": 0x821}
    assert type(first.part).__name__ == "Warning2" and first.str_.path == "str"
    assert facts(load_spec_objects(spec, fake.FakeLink(), root="ab")) == facts(first)


def test_one_long_line_of_documentation_is_as_a_formatter_leaves_it() -> None:
    assert docstring(4, "x" * 79) == f'"""{"x" * 79}"""'
    two = docstring(4, "x" * 40 + " " + "y" * 40)
    assert two == f'"""{"x" * 40}\n    {"y" * 40}\n    """'
    assert docstring(4, "x " * 38 + "yy") == f'"""{"x " * 38}yy"""'


@pytest.mark.parametrize(
    "name", ["types", "json", "numpy", "conftest", "__main__", "tomllib", "imp", "class"]
)
def test_no_module_is_called_like_one_of_python(name: str) -> None:
    """A `types.py` in a folder stops every Python that is started there."""
    spec = spec_of(f"link {name}; public p() {{ @a = 0x0: READ(); }}")
    assert list(generate(spec)) == [f"{name}_.py"]
    assert (
        f"from p_unitylink_node.{name}_ import P"
        in generate(spec, "ros2")["ros2/p_unitylink/scripts/node.py"]
    )


def test_what_python_knows_is_reserved() -> None:
    assert sys.stdlib_module_names <= RESERVED


def test_a_pipe_in_place_of_a_file_is_neither_read_nor_written(tmp_path: Path) -> None:
    """A program that reads a pipe without a writer waits for ever."""
    os.mkfifo(tmp_path / "robot.py")
    spec = spec_of("public p() { @a = 0x0: READ(); }")
    for command in (write, stale):
        with pytest.raises(BindingError, match=r"robot\.py is not an ordinary file and was not overwritten"):
            command(spec, tmp_path)


def test_links_below_the_folder_are_not_followed(tmp_path: Path) -> None:
    """The folder itself may be a link, because its owner has named it."""
    spec = spec_of("public p() { @a = 0x0: READ(); }")
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    folder = tmp_path / "folder"
    folder.symlink_to(elsewhere)
    (path,) = write(spec, folder)
    (elsewhere / "kept.py").write_text(path.read_text())
    path.unlink()
    path.symlink_to("kept.py")
    with pytest.raises(BindingError, match=r"robot\.py is a symbolic link to kept\.py and was not followed"):
        write(spec, folder)
    (folder / "vhdl").symlink_to(tmp_path)
    with pytest.raises(BindingError, match=r"vhdl is a symbolic link .* remove it or generate elsewhere"):
        write(spec, folder, "vhdl")
    assert {one.name for one in tmp_path.iterdir()} == {"elsewhere", "folder"}
