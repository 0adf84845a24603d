# SPDX-License-Identifier: BSD-3-Clause
"""A trace is written, decoded, and opened by Wireshark."""

from __future__ import annotations

import json
import os
import pty
import select
import shutil
import subprocess
from pathlib import Path

from .conftest import PATIENCE_S, ROOT, SCARA, UNITYLINK, Run

DISSECTOR = ROOT / "tools" / "wireshark" / "unitylink.lua"


def test_a_trace_says_what_went_over_the_link(run: Run, tmp_path: Path) -> None:
    trace = tmp_path / "scara.pcapng"
    assert run("read", f"sim:{SCARA}?protocol=classic&trace={trace}", "j1.cpos").returncode == 0
    plain = run("decode", trace, "--spec", SCARA)
    assert plain.returncode == 0, plain.stderr
    assert "> #RM:010088" in plain.stdout and "read j1.cpos" in plain.stdout
    only = run("decode", trace, "--spec", SCARA, "--only", "reply", "--match", r"j1\.cpos", "--json")
    replies = [json.loads(line) for line in only.stdout.splitlines()]
    assert replies and all(r["kind"] == "reply" and "j1.cpos = " in r["meaning"] for r in replies)
    raw = run("decode", trace, "--raw")
    assert len(raw.stdout.splitlines()) >= 4
    wrong = run("decode", trace, "--only", "answers")
    assert wrong.returncode == 2 and "no kind 'answers'" in wrong.stderr


def test_a_trace_of_frames_says_it_too(run: Run, tmp_path: Path) -> None:
    trace = tmp_path / "scara.pcapng"
    assert run("write", f"sim:{SCARA}?trace={trace}", "j1.pos_sp=-5").returncode == 0
    plain = run("decode", trace, "--spec", SCARA, "--not", "damaged")
    assert plain.returncode == 0, plain.stderr
    assert "j1.pos_sp = -5" in plain.stdout and "2 address bytes" in plain.stdout
    assert "OPEN" in plain.stdout and "the session is open" in plain.stdout
    damaged = run("decode", trace, "--spec", SCARA, "--only", "damaged,error")
    assert "no message to show" in damaged.stderr and not damaged.stdout


def dissected(trace: Path, *fields: str) -> list[list[str]]:
    tshark = shutil.which("tshark")
    assert tshark, "tshark is missing: install the Debian package tshark"
    done = subprocess.run(
        [tshark, "-X", f"lua_script:{DISSECTOR}", "-r", trace, "-T", "fields", *(f"-e{f}" for f in fields)],
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    )
    assert "Lua Error" not in done.stdout + done.stderr
    return [line.split("\t") for line in done.stdout.splitlines()]


def test_wireshark_opens_frames_with_our_dissector(run: Run, tmp_path: Path) -> None:
    trace, whole = tmp_path / "scara.pcapng", tmp_path / "messages.pcapng"
    assert run("read", f"sim:{SCARA}?trace={trace}", "j1.cpos", "j2.cpos").returncode == 0
    done = run("decode", trace, "--spec", SCARA, "--pcapng", whole)
    assert done.returncode == 0, done.stderr
    names = ["frame.p2p_dir", "unitylink.kind", "unitylink.id", "unitylink.status", "frame.comment"]
    shown = dissected(whole, *names)
    assert ["0", "LIST", "1", "", "with the bus held: read j1.cpos, j2.cpos"] in shown, shown
    (answer,) = [line for line in shown if line[:4] == ["1", "REPLY", "1", "ok"]]
    assert answer[4].startswith("j1.cpos = ") and "j2.cpos = " in answer[4]
    assert any(line[1] == "LIST" for line in dissected(trace, *names[:4])), "the trace itself opens, too"


def test_wireshark_opens_it_with_our_dissector(run: Run, tmp_path: Path) -> None:
    trace, whole = tmp_path / "scara.pcapng", tmp_path / "messages.pcapng"
    assert run("read", f"sim:{SCARA}?protocol=classic&trace={trace}", "j1.cpos").returncode == 0
    done = run("decode", trace, "--spec", SCARA, "--pcapng", whole)
    assert done.returncode == 0, done.stderr
    fields = ["frame.p2p_dir", "unitylink.letters", "unitylink.data", "frame.comment"]
    shown = ["\t".join(line) for line in dissected(whole, *fields)]
    assert any(line.split("\t") == ["0", "RM", "010088", "read j1.cpos"] for line in shown), shown
    assert any(line.startswith("1\tS_RM\t") and "j1.cpos = " in line for line in shown), shown


def test_a_file_that_is_not_a_capture_gives_an_error_without_a_traceback(run: Run, tmp_path: Path) -> None:
    (tmp_path / "x.pcapng").write_bytes(b"nonsense")
    done = run("decode", tmp_path / "x.pcapng")
    assert done.returncode == 1 and "not a pcapng file" in done.stderr and "Traceback" not in done.stderr


def test_a_terminal_takes_lines_from_a_pipe(run: Run) -> None:
    done = run("term", f"sim:{SCARA}", text="#R:j1.cpos\n$W:j1.pos_sp 00000005\nhello\n")
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert lines[0].startswith("> #RLC") and "2 address bytes" in lines[1]
    assert lines[2].startswith("> #R:0088 ") and "j1.cpos = " in lines[3]
    assert lines[4].startswith("> $W:008C00000005*") and lines[5].startswith("< $S_W*")
    assert "no answer" in lines[7]
    wrong = run("term", f"sim:{SCARA}", text="#R:j1.cpso\n")
    assert wrong.returncode == 1 and "did you mean j1.cpos" in wrong.stderr


def test_a_person_types_with_tab_and_sees_the_answer() -> None:
    """On a real terminal, TAB completes a name, Enter sends it, and Ctrl-D ends."""
    pid, terminal = pty.fork()
    if pid == 0:
        os.environ["TERM"] = "xterm"
        os.execv(UNITYLINK, [str(UNITYLINK), "term", f"sim:{SCARA}"])
    seen = b""
    try:
        # The program asks where the cursor is. A terminal answers this.
        seen = _until(terminal, seen, b"\x1b[6n")
        os.write(terminal, b"\x1b[10;1R")
        seen = _until(terminal, seen, b"\x1b[0m>")  # the prompt
        os.write(terminal, b"#R:j1.cp\t")
        seen = _until(
            terminal, b"", b"os"
        )  # the end of j1.cpos; the program may draw the whole line again, or only its new part
        os.write(terminal, b"\r")
        seen = _until(terminal, seen, b"j1.cpos = ")
        after = seen.partition(b"j1.cpos = ")[2]
        _until(terminal, after, b"\x1b[?2004h")  # the next prompt; before it, the program does not see Ctrl-D
        os.write(terminal, b"\x04")
    finally:
        _, status = os.waitpid(pid, 0) if b"j1.cpos = " in seen else (os.kill(pid, 9), os.waitpid(pid, 0)[1])
        os.close(terminal)
    assert os.waitstatus_to_exitcode(status) == 0, seen


def _until(terminal: int, seen: bytes, what: bytes) -> bytes:
    while what not in seen:
        ready, _, _ = select.select([terminal], [], [], PATIENCE_S)
        assert ready, f"{what!r} did not come; so far: {seen!r}"
        seen += os.read(terminal, 4096)
    return seen
