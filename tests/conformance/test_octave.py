# SPDX-License-Identifier: BSD-3-Clause
"""Typed objects in Octave do the same as those in Python.

All robots share the one MEX file, which `unitylink_build` makes.
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
from conformance.boards import Still, board_of, output, still
from conformance.numbers_of_values import compare_numbers, random_spec

from unitylink.generate import generate, write_files
from unitylink.simulate import Board
from unitylink.simulate.plant import load_plant
from unitylink.spec import compile_text, load

ROOT = Path(__file__).resolve().parents[2]
HERE = Path(__file__).parent / "objects"
LOOP = ROOT / "examples" / "control_loop"
SCARA = ROOT / "examples" / "scara" / "scara.ul"
SEED = 1
TYPED = ROOT / "tests" / "unit" / "generate" / "typed.ul"
PAGE = (ROOT / "docs" / "matlab.md").read_text("utf-8")
# Names that mean something else in MATLAB or Octave, or are names of what is generated.
AWKWARD = """
enum function: u2 { end = 1; properties = 2; self = 3; }
open enum Part: u60 { until = 0; Some = 1152921504606846974; }
bits methods: u8 { endif: bool @ 0; ref: u3 @ 3..1; kind: function @ 5..4; }
public arguments() {
   @end = 0x0: READ();
   @persistent = 0x1: WRITE();
   @otherwise = 0x2: methods READWRITE();
   @write = 0x3: function READWRITE();
   @snapshot = 0x5: Part READWRITE(INITIAL=Some);
   @parfor[2] = 0x7: i16 READ();
   unitylink: Robot(0x10);
   spmd[2]: self(0x30+4*i);
   where = ALL(self).lost;
}
Robot(at: int) { @initial = at: WRITE(UNIT="µm", MIN=0, MAX=5); }
self(at: int) { @lost = at: WRITE(MIN=1, MAX=5); @time_s = at+1: READ(); }
"""
AWKWARD_PROGRAM = """
given = argv();
robot = awkward.Arguments(given{1});
robot.otherwise_2 = robot.initial().otherwise_2;  % the board begins with 0, which `function` does not have
assert(robot.otherwise_2.kind, awkward.Function.end_2);
robot.write_2 = awkward.Function.properties_2;
assert(class(robot.snapshot_2), 'uint64');
robot.snapshot_2 = awkward.Part.Some;
shot = robot.snapshot();
assert(shot.snapshot_2, awkward.Part.Some);
assert(size(shot.parfor_2), [1 2]);
assert(robot.parfor_2(2), robot.snapshot().parfor_2(2));
assert(robot.initial().snapshot_2, awkward.Part.Some);
robot.where = [1 2];
try
  robot.unitylink_.initial_2 = 6;
catch failure
  disp(failure.message);
