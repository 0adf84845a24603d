# SPDX-License-Identifier: BSD-3-Clause
"""trace_program: what the compiled engine executes is what its program says."""

from __future__ import annotations

import os
import re
import subprocess
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from unitylink import connect
from unitylink.errors import ToolError
from unitylink.gateware.framed_program import instruction_set, program_of
from unitylink.interface.board_configuration import BoardConfiguration
from unitylink.simulate.rtl.trace import calls_of, traceable, traced

LAMP = "public lamp() { @on_now = 0x0: WRITE(); @key = 0x1: READ(); }"
STEP = re.compile(r"^ *(\d+)  ([0-9A-F]{3}) (?:(\w+):)? *(.*)$")


@pytest.fixture
def spec(tmp_path: Path) -> Path:
    file = tmp_path / "lamp.ul"
    file.write_text(LAMP)
    return file


def test_a_pass_like_the_one_before_is_only_counted(tmp_path: Path) -> None:
    """Steps from a program of four places, of which place 1 is `next`."""
    calls = calls_of(["000 start: a", "001 next: b", "002 c", "003 d"], str(tmp_path / "steps.txt"))
    steps = [0, 1, 2, 1, 2, 1, 2, 1, 3, 1, 2]
    main = "".join(f"unitylink_step({10 + 2 * n}, {place});" for n, place in enumerate(steps))
    (tmp_path / "main.cpp").write_text(f"{calls}\nint main() {{ {main} }}\n")
    compiler = os.environ.get("CXX", "g++")
    for command in ([compiler, "-std=c++20", "main.cpp", "-o", "main"], ["./main"]):
        subprocess.run(command, cwd=tmp_path, check=True, timeout=60)
    written = [
        text.splitlines() for text in (tmp_path / "steps.txt").read_text().split("\n\n") if text.strip()
    ]
    assert written == [
        ["        10  000 start: a"],
        ["        12  001 next: b", "        14  002 c"],
        ["            the same 2 times"],
        ["        24  001 next: b", "        26  003 d"],
        ["        28  001 next: b", "        30  002 c"],
    ]


@pytest.mark.long
@pytest.mark.parametrize("program", ["plain", "publishing"])
def test_an_exchange_step_by_step(program: str, spec: Path, tmp_path: Path, assembler: Any) -> None:
    file = tmp_path / "steps.txt"
    if program == "publishing":
        spec.write_text(LAMP.replace("READ()", "READ(PUBLISH(10 Hz))"))
    with connect(f"rtl:{spec}?engine=small&protocol=framed&clock_hz=3000000&trace_program={file}") as link:
        link.write(0, 5)
        assert link.read(0) == 5
    passes = [text.splitlines() for text in file.read_text().split("\n\n") if text.strip()]
    steps = [[match for line in lines if (match := STEP.match(line))] for lines in passes]
    for found, lines in zip(steps, passes, strict=True):
        assert len(found) == len(lines) or re.match(" *the same [0-9]+ times$", lines[0])
    # What is written is the source, and the places follow each other as the words say.
    source = assembler.assembled(assembler.SOURCE.read_text(encoding="utf-8"))[program]
    assert steps[0][0][3] == "start" and steps[0][1][3] is None
    for one in filter(None, steps):
        for place, label, text in (match.groups()[1:] for match in one):
            line = source.lines[int(place, 16)]
            assert (label or "") == (line.labels[-1] if line.labels else "")
            assert " ".join(text.split()).startswith(f"{line.operation} {line.operand}".strip())
        for before, after in pairwise(one):
            assert int(after[1]) == int(before[1]) + 2  # two clocks an instruction
            assert int(after[2], 16) in followers(source, int(before[2], 16))
    assert {"next", "hello", "read", "write"} <= {match[3] for one in steps for match in one}
    assert "the same" in file.read_text(), "an engine that waits repeats itself"


LEAST = "core_settings(protocol => protocol_framed, publish_mode => 0, lists => false, exchanges => 0)"


