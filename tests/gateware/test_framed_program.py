# SPDX-License-Identifier: BSD-3-Clause
"""The framed engine's program: its room, and a listing in the words of its VHDL, complete and not stale."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from unitylink.errors import ToolError
from unitylink.gateware import framed_program
from unitylink.gateware.framed_program import instruction_set, names_in, program_of

ROOT = Path(__file__).resolve().parents[2]
WHOLE = "core_settings(protocol => protocol_framed, address_bits => {bits})"


def test_the_page_is_not_stale() -> None:
    command = [sys.executable, "tools/docs/framed_program.py", "--check"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("address_bits", [8, 16, 24, 32])
@pytest.mark.parametrize("data_bits", [8, 32])
def test_a_quarter_of_the_room_is_free(address_bits: int, data_bits: int) -> None:
    widths = f"address_bits => {address_bits}, data_bits => {data_bits}"
    whole = program_of(f"core_settings(protocol => protocol_framed, {widths})")
    features = "publish_mode => 0, lists => false, exchanges => 0, deadman => false"
    least = program_of(f"core_settings(protocol => protocol_framed, {widths}, {features})")
    assert len(whole.words) <= 512 * 3 // 4
    assert len(least.words) <= 256 * 3 // 4


@pytest.mark.parametrize("bits", [8, 32])
def test_every_line_says_what_the_word_has(bits: int) -> None:
    """Each field that is not zero is said by its name in frame_instruction_pkg, and nothing else is."""
    program = program_of(WHOLE.format(bits=bits))
    actions = instruction_set()["action"]
    known = {one.name for names in instruction_set().values() for one in names.values()}
    for place, (word, line) in enumerate(zip(program.words, program.lines(), strict=True)):
        parts = re.split("; |: *", line.partition(" ")[2])
        deeds = " ".join(part for part in parts if not part.startswith(("if ", "unless ", "then ")))
        said, whole = (set(re.findall(r"\w+", text)) for text in (deeds, line))
        fields = {"say": (34, 7), "take": (37, 7), "data": (40, 15), "store": (44, 3), "manage": (46, 15)}
        expected = {
            instruction_set()[field][word >> low & mask].name
            for field, (low, mask) in (fields | {"special": (50, 31)}).items()
            if word >> low & mask
        }
        expected |= {one.name for bit, one in actions.items() if word >> bit & 1 and one.name != "if_not"}
        others = set(program.labels.values()) | {one.name for one in instruction_set()["source"].values()}
        assert (said & known) - others == expected - others, f"{place:03X}: {line}"
        assert ("unless" in whole) == bool(word >> 78 & 1), line
        if condition := word >> 26 & 31:
            name = instruction_set()["condition"][condition].name.removeprefix("if_")
            assert name in whole or name in ("flag", "mark", "shape"), line


def test_every_label_and_table_is_a_place_of_the_program() -> None:
    program = program_of(WHOLE.format(bits=8))
    assert set(program.labels) <= set(range(len(program.words)))
    assert {"write_ok", "exec_read", "entry_hello", "form_list", "check_sync"} <= set(program.labels.values())
    smaller = program_of("core_settings(protocol => protocol_framed, lists => false)")
    assert "run_words" in program.labels.values() and "run_words" not in smaller.labels.values()


def test_a_comment_of_several_lines_is_read_whole() -> None:
    (other,) = (one for one in names_in("frame_instruction_pkg") if one.name == "from_other")
    assert other.about.startswith("the group; for a kind:") and other.about.endswith("that status")


def test_settings_that_cannot_be_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(ToolError, match="ghdl"):
        program_of("core_settings(groups => 0)")
    monkeypatch.setattr(framed_program, "_BEFORE", "nothing like it")
    with pytest.raises(ToolError, match="tells no labels"):
        program_of("core_settings(protocol => protocol_framed)")
