# SPDX-License-Identifier: BSD-3-Clause
"""Generated code consists only of constants of the generators, of names, numbers and quoted texts."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

from unitylink.generate import quoting
from unitylink.generate.quoting import LANGUAGES, Code, Cpp, Python, UnquotedText, Vhdl, language_of
from unitylink.generate.templates import environment

SOURCES = Path(quoting.__file__).parents[2]  # the sources of the package unitylink
GENERATORS = [
    path
    for folder in ("generate", "boards", "simulate/rtl")
    for path in sorted((SOURCES / folder).rglob("*.py"))
    if "quoting" not in path.parts
]
TEMPLATES = [
    path
    for folder in ("generate", "boards", "simulate/rtl")
    for path in sorted((SOURCES / folder).rglob("*.jinja"))
]
CLASSES = {language.__name__ for language in LANGUAGES.values()} | {"Code"}
# These write their own quotes around texts that are already quoted.
MAKERS = {"docstring"}


def is_said(node: ast.expr) -> bool:
    """Tell whether our own source contains this whole text as a constant."""
    if isinstance(node, ast.IfExp):
        return is_said(node.body) and is_said(node.orelse)
    return isinstance(node, ast.Constant)


def unsaid(path: Path) -> list[str]:
    """Return the places of a source that make code of a text which is not a constant."""
    tree = ast.parse(path.read_text("utf-8"))
    makers = [n for n in ast.walk(tree) if isinstance(n, ast.FunctionDef) and n.name in MAKERS]
    quoted = {id(inner) for maker in makers for inner in ast.walk(maker)}
    found = []
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call) or not node.args or id(node) in quoted:
            continue
        function = node.func
        makes = isinstance(function, ast.Name) and function.id in CLASSES
        fills = (
            isinstance(function, ast.Attribute)
            and function.attr == "of"
            and isinstance(function.value, ast.Name)
            and function.value.id in CLASSES
        )
        if (makes or fills) and not is_said(node.args[0]):
            found.append(f"{path}:{node.lineno}")
    return found


def test_code_consists_of_constants_of_the_source() -> None:
    """`Cpp("..")` and the pattern of `Cpp.of("..", x)` are constants.

    Everything else goes through a check.
    """
    assert len(GENERATORS) > 40
    assert [place for path in GENERATORS for place in unsaid(path)] == [], "code of a text that is not said"


def test_each_template_has_a_language_and_marks_its_code() -> None:
    assert len(TEMPLATES) > 20
    for path in TEMPLATES:
        text = path.read_text("utf-8")
        assert language_of(path.name) is not Code, f"no language is known by the ending of {path}"
        for call in re.findall(r"\bcode\(([^)]*)", text):
            assert re.match(r"""("[^"]*"|'[^']*')(,|$|\s)|"[^"]*$""", call), (
                f"{path}: code({call}: write a text of its own"
            )
        assert "|safe" not in text and "| safe" not in text, path


@pytest.mark.parametrize("text", ['a"b', "a b", "a\n", "--", "x;", "", "é"])
def test_a_template_refuses_what_is_not_quoted(text: str, tmp_path: Path) -> None:
    (tmp_path / "x.cpp.jinja").write_text("{{ text }}")
    (tmp_path / "y.cpp.jinja").write_text("{{ text | text }} // {{ text | remark }}")
    templates = environment(tmp_path)
    if text:  # the empty text is harmless in every language
        with pytest.raises(UnquotedText):
            templates.get_template("x.cpp.jinja").render(text=text)
        with pytest.raises(UnquotedText):
            templates.get_template("x.cpp.jinja").render(text=Python.text(text))
    assert templates.get_template("x.cpp.jinja").render(text=Cpp.text(text)) == Cpp.text(text)
    assert templates.get_template("y.cpp.jinja").render(text=text).startswith('"')


@pytest.mark.parametrize("value", [True, None, float("nan"), float("inf"), b"x", ["x"], "x y", Vhdl("x")])
def test_only_code_names_and_numbers_can_be_parts(value: object) -> None:
    with pytest.raises(UnquotedText):
        Cpp.of("{}", value)  # type: ignore[arg-type]
    with pytest.raises(UnquotedText):
        Cpp(", ").join([value])  # type: ignore[list-item]


def test_parts_are_names_numbers_paths_and_code() -> None:
    assert Cpp.of("{}({:#x}, {})", "a.b", 16, Cpp("x + 1")) == "a.b(0x10, x + 1)"
    assert type(Cpp(", ").join(["a", "leg[2].hip", "a/b"])) is Cpp
    assert type(Cpp("a").ljust(3)) is Cpp and Cpp("a").ljust(3) == "a  "


def test_the_result_of_formatting_code_is_not_code() -> None:
    """An f-string checks nothing, so its result is not accepted as code."""
    with pytest.raises(UnquotedText):
        Cpp.of("{}", f"{Cpp('x = 1;')}")
