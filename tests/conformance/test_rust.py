# SPDX-License-Identifier: BSD-3-Clause
"""Typed objects in Rust do the same as those in Python, and allocate nothing.

All programs are built at once.
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
from unitylink_lab.bench.cargo import cargo_build

ROOT = Path(__file__).resolve().parents[2]
HERE = Path(__file__).parent / "objects"
LOOP = ROOT / "examples" / "control_loop"
SCARA = ROOT / "examples" / "scara" / "scara.ul"
PAGE = (ROOT / "docs" / "rust.md").read_text("utf-8")
SEED = 1
TYPED = ROOT / "tests" / "unit" / "generate" / "typed.ul"
# Names that mean something else in Rust, or are names of what is generated.
AWKWARD = """
enum crate: u2 { Self = 1; type = 2; self = 3; }
open enum Option: u8 { fn = 0; Some = 1; }
bits impl: u8 { mut: bool @ 0; ref: u3 @ 3..1; kind: crate @ 5..4; }
public match() {
   @type = 0x0: READ();
   @Self = 0x1: WRITE();
   @loop = 0x2: impl READWRITE();
   @write = 0x3: crate READWRITE();
   @snapshot = 0x5: Option READWRITE(INITIAL=Some);
   @move[2] = 0x6: bool READ();
   use: Vec(0x10);
   box[2]: self(0x30+4*i);
   where = ALL(self).dyn;
}
Vec(at: int) { @inputs = at: WRITE(); }
self(at: int) { @dyn = at: WRITE(MIN=1, MAX=5); @super = at+1: READ(); }
"""

pytestmark = pytest.mark.xdist_group("rust")  # one build for all of these tests


def move() -> str:
    """Return the first program of docs/rust.md, with the page's other lines beside it."""
    first, *others = re.findall(r"^```rust.*?\n(.*?)^```", PAGE, re.M | re.S)
    assert len(first.splitlines()) <= 15 and len(others) == 3
    functions = [
        f"#[allow(dead_code)]\nfn more_{n}(robot: &scara::Scara) -> Result<()> {{ {one} Ok(()) }}\n"
        for n, one in enumerate(others)
    ]
    return f"#![forbid(unsafe_code)]\n{first}{''.join(functions)}"


