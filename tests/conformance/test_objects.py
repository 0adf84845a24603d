# SPDX-License-Identifier: BSD-3-Clause
"""Typed objects in Python, C++ and C do the same on a virtual board. Those of C++ allocate nothing."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
from conformance.boards import Still, board_of, output, still
from conformance.numbers_of_values import compare_numbers, random_spec

from unitylink.generate import generate
from unitylink.simulate import Board
from unitylink.simulate.plant import load_plant
from unitylink.spec import compile_text, load
from unitylink.spec.model import Spec

ROOT = Path(__file__).resolve().parents[2]
HERE = Path(__file__).parent / "objects"
LOOP = ROOT / "examples" / "control_loop"
STRICT = ["-Wall", "-Wextra", "-Wpedantic", "-Werror"]
STANDARD = {".cpp": ["c++", "-std=c++20"], ".c": ["cc", "-std=c11"]}


def built(source: Path, spec: Spec, folder: Path, library: Path) -> Path:
    """Compile a program with the header of its language, and return it."""
    language = source.suffix
    for name, text in generate(spec, language[1:]).items():
        (folder / name).write_text(text, encoding="utf-8")
    program = folder / f"{source.stem}_{language[1:]}"
    places = [f"-I{folder}", f"-I{ROOT / 'native' / 'include'}", f"-L{library}", f"-Wl,-rpath,{library}"]
    command = [*STANDARD[language], *STRICT, *places, str(source), "-lunitylink", "-lm", "-o", str(program)]
    subprocess.run(command, check=True)
    return program


def test_the_same_steps_print_the_same_lines(library: Path, tmp_path: Path) -> None:
    source = HERE / "steps.ul"
    spec = load(source)
    programs: list[list[str | Path]] = [
        [sys.executable, HERE / "steps.py"],
        [built(HERE / "steps.cpp", spec, tmp_path, library)],
        [built(HERE / "steps.c", spec, tmp_path, library)],
    ]
    for protocol in ("framed", "classic"):
        told = []
        for program in programs:
            with still(spec) as url:
                told.append(output(*program, f"{url}?protocol={protocol}", source))
        assert told[0] == told[1] == told[2]
        assert len(told[0]) == 40 and "36 cycle: -0.256 1 -2.250" in told[0]


@pytest.fixture(scope="module")
def probe(library: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("probe")
    return built(HERE / "probe.cpp", load(HERE / "steps.ul"), folder, library)


def test_nothing_is_allocated_and_no_lock_is_held_in_a_wait(probe: Path) -> None:
    """Under the lock of the link there is one kind of system call: a send that does not wait."""
    with still(load(HERE / "steps.ul")) as url:
        lines = output(probe, "cost", f"{url}?protocol=framed")
    counted = {name: [int(n) for n in told.split()] for name, told in (line.split(": ") for line in lines)}
    hooks = {"memory": [200, 0, 0], "wait under a lock": [0, 200, 200], "look under a lock": [0, 0, 200]}
    for name, told in {**hooks, "look": [0, 0, 0]}.items():
        assert counted.pop(name) == told, "a hook counts"
    assert len(counted) == 12 and all(told[:2] == [0, 0] for told in counted.values()), counted
    assert all(200 <= counted[name][2] <= 250 for name in ("read", "write", "cycle")), counted


# What the library takes from the C library. What is new is counted by system_calls.hpp, or listed.
NO_CALLS = """
_ITM_deregisterTMCloneTable _ITM_registerTMCloneTable _Unwind_Resume free freeaddrinfo gai_strerror getenv
inet_pton memchr memcmp memcpy memmove memset pthread_self snprintf strcmp strerror strlen vsnprintf
"""
ONLY_TO_OPEN_AND_CLOSE = """
access close connect dlclose dlopen dlsym eventfd fcntl flock fstat ftruncate getaddrinfo getpid getsockopt
ioctl isatty lseek mmap munmap open realpath setsockopt shutdown socket socketpair stat sysconf unlink
"""


def test_each_system_call_of_the_library_is_counted(library: Path) -> None:
    """A function that system_calls.hpp does not replace could wait under a lock, and nobody would see it."""
    command = ["nm", "-D", "--undefined-only", str(library / "libunitylink.so")]
    listed = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    names = {line.split()[-1].partition("@")[0] for line in listed.splitlines()}
    taken = {name for name in names if not name.startswith(("_Z", "__"))}
    counted = re.findall(r"UL_BEHIND\((\w+)\);", (HERE / "system_calls.hpp").read_text("utf-8"))
    assert taken - {*counted} - {*NO_CALLS.split(), *ONLY_TO_OPEN_AND_CLOSE.split()} == set()
    assert {"send", "poll", "nanosleep"} <= taken & {*counted}


def test_errors_name_the_item_and_the_remedy(probe: Path) -> None:
    board = Board(load(HERE / "steps.ul"), endpoint="tcp", plant=Still())
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    with subprocess.Popen([probe, "errors", board.url], text=True, **pipes) as run:
        assert run.stdout is not None and run.stdin is not None
        lines = list(iter(run.stdout.readline, "ready\n"))
        board.close()
        lines += run.communicate("\n", timeout=60)[0].splitlines(keepends=True)
    told = dict(line.rstrip().split(": ", 1) for line in lines)
    assert told["no port"].startswith("5 link: tcp://127.0.0.1:1: nothing listens there; is the board")
    assert told["no url"].startswith("11 link: link URL 'nonsense': expected")
    assert told["robot"] == "0"
    assert told["range"] == "10 small: 101 is not in -100 to 100; nothing was sent"
    wanted = "10 j[1].target: nan rad is not in -3.14159265 to 3.14159265 rad; nothing was sent"
    assert told["not a number"] == wanted
    assert told["not a member"] == "10 j[0].mode: 2 is not one of its numbers; nothing was sent"
    assert told["not started"].endswith("call start first")
    assert told["thrown"] == "10 gain: 11 is not in 0 to 10; nothing was sent"
    assert told["empty queue"].startswith("7 queue.sample: ") and told["queue"] == "0"
    for name in ("lost", "lost cycle", "lost write"):
        assert told[name].startswith("3 ") and "the link is closed" in told[name]


def test_a_board_with_another_spec_is_refused(probe: Path) -> None:
    text = (HERE / "steps.ul").read_text("utf-8").replace("@small = 0x31", "@small = 0x42")
    other = compile_text(text, "steps.ul").spec
    assert other is not None
    with still(other) as url:
        (told,) = [line for line in output(probe, "errors", url) if line.startswith("robot")]
    assert told.startswith("robot: 9 steps: ") and "was built from another spec" in told


def test_the_control_loops_hold_the_joint(library: Path, tmp_path: Path) -> None:
    spec = load(LOOP / "joint.ul")
    for source, angle in ((LOOP / "loop.cpp", 0.5), (LOOP / "loop.c", -0.5)):
        code = [line for line in source.read_text("utf-8").splitlines() if line.strip()]
        assert len(code) <= 40
        program = built(source, spec, tmp_path, library)
        for _ in range(5):  # on a busy machine the loop may come late, and the joint swings
            with Board(spec, endpoint="tcp", plant=load_plant(str(LOOP / "plant.py"))) as board:
                (told,) = output(program, board.url, str(angle), "1")
            cycles, _, _, _, _, held, _ = told.split()
            if abs(float(held) - angle) < 0.02:
                break
        assert cycles == "1000" and abs(float(held) - angle) < 0.02


def test_the_page_runs(library: Path, tmp_path: Path) -> None:
    """The first program of docs/cpp.md, with the page's other lines beside it, and the one in C."""
    page = (ROOT / "docs" / "cpp.md").read_text("utf-8")
    first, *others = re.findall(r"^```cpp.*?\n(.*?)^```", page, re.M | re.S)
    assert len(first.splitlines()) <= 15 and len(others) == 3
    beside = "".join(
        f"void more(scara::Scara& robot, int (&)[{n + 1}]) {{ {one} }}\n" for n, one in enumerate(others)
    )
    (tmp_path / "move.cpp").write_text(f"{first}{beside}", encoding="utf-8")
    (plain,) = re.findall(r"^```c .*?\n(.*?)^```", page, re.M | re.S)
    (tmp_path / "move.c").write_text(plain, encoding="utf-8")
    spec = load(ROOT / "examples" / "scara" / "scara.ul")
    with board_of("cpp.md") as board:
        assert output(built(tmp_path / "move.cpp", spec, tmp_path, library), board.url) == [
            "joint 1 is at 300"
        ]
        assert output(built(tmp_path / "move.c", spec, tmp_path, library), board.url) == ["joint 1 is at 300"]


@pytest.mark.parametrize("seed", [1])
def test_numbers_become_the_same_words_as_in_python(seed: int, library: Path, tmp_path: Path) -> None:
    spec = random_spec(seed)
    program = built(HERE / "codec.c", spec, tmp_path, library)
    compare_numbers(program, spec, seed, float.hex)