@pytest.mark.long
def test_an_exchange_of_the_fast_engine_step_by_step(spec: Path, tmp_path: Path) -> None:
    file = tmp_path / "steps.txt"
    with connect(f"rtl:{spec}?engine=fast&protocol=framed&publish_mode=0&trace_program={file}") as link:
        link.write(0, 5)
        assert link.read(0) == 5
    program = program_of("core_settings(protocol => protocol_framed, publish_mode => 0)")
    lines = program.lines()
    passes = [text.splitlines() for text in file.read_text().split("\n\n") if text.strip()]
    executed = []
    for one in passes:
        steps = [(int(line[:10]), line[12:]) for line in one if not line.lstrip().startswith("the same")]
        places = [int(text[:3], 16) for _, text in steps]
        assert [text for _, text in steps] == [lines[place] for place in places]
        assert all(before < after for (before, _), (after, _) in pairwise(steps))
        assert all(after in fast_followers(program, before) for before, after in pairwise(places))
        executed += places
    assert {"entry_hello", "entry_open", "exec_read", "exec_write"} <= {
        program.labels.get(at) for at in executed
    }


def fast_followers(program: Any, place: int) -> set[int]:
    """Return the places that may follow an instruction of the fast engine."""

    def does(at: int, action: str) -> bool:
        bit = next(bit for bit, one in instruction_set()["action"].items() if one.name == action)
        return bool(program.words[at] >> bit & 1)

    following, target = program.words[place] & 0x1FF, program.words[place] >> 9 & 0x1FF
    jumps = program.words[place] >> 26 & 0x1F
    if does(place, "do_begin"):
        return {target} if jumps else set()
    if does(place, "do_dispatch"):
        return {at for at in program.labels if at & ~0xF == following}
    if does(place, "do_return"):
        return {program.words[at] >> 9 & 0x1FF for at in range(len(program.words)) if does(at, "do_call")}
    return {following, target} if jumps else {following}


def test_a_program_of_other_settings_is_told(tmp_path: Path) -> None:
    """A design of one's own may have other settings than the configuration that came with it."""
    rom = "".join(f"    n1[{n}] = 80'b{word:080b};\n" for n, word in enumerate(program_of(LEAST).words))
    netlist = f"module unitylink_frame_sequencer_0a\n  wire [7:0] position;\n{rom}endmodule\n"
    made, calls = traced(netlist, str(tmp_path / "steps.txt"), LEAST)
    assert made.startswith(netlist.removesuffix("endmodule\n")) and "unitylink_step" in made
    assert "write_ok:" in calls
    with pytest.raises(ToolError, match="not that of its settings; give RtlBoard the configuration"):
        traced(netlist, str(tmp_path / "steps.txt"), LEAST.replace("lists => false", "lists => true"))
    with pytest.raises(ToolError, match="the netlist has no engine"):
        traced("module core\nendmodule\n", str(tmp_path / "steps.txt"), LEAST)


def followers(program: Any, place: int) -> set[int]:
    """Return the places that may follow an instruction."""
    word = program.words[place]
    if not word >> 15:
        return {place + 1}
    if program.lines[place].operation == "ret":
        return {at + 1 for at, line in enumerate(program.lines) if line.operation == "call"}
    return {word & 0x7FF, place + 1}


def test_what_cannot_be_traced_is_told(spec: Path, tmp_path: Path) -> None:
    with pytest.raises(ToolError, match="trace_program is for the engines of the framed protocol"):
        traceable(str(tmp_path / "steps.txt"), BoardConfiguration(protocol="classic"))
    with pytest.raises(ToolError, match=r"trace_program=.*absent/steps.txt: No such file or directory"):
        connect(
            f"rtl:{spec}?engine=small&protocol=framed&publish_mode=0&trace_program={tmp_path}/absent/steps.txt"
        )


def test_the_texts_are_a_filter_of_gtkwave(assembler: Any) -> None:
    """GTKWave takes a line for each value: the value in hexadecimal, as the wave has it, and its text."""
    for name, program in assembler.assembled(assembler.SOURCE.read_text(encoding="utf-8")).items():
        text = assembler.PACKAGE.with_name(f"{name}_program.txt").read_text()
        values = [line.split()[0] for line in text.splitlines() if not line.startswith("#")]
        assert values == [f"{place:03X}" for place in range(len(program.words))]
