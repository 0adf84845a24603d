# SPDX-License-Identifier: BSD-3-Clause
"""Headers of C and C++: equal to the golden files, and with usable names.

tests/programs compiles them.
"""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest

from unitylink.errors import BindingError
from unitylink.generate import generate
from unitylink.interface.wire_hash import wire_hashes
from unitylink.spec import compile_text, load
from unitylink.spec.model import Spec

ROOT = Path(__file__).resolve().parents[3]
GOLDEN = ROOT / "tests" / "golden"
EXAMPLES = sorted((ROOT / "examples").glob("*/*.ul"))
TYPED = Path(__file__).with_name("typed.ul")
SPECS = [*EXAMPLES, TYPED, TYPED.with_name("awkward.ul")]
LANGUAGES = ("cpp", "c")
# Names that mean something else in C or C++, or are names of what is generated.
AWKWARD = """
enum class: u2 { int = 0; EOF = 1; idle = 3; }
open enum Error: u8 { NULL = 0; errno = 1; }
bits union: u8 { static: bool @ 0; errno: u3 @ 3..1; class: class @ 5..4; raw: bool @ 6; }
public namespace() {
   @int = 0x0: READ();
   @^link = 0x1: WRITE();
   @objects = 0x2: union READWRITE(INITIAL=0);
   @write = 0x3: class READWRITE();
   @write_write = 0x4: READ(PUBLISH(10 Hz));
   @snapshot = 0x5: Error READWRITE(INITIAL=errno);
   @__x = 0x6: f64 READ();
   @Joint = 0x8: READ();
   @published_10_hz = 0x9: READ();
   @ul_told = 0xA: READ();
   @INT8_MAX[2] = 0xB: bool READ();
   delete: Joint(0x10);
   joint: Robot(0x20);
   this[2]: joint_write(0x30+4*i);
   template = ALL(joint_write).new;
}
Joint(at: int) { @inputs = at: WRITE(); }
Robot(at: int) { @Robot = at: READ(); }
joint_write(at: int) { @new = at: WRITE(MIN=1, MAX=5); @joint = at+1: READ(); }
"""


def spec_of(text: str, file: str = "robot.ul") -> Spec:
    result = compile_text(text, file)
    assert result.spec is not None, [found for found in result.diagnostics if found.severity == "error"]
    return result.spec


def header(spec: Spec, language: str) -> tuple[str, str]:
    (file,) = generate(spec, language).items()
    return file


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize(
    "path", [TYPED, ROOT / "examples" / "scara" / "scara.ul"], ids=lambda path: path.stem
)
def test_golden(path: Path, language: str) -> None:
    name, text = header(load(path), language)
    golden = GOLDEN / language / name
    if os.environ.get("UPDATE_GOLDEN"):
        golden.write_text(text, encoding="utf-8")
    assert text == golden.read_text(encoding="utf-8")
    assert (name, text) == header(load(path), language), "the same spec gives the same text"


def test_names_of_both_languages() -> None:
    """The same things have the same names: a class `Joint` of C++ is the struct `robot_joint` of C."""
    spec = spec_of(AWKWARD)
    cpp, c = header(spec, "cpp")[1], header(spec, "c")[1]
    assert "enum class Class : std::uint8_t {\n  int_ = 0U,\n  EOF_ = 1U,\n  idle = 3U," in cpp
    assert "#define ROBOT_CLASS_INT ((robot_class_t)0U)" in c
    assert "  std::array<JointWrite, 2> this_;" in cpp and "  robot_joint_write_2 this_[2];" in c
    for name in ("link_2", "objects_2", "write_2", "snapshot_2", "x", "write_write", "INT8_MAX_"):
        assert re.search(rf"unitylink::\w+<\S+ {name};", cpp) or f" {name};" in cpp, name
    # the function that writes all of a class, and a value with that name, stay apart
    functions = re.findall(r"^static inline \w+ (\w+)\(", c, re.M)
    assert len(functions) == len(set(functions))


def test_a_strobe_behind_a_commit_is_refused() -> None:
    text = "public arm() { b: buffer(); } buffer() { DOUBLE_BUFFER(BASE=0, SIZE=4); @p = 0x0: bool PULSE(); }"
    result = compile_text(text, "arm.ul")
    if result.spec is None:
        pytest.fail("the compiler refuses it now: this test and the check in facts.py can go")
    with pytest.raises(BindingError, match="use a plain register"):
        generate(result.spec, "cpp")


def test_texts_of_initial_and_safe_values() -> None:
    text = header(load(TYPED), "cpp")[1]
    assert "double target = 0.5;  // WRITE, i16, in rad, from -3.14159265 to 3.14159265" in text
    assert "initial 0.5, safe 0" in text
    plain = header(load(TYPED), "c")[1]
    assert "  outputs->target = 0.5;" in plain and "  outputs->j[2].target = 0.5;" in plain


def test_the_spec_is_hashed_once_for_each_link(monkeypatch: pytest.MonkeyPatch) -> None:
    """A hash reads all of the spec, so one for each value would take hours for a large spec."""
    asked: list[str | None] = []

    def counted(spec: Spec, root: str, *comms: str | None) -> tuple[int, ...]:
        asked.extend(comms)
        return wire_hashes(spec, root, *comms)

    monkeypatch.setattr("unitylink.generate.objects.facts.wire_hashes", counted)
    generate(load(ROOT / "examples" / "scara" / "scara.ul"), "cpp")
    assert asked == ["comm"]