@pytest.fixture(scope="module")
def programs(library: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of the programs. The library they are linked with is named in them."""
    folder = tmp_path_factory.mktemp("rust")
    awkward = compile_text(AWKWARD, "awkward.ul").spec
    assert awkward is not None
    for spec in (
        *map(load, (HERE / "steps.ul", LOOP / "joint.ul", SCARA, TYPED)),
        random_spec(SEED),
        awkward,
    ):
        write_files(generate(spec, "rust"), folder)
    (folder / "move.rs").write_text(move(), encoding="utf-8")
    sources = [
        *(HERE / f"{name}.rs" for name in ("steps", "probe", "codec")),
        LOOP / "loop.rs",
        folder / "move.rs",
    ]
    lines = ['[package]\nname = "programs"\nversion = "0.1.0"\nedition = "2021"\n[dependencies]']
    lines += [
        f'{name} = {{ path = "rust/{name}" }}'
        for name in ("steps", "joint", "scara", "typed", "random", "awkward")
    ]
    lines += [f'[[bin]]\nname = "{source.stem}"\npath = "{source}"' for source in sources]
    (folder / "Cargo.toml").write_text("\n".join(lines), encoding="utf-8")
    return cargo_build(folder, library, flags="-D warnings -C debuginfo=0")


def test_the_same_steps_print_the_same_lines(programs: Path) -> None:
    source = HERE / "steps.ul"
    told = []
    for program in ([sys.executable, HERE / "steps.py"], [programs / "steps"]):
        with still(load(source)) as url:
            told.append(output(*program, f"{url}?protocol=framed", source))
    assert told[0] == told[1]
    assert len(told[0]) == 40 and "36 cycle: -0.256 1 -2.250" in told[0]
    with still(load(source)) as url:
        assert output(programs / "steps", f"{url}?protocol=classic") == told[0]


def test_nothing_is_allocated_after_construction(programs: Path) -> None:
    with still(load(HERE / "steps.ul")) as url:
        lines = output(programs / "probe", "allocations", f"{url}?protocol=framed")
    counted = dict(line.rsplit(" ", 1) for line in lines)
    assert counted.pop("box") == "200", "the hook counts"
    assert len(counted) == 11 and set(counted.values()) == {"0"}, counted


def test_errors_name_the_item_and_the_remedy(programs: Path) -> None:
    board = Board(load(HERE / "steps.ul"), endpoint="tcp", plant=Still())
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    with subprocess.Popen([programs / "probe", "errors", board.url], text=True, **pipes) as run:
        assert run.stdout is not None and run.stdin is not None
        lines = list(iter(run.stdout.readline, "ready\n"))
        written = board.registers[0x100]
        board.close()
        lines += run.communicate("\n", timeout=60)[0].splitlines(keepends=True)
    told = dict(line.rstrip().split(": ", 1) for line in lines)
    assert told["no port"].startswith("5 link: tcp://127.0.0.1:1: nothing listens there; is the board")
    assert told["no url"].startswith("11 link: link URL 'nonsense': expected")
    assert told["robot"] == "0"
    assert told["range"] == "10 small: 101 is not in -100 to 100; nothing was sent"
    wanted = "10 j[1].target: nan rad is not in -3.14159265 to 3.14159265 rad; nothing was sent"
    assert told["not a number"] == wanted
    assert told["not a member"] == "10 Mode: 2 is not one of its numbers; nothing was sent"
    assert told["strange member"].startswith(
        "8 j[1].mode: the device holds 2, which is not one of its numbers"
    )
    assert told["not started"].endswith("call start first")
    assert told["empty queue"].startswith("7 queue.sample: ") and told["queue"] == "0"
    assert written in (19, 39, 59, 79), "the last write of one of four threads"
    for name in ("lost", "lost cycle", "lost write"):
        assert told[name].startswith("3 ") and "the link is closed" in told[name]
    assert told["lost publishes"] == "3 published_pose: the link or the subscription has ended"


def test_a_board_with_another_spec_is_refused(programs: Path) -> None:
    text = (HERE / "steps.ul").read_text("utf-8").replace("@small = 0x31", "@small = 0x42")
    other = compile_text(text, "steps.ul").spec
    assert other is not None
    with still(other) as url:
        done = subprocess.run(
            [programs / "steps", url], capture_output=True, text=True, check=False, timeout=60
        )
    assert (
        done.returncode == 1 and "Error(9, " in done.stderr and "was built from another spec" in done.stderr
    )


def test_the_control_loop_holds_the_joint(programs: Path) -> None:
    code = [line for line in (LOOP / "loop.rs").read_text("utf-8").splitlines() if line.strip()]
    assert len(code) <= 40
    for _ in range(5):  # on a busy machine the loop may come late, and the joint swings
        with Board(
            load(LOOP / "joint.ul"), endpoint="tcp", plant=load_plant(str(LOOP / "plant.py"))
        ) as board:
            (told,) = output(programs / "loop", board.url, "0.5", "1")
        cycles, _, _, _, _, held, _ = told.split()
        if abs(float(held) - 0.5) < 0.02:
            break
    assert cycles == "1000" and abs(float(held) - 0.5) < 0.02


def test_the_page_runs(programs: Path) -> None:
    with board_of("rust.md") as board:
        assert output(programs / "move", board.url) == ["joint 1 is at 300"]


def test_numbers_become_the_same_words_as_in_python(programs: Path) -> None:
    compare_numbers(programs / "codec", random_spec(SEED), SEED, repr)
