# SPDX-License-Identifier: BSD-3-Clause
"""Typed objects in Python, C++ and C do the same on a virtual board. Those of C++ allocate nothing."""

from __future__ import annotations

import random
import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from unitylink.errors import ValueRangeError
from unitylink.generate import generate
from unitylink.simulate import Board, Registers
from unitylink.simulate.plant import load_plant
from unitylink.spec import compile_text, load
from unitylink.spec.model import Spec
from unitylink.values import Codec, Quantity

ROOT = Path(__file__).resolve().parents[2]
HERE = Path(__file__).parent / "objects"
LOOP = ROOT / "examples" / "control_loop"
STRICT = ["-Wall", "-Wextra", "-Wpedantic", "-Werror"]
STANDARD = {".cpp": ["c++", "-std=c++20"], ".c": ["cc", "-std=c11"]}


class Still:
    """A plant that moves nothing, so that each run finds the same words."""

    period_s = 1.0

    def attach(self, spec: Spec | None, registers: Registers) -> None:
        for address, word in {0x10: 0xFF00, 0x18: 1234, 0x1A: 2, 0x3E: 5, 0x3F: 77, 0x41: 42}.items():
            registers[address] = word

    def step(self, time_s: float) -> None:
        """Do nothing."""


@pytest.fixture(scope="module")
def library() -> Path:
    subprocess.run([ROOT / "tools" / "setup.sh", "native"], check=True)
    return ROOT / "build" / "native"


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


def output(*command: str | Path) -> list[str]:
    done = subprocess.run(command, check=False, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout.splitlines()


@contextmanager
def still(spec: Spec) -> Iterator[str]:
    with Board(spec, endpoint="tcp", plant=Still()) as board:
        yield board.url


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


def test_nothing_is_allocated_after_construction(probe: Path) -> None:
    with still(load(HERE / "steps.ul")) as url:
        counted = dict(line.rsplit(" ", 1) for line in output(probe, "allocations", f"{url}?protocol=framed"))
    assert counted.pop("vector") == "200", "the hook counts"
    assert len(counted) == 12 and set(counted.values()) == {"0"}, counted


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
    with Board(spec, endpoint="tcp", plant=load_plant("scara")) as board:
        assert output(built(tmp_path / "move.cpp", spec, tmp_path, library), board.url) == [
            "joint 1 is at 300"
        ]
        assert output(built(tmp_path / "move.c", spec, tmp_path, library), board.url) == ["joint 1 is at 300"]


def quantities(chance: random.Random) -> Iterator[str]:
    """Yield the words of random values in a spec."""
    for _ in range(120):
        width = chance.choice([1, 2, 7, 8, 15, 16, 31, 32, 33, 53, 63, 64])
        kind = chance.choice(["u", "u", "i", "i", "f", "fixed"])
        if kind == "fixed":
            fraction = chance.randint(0, 16)
            type_ = f"{chance.choice(['fixed', 'ufixed'])}({chance.randint(1, 16)},{fraction})"
        else:
            type_ = f"f{chance.choice([32, 64])}" if kind == "f" else f"{kind}{max(width, 2)}"
        facts = []
        if chance.random() < 0.5:
            facts.append(f"SCALE={chance.choice([0.001, -0.1, 3, 0.3333, 1e-9, 1e6])}")
        if chance.random() < 0.3:
            facts.append(f"MIN={chance.choice([-1, 0, 1])}, MAX={chance.choice([1, 1, 50])}")
        if facts and chance.random() < 0.5:
            facts.append("OVERFLOW=saturate")
        yield f"{type_} WRITE({', '.join(facts)})"


def random_spec(seed: int) -> Spec:
    """Return a spec with the values whose facts go together."""
    kept: list[str] = []
    for words in quantities(random.Random(seed)):
        one = f"@v{len(kept)} = 0x{4 * len(kept):X}: {words};"
        if compile_text(f"public random() {{ {one} }}", "random.ul").spec is not None:
            kept.append(one)
    spec = compile_text(f"public random() {{ {' '.join(kept)} }}", "random.ul").spec
    assert spec is not None and len(kept) > 40
    return spec


@pytest.mark.parametrize("seed", [1])
def test_numbers_become_the_same_words_as_in_python(seed: int, library: Path, tmp_path: Path) -> None:
    spec, chance = random_spec(seed), random.Random(seed)
    program = built(HERE / "codec.c", spec, tmp_path, library)
    asked: list[str] = []
    wanted: list[str] = []
    for index, (_, element) in enumerate(spec.walk()):
        codec = Codec(element.path, Quantity.of(element), 32, commanded=True)
        whole = codec.integer_sign is not None
        for _ in range(60):
            raw = chance.choice([0, 1, codec.mask, codec.mask >> 1, chance.getrandbits(codec.width)])
            value = codec.decode(raw)
            asked.append(f"d {index} {raw}")
            wanted.append(str(value) if whole else float(value).hex())
            near = (
                value if chance.random() < 0.5 else chance.choice([codec.minimum, codec.maximum, 0, 7, 1e30])
            )
            number = int(near) + chance.randint(-2, 2) if whole else float(near) * chance.uniform(0.9, 1.1)
            if whole and not (0 if codec.type.kind == "uint" else -(1 << 63)) <= number < 1 << 63:
                continue  # C has no such number
            asked.append(f"e {index} {number if whole else number.hex()}")
            try:
                wanted.append(str(codec.encode(number)))
            except ValueRangeError:
                wanted.append("-")
    done = subprocess.run([program], input="\n".join(asked), capture_output=True, text=True, check=True)
    found = done.stdout.splitlines()
    assert len(found) == len(wanted)
    for question, ours, theirs in zip(asked, found, wanted, strict=True):
        same = ours == theirs
        if not same and "0x" in theirs and "nan" not in theirs:
            same = float.fromhex(ours) == float.fromhex(theirs)
        assert same or (ours.strip("-") == theirs.strip("-") == "nan"), (question, ours, theirs)
    assert "-" in found