end
"""

pytestmark = pytest.mark.xdist_group("octave")  # one build for all of these tests


@pytest.fixture(scope="module")
def octave(library: Path, tmp_path_factory: pytest.TempPathFactory) -> list[str | Path]:
    """Return the command that runs a program with the classes of all specs."""
    folder = tmp_path_factory.mktemp("octave") / "my robots" / "matlab"
    awkward = compile_text(AWKWARD, "awkward.ul").spec
    assert awkward is not None
    for spec in (
        *map(load, (HERE / "steps.ul", LOOP / "joint.ul", SCARA, TYPED)),
        random_spec(SEED),
        awkward,
    ):
        write_files(generate(spec, "matlab"), folder.parent)
    command: list[str | Path] = ["octave-cli", "--norc", "--quiet", "--no-history", "--path", folder]
    include = ROOT / "native" / "include"
    assert output(*command, "--eval", f"unitylink_build('{include}', '{library}')") == []
    (folder / "unitylink_mex.mex").unlink()
    prefix = folder.parent / "my library"
    output(Path(sys.executable).with_name("cmake"), "--install", library, "--prefix", prefix)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PKG_CONFIG_PATH", str(prefix / "lib" / "pkgconfig"))
        assert output(*command, "--eval", "unitylink_build") == []
    return command


def test_the_same_steps_print_the_same_lines(octave: list[str | Path]) -> None:
    source = HERE / "steps.ul"
    told = []
    for program in ([sys.executable, HERE / "steps.py"], [*octave, HERE / "steps.m"]):
        with still(load(source)) as url:
            told.append(output(*program, f"{url}?protocol=framed", source))
    assert told[0] == told[1]
    assert len(told[0]) == 40 and "36 cycle: -0.256 1 -2.250" in told[0]
    with still(load(source)) as url:
        assert output(*octave, HERE / "steps.m", f"{url}?protocol=classic") == told[0]


def test_errors_name_the_item_and_the_remedy(octave: list[str | Path]) -> None:
    board = Board(load(HERE / "steps.ul"), endpoint="tcp", plant=Still())
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    with (
        Board(load(TYPED), endpoint="tcp") as typed,
        subprocess.Popen([*octave, HERE / "probe.m", board.url, typed.url], text=True, **pipes) as run,
    ):
        assert run.stdout is not None and run.stdin is not None
        lines = []
        for line in iter(run.stdout.readline, ""):
            if line == "ready\n":
                break
            lines.append(line)
        board.close()
        lines += run.communicate("\n", timeout=60)[0].splitlines(keepends=True)
        assert run.returncode == 0
    told = dict(line.rstrip().split(": ", 1) for line in lines)
    for name, begin in EXPECTED.items():
        assert told.pop(name).startswith(begin), name
    assert not told, "the probe tells nothing else"


EXPECTED = {
    "no port": "unitylink:NotFound tcp://127.0.0.1:1: nothing listens there; is the board",
    "no url": "unitylink:BadUrl link URL 'nonsense': expected",
    "too many urls": "unitylink:Argument give the URL of the link, or one for each link",
    "verified": "done",
    "range": "unitylink:Range small: 101 is not in -100 to 100; nothing was sent",
    "below zero": "unitylink:Range count: -1 is not in 0 to ",
    "no whole number": "unitylink:Range count: 2.5 is no whole number; nothing was sent",
    "beyond 64 bits": "unitylink:Range big: ",
    "not a number": "unitylink:Range j[1].target: nan rad is not in -3.14159265 to 3.14159265 rad; nothing",
    "not a member": "unitylink:Range j[0].mode: 2 is not one of its numbers; nothing was sent",
    "strange member": "unitylink:ProtocolError j[1].mode: the device holds 2, which is not one of its num",
    "no flag": "unitylink:Range lamps[2]: it is true or false, and 2 was given; nothing was sent",
    "two lamps": "unitylink:Range steps.lamps: it has 3 items, and 2 were given; nothing was sent",
    "a text": "unitylink:Argument count: it takes one number, not a char",
    "no struct": "unitylink:Argument status: it is a packed value, so give a struct with its fields",
    "no field": "unitylink:Argument status: the field 'heat' is missing in the struct; nothing was sent",
    "packed": "unitylink:Range status.mode: 2 is not one of its numbers; nothing was sent",
    "read only": "unitylink:ReadOnly steps.limit: it can only be read",
    "write only": "unitylink:WriteOnly j[0].target: it can only be written",
    "group": "unitylink:WriteOnly targets: it can only be written",
    "group of three": "unitylink:Argument targets: give a struct with its 2 values",
    "group without one": "unitylink:Argument targets: the field j_1_target is missing in the struct; nothing",
    "other field": "unitylink:Argument targets: there is no output more; nothing was sent",
    "no part": "unitylink:Argument steps.net: it is a part of the robot; write its values",
    "not started": "unitylink:Argument its publishes were not started; call start first",
    "empty queue": "unitylink:BusError queue.sample: read of 0x0180",
    "no property": " subsasgn: unknown property: nothing",
    "no place": "unitylink:Argument there is no value at this place",
    "no call": "unitylink:Argument unitylink_mex: there is no such call",
    "no arguments": "unitylink:Argument unitylink_mex: use the classes that unitylink generate makes",
    "locked": "1",
    "initial": "0.5 1.5 3",
    "written": "1 2 1.5 2",
    "lamps": "1 1 1",
    "consistent": "done",
    "shown": "1",
    "closed cycle": "done",
    "used after": "unitylink:Argument the cycle was closed",
    "rows": "1 1 -0.256 0",
    "no timetable": "unitylink:Argument published_pose: Octave has no timetable; use poll",
    "typed": "uint64 0 3",
    "lost": "unitylink:Closed small: ",
    "lost write": "unitylink:Closed small: ",
    "closed": "unitylink:Closed the robot was closed; open it again",
    "unlocked": "1",
}


def test_numbers_become_the_same_words_as_in_python(octave: list[str | Path]) -> None:
    spec = random_spec(SEED)
    with Board(spec, endpoint="tcp") as board:
        compare_numbers([*octave, HERE / "codec.m", board.url], spec, SEED, repr, rounds=15)


def test_a_board_with_another_spec_is_refused(octave: list[str | Path]) -> None:
    with still(load(TYPED)) as url:
        program = f"try, steps.Steps('{url}'), catch e, disp(e.identifier), disp(e.message), end"
        identifier, message = output(*octave, "--eval", program)
    assert identifier == "unitylink:Mismatch" and "was built from another spec" in message


def test_names_that_mean_something_in_matlab(octave: list[str | Path], tmp_path: Path) -> None:
    awkward = compile_text(AWKWARD, "awkward.ul").spec
    assert awkward is not None
    (tmp_path / "program.m").write_text(AWKWARD_PROGRAM, encoding="utf-8")
    with Board(awkward, endpoint="tcp", plant=Still()) as board:
        (told,) = output(*octave, tmp_path / "program.m", board.url)
    assert told == "unitylink.initial: 6 µm is not in 0 to 5 µm; nothing was sent"


def test_the_page_and_the_example_run(octave: list[str | Path], tmp_path: Path) -> None:
    """The first program of docs/matlab.md, then the page's other lines in the same session."""
    first, *others = re.findall(r"^```matlab.*?\n(.*?)^```", PAGE, re.M | re.S)
    assert len(first.splitlines()) <= 15 and len(others) == 4
    program = first.replace("tcp://127.0.0.1:5555", "URL")
    assert program != first
    with board_of("matlab.md") as board:
        text = "\n".join([program.replace("URL", board.url), *others])
        (tmp_path / "page.m").write_text(text, encoding="utf-8")
        lines = output(*octave, tmp_path / "page.m")
        assert lines[0] == "joint 1 is at 300" and lines[-1] == "the page ends"
    for _ in range(5):  # on a busy machine the loop may come late, and the joint swings
        with Board(
            load(LOOP / "joint.ul"), endpoint="tcp", plant=load_plant(str(LOOP / "plant.py"))
        ) as board:
            (told,) = output(*octave, LOOP / "loop.m", board.url, "0.5", "1")
        cycles, _, _, _, _, held, _ = told.split()
        if abs(float(held) - 0.5) < 0.02:
            break
    assert cycles == "200" and abs(float(held) - 0.5) < 0.02
