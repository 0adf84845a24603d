# SPDX-License-Identifier: BSD-3-Clause
"""A trace is written, decoded, and opened by Wireshark."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path

from .conftest import ROOT, SCARA, Run

DISSECTOR = ROOT / "tools" / "wireshark" / "unitylink.lua"


def test_a_trace_says_what_went_over_the_link(run: Run, tmp_path: Path) -> None:
    trace = tmp_path / "scara.pcapng"
    assert run("read", f"sim:{SCARA}?trace={trace}", "j1.cpos").returncode == 0
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


def test_wireshark_opens_it_with_our_dissector(run: Run, tmp_path: Path) -> None:
    trace, whole = tmp_path / "scara.pcapng", tmp_path / "messages.pcapng"
    assert run("read", f"sim:{SCARA}?trace={trace}", "j1.cpos").returncode == 0
    done = run("decode", trace, "--spec", SCARA, "--pcapng", whole)
    assert done.returncode == 0, done.stderr
    tshark = shutil.which("tshark")
    assert tshark, "tshark is missing: install the Debian package tshark"
    fields = ["frame.p2p_dir", "unitylink.letters", "unitylink.data", "frame.comment"]
    shown = subprocess.run(
        [tshark, "-X", f"lua_script:{DISSECTOR}", "-r", whole, "-T", "fields", *(f"-e{f}" for f in fields)],
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    ).stdout.splitlines()
    assert any(line.split("\t") == ["0", "RM", "010088", "read j1.cpos"] for line in shown), shown
    assert any(line.startswith("1\tS_RM\t") and "j1.cpos = " in line for line in shown), shown


def test_a_file_that_is_no_capture_is_an_error_and_no_traceback(run: Run, tmp_path: Path) -> None:
    (tmp_path / "x.pcapng").write_bytes(b"nonsense")
    done = run("decode", tmp_path / "x.pcapng")
    assert done.returncode == 1 and "not a pcapng file" in done.stderr and "Traceback" not in done.stderr
