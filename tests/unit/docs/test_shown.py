# SPDX-License-Identifier: BSD-3-Clause
"""The output that pages show is the real one: transcripts of commands, and `# ->` in examples of Python."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from unitylink import cli

ROOT = Path(__file__).resolve().parents[3]
DOCS = ROOT / "docs"
VOLATILE = (
    (r"^ +\d+\.\d{6} ", " TIME "),
    (r"\(epoch \w{4}\)", "(epoch)"),
    (r"device clock \d+", "device clock"),
    (r"cpos = -\d+", "cpos = what it is by then"),
    (r"(fffff\w{3})+", "and its words"),
)


def said(capfd: pytest.CaptureFixture[str], command: str) -> list[str]:
    assert cli.main(shlex.split(command)[1:]) == 0, capfd.readouterr().err
    return capfd.readouterr().out.splitlines()


def stable(line: str) -> str:
    for volatile, name in VOLATILE:
        line = re.sub(volatile, name, line)
    return line.rstrip()


def shows(block: str, output: list[str]) -> None:
    """`…` and a line `...` stand for what the page leaves out."""
    shown = block.splitlines()
    whole = shown[-1] != "..."
    shown = shown if whole else shown[:-1]
    assert len(output) == len(shown) if whole else len(output) > len(shown)
    for page, real in zip(shown, output, strict=False):
        wanted = "".join(".*" if part == "…" else re.escape(part) for part in re.split("(…)", stable(page)))
        assert re.fullmatch(wanted, stable(real)), f"the page: {page}\nis now:   {real}"


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    monkeypatch.chdir(tmp_path)


def test_the_budget(capfd: pytest.CaptureFixture[str]) -> None:
    blocks = re.findall(r"^```console\n\$ (.*?)^```", (DOCS / "budget.md").read_text("utf-8"), re.M | re.S)
    (command, line), (same, ring) = (block.split("\n", 1) for block in blocks)
    assert command == same
    output = said(capfd, command)
    shows(line, output)
    of_ring = ring.removeprefix("...\n")
    shows(of_ring, output[-len(of_ring.splitlines()) :])


def test_a_captured_read(capfd: pytest.CaptureFixture[str]) -> None:
    page = (DOCS / "trace.md").read_text("utf-8")
    read, decode = re.findall(r"^unitylink (?:read|decode scara.pcapng --spec examples).*$", page, re.M)
    fences = re.findall(r"^```(\w*)\n(.*?)^```", page, re.M | re.S)
    framed, classic = (text for language, text in fences if not language)
    said(capfd, read)
    shows(framed, said(capfd, decode))
    Path("scara.pcapng").unlink()  # an existing file would not be overwritten
    said(capfd, read.replace("trace=", "protocol=classic&trace="))
    shows(classic, said(capfd, decode)[2:])  # the page leaves out the first two lines, the fence


EXAMPLES = [("budget.md", 0), ("rtl-simulation.md", 1), ("gateware/isochrony.md", 0), ("model-json.md", 0)]
EXAMPLES += [("mapped-memory.md", 0), ("ul-spec.md", 0)]


@pytest.mark.parametrize(("page", "number"), EXAMPLES)
def test_an_example_in_python(page: str, number: int, capfd: pytest.CaptureFixture[str]) -> None:
    Path("scara.ul").symlink_to("examples/scara/scara.ul")
    said(capfd, "unitylink generate scara.ul --out . --only json")
    Path("registers.bin").write_bytes(bytes(64))  # a file in place of a UIO device, which few machines have
    text = (DOCS / page).read_text("utf-8").replace("mmap:/dev/uio0", "mmap:registers.bin")
    block = re.findall(r"^```python\n(.*?)^```", text, re.M | re.S)[number]
    exec(compile(block, page, "exec"), {"__name__": "__main__"})
    told = re.findall(r"# -> (.*)$", block, re.M)
    assert not told or capfd.readouterr().out.splitlines() == told
