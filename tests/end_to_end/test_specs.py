# SPDX-License-Identifier: BSD-3-Clause
"""Commands that need a spec and no device: check, fmt, list, new, generate."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
Run = Callable[..., "subprocess.CompletedProcess[str]"]

GOOD = "public led() {\n   @on = 0x10: WRITE();\n   @count = 0x11: READ(PUBLISH(1,10));\n}\n"
BAD = 'public led() {\n   @on = 0x10: WRITE()\n   @count = 0x11: READ(IDD="n");\n}\n'


def test_version_and_module(run: Run) -> None:
    said = r"unitylink \d+\.\d+\.\d+, protocols: framed \d+, classic \d+, .*\n"
    assert re.fullmatch(said, run("--version").stdout)
    module = subprocess.run(
        [sys.executable, "-m", "unitylink", "--version"], capture_output=True, text=True, check=True
    )
    assert module.stdout == run("--version").stdout


def test_check_says_that_all_is_well(run: Run, tmp_path: Path) -> None:
    (tmp_path / "led.ul").write_text(GOOD)
    done = run("check", "led.ul")
    assert (done.returncode, done.stdout, done.stderr) == (0, "led.ul: no mistakes; 2 items in led\n", "")


def test_check_reports_all_mistakes_of_all_files(run: Run, tmp_path: Path) -> None:
    (tmp_path / "a.ul").write_text(BAD)
    (tmp_path / "b.ul").write_text(GOOD)
    (tmp_path / "c.ul").write_bytes(b"public x() { \xff }")
    done = run("check", "a.ul", "b.ul", "c.ul", "gone.ul")
    assert done.returncode == 1
    for place in ("a.ul:2:", "a.ul:3:", "c.ul:1:", "gone.ul:1:1"):
        assert f"--> {place}" in done.stdout
    assert "did you mean `ID`?" in done.stdout
    assert "4 errors" in done.stdout
    assert "\x1b" not in done.stdout


def test_check_json_has_the_form_tools_rely_on(run: Run, tmp_path: Path) -> None:
    (tmp_path / "a.ul").write_text(BAD)
    done = run("check", "a.ul", "--json")
    report = json.loads(done.stdout)
    assert done.returncode == 1
    assert set(report) == {"diagnostics"}
    for diagnostic in report["diagnostics"]:
        assert list(diagnostic) == [
            *("severity", "code", "file", "line", "column", "message", "hint", "labels", "fixes")
        ]
        assert re.fullmatch(r"UL\d{3}", diagnostic["code"])
        assert diagnostic["severity"] == "error" and diagnostic["file"] == "a.ul" and diagnostic["hint"]
    assert [d["line"] for d in report["diagnostics"]] == [2, 3]
    assert json.loads(run("check", "-", "--json", text=GOOD).stdout) == {"diagnostics": []}


@pytest.mark.parametrize(
    "arguments", [["check"], ["check", "--jsn", "a.ul"], ["chekc"], ["fmt", "--check", "--stdout", "a"]]
)
def test_wrong_usage_is_2(run: Run, arguments: list[str]) -> None:
    done = run(*arguments)
    assert (done.returncode, done.stdout) == (2, "")
    assert "Error:" in done.stderr


def test_fmt_changes_a_file_once_and_keeps_its_mode(run: Run, tmp_path: Path) -> None:
    spec = tmp_path / "led.ul"
    spec.write_text("public led(){@on=0x10:WRITE();/* kept */}")
    spec.chmod(0o640)
    (tmp_path / "link.ul").symlink_to("led.ul")
    assert run("fmt", "--check", "led.ul").returncode == 1
    assert run("fmt", "link.ul").stdout == "link.ul: laid out anew\n"
    laid_out = spec.read_text()
    assert "/* kept */" in laid_out and "\n" in laid_out.rstrip()
    assert spec.stat().st_mode & 0o777 == 0o640
    assert (tmp_path / "link.ul").is_symlink()
    assert run("fmt", "--check", "led.ul").returncode == 0
    assert run("fmt", "led.ul").stdout == "led.ul: already in its canonical layout\n"
    assert run("fmt", "-", text="public led(){@on=0x10:WRITE();/* kept */}").stdout == laid_out
    assert run("fmt", "--stdout", "led.ul").stdout == laid_out


def test_fmt_leaves_a_wrong_file_alone(run: Run, tmp_path: Path) -> None:
    for name, data in (("bad.ul", b"public led() { @on = "), ("bytes.ul", b"public led() { \xff }")):
        (tmp_path / name).write_bytes(data)
        done = run("fmt", name)
        assert done.returncode == 1
        assert f"{name}:1:" in done.stderr
        assert (tmp_path / name).read_bytes() == data
    assert run("fmt", "gone.ul").stderr == "error: gone.ul: No such file or directory\n"


def test_fmt_goes_on_behind_a_wrong_file(run: Run, tmp_path: Path) -> None:
    (tmp_path / "bad.ul").write_text("public led() {")
    (tmp_path / "led.ul").write_text("public led(){@on=0x10:WRITE();}")
    done = run("fmt", "bad.ul", "gone.ul", "led.ul")
    assert (done.returncode, done.stdout) == (1, "led.ul: laid out anew\n")
    assert "bad.ul:1:14" in done.stderr and "error: gone.ul: No such file or directory" in done.stderr


def test_list(run: Run, scara: Path) -> None:
    done = run("list", "--spec", scara)
    lines = done.stdout.splitlines()
    assert len(lines) == 17
    assert lines[1].split() == [
        "j1.cpos",
        "0x0088",
        "READ",
        "signed",
        "100",
        "Hz,",
        "hardware",
        "joint",
        "1:cpos",
    ]
    chosen = run("list", "--spec", scara, "j*.cpos", "--json")
    report = json.loads(chosen.stdout)
    assert [item["name"] for item in report["items"]] == ["j1.cpos", "j2.cpos", "j3.cpos", "j4.cpos"]
    first = report["items"][0]
    assert first["address"] == 0x88 and first["publish"] == {
        "by": "hardware",
        "divisor": 10,
        "rate_hz": 100.0,
        "on": None,
        "group": "",
    }
    assert re.fullmatch(r"[0-9a-f]{16}", report["hash"])


def test_list_needs_a_spec(run: Run, scara: Path) -> None:
    done = run("list", "scara.ul")
    assert done.returncode == 2
    assert "--spec scara.ul" in done.stderr
    done = run("list", "--spec", "scara.ul", "j1.cpso")
    assert done.returncode == 1
    assert "did you mean 'j1.cpos'?" in done.stderr


def test_a_spec_with_mistakes_stops_every_command_with_its_report(run: Run, tmp_path: Path) -> None:
    (tmp_path / "bad.ul").write_text(BAD)
    for arguments in (["list", "--spec", "bad.ul"], ["read", "sim:bad.ul", "on"], ["simulate", "bad.ul"]):
        done = run(*arguments)
        assert done.returncode == 1
        assert "--> bad.ul:2:" in done.stderr


def test_colours_only_on_a_terminal(on_terminal: Callable[..., str], tmp_path: Path) -> None:
    (tmp_path / "a.ul").write_text(BAD)
    assert "\x1b[1;31merror" in on_terminal("check", "a.ul")
    assert "\x1b[" not in on_terminal("check", "a.ul", NO_COLOR="1")


def test_a_reader_that_goes_away_is_no_error_of_ours(run: Run, tmp_path: Path) -> None:
    items = "".join(f"@r{i} = 0x{i:X}: READ();" for i in range(5000))
    (tmp_path / "big.ul").write_text("public big() {" + items + "}")
    command = f"{Path(sys.executable).with_name('unitylink')} list --spec big.ul | head -1"
    done = subprocess.run(
        command, shell=True, capture_output=True, text=True, cwd=tmp_path, check=False, timeout=60
    )
    assert done.stdout.startswith("name")
    assert done.stderr == ""


def test_a_full_disk_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "led.ul").write_text(GOOD)
    command = f"{Path(sys.executable).with_name('unitylink')} list --spec led.ul > /dev/full"
    done = subprocess.run(
        command, shell=True, capture_output=True, text=True, cwd=tmp_path, check=False, timeout=60
    )
    assert done.returncode == 1
    assert done.stderr == "error: output: No space left on device\n"


def test_new_makes_a_project_that_runs(run: Run, tmp_path: Path) -> None:
    done = run("new", "arm")
    assert done.returncode == 0, done.stderr
    assert "python run.py" in done.stdout
    files = sorted(path.name for path in (tmp_path / "arm").iterdir())
    assert files == ["README.md", "arm.py", "arm.ul", "run.py", "test_arm.py"]
    assert run("check", "arm/arm.ul").returncode == 0
    assert run("fmt", "--check", "arm/arm.ul").returncode == 0
    assert run("generate", "arm/arm.ul", "--out", "arm", "--check").returncode == 0
    moved = subprocess.run(
        [sys.executable, "run.py"],
        cwd=tmp_path / "arm",
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    assert moved.returncode == 0, moved.stderr
    assert "x.position" in moved.stdout


def test_new_overwrites_nothing(run: Run, tmp_path: Path) -> None:
    (tmp_path / "arm").mkdir()
    (tmp_path / "arm" / "run.py").write_text("mine")
    done = run("new", "arm")
    assert done.returncode == 1
    assert "run.py exists and is not overwritten" in done.stderr
    assert [path.name for path in (tmp_path / "arm").iterdir()] == ["run.py"]
    assert (tmp_path / "arm" / "run.py").read_text() == "mine"
    assert run("new", "arm", "--dir", "other/place").returncode == 0
    assert (tmp_path / "other" / "place" / "arm.ul").exists()


@pytest.mark.parametrize(
    ("name", "meant"),
    [
        ("my-arm", "my_arm"),
        ("2arm", ""),
        ("class", "class_robot"),
        ("axis", "axis_robot"),
        ("READ", "READ_robot"),
        ("", ""),
    ],
)
def test_new_refuses_what_is_no_name(run: Run, tmp_path: Path, name: str, meant: str) -> None:
    done = run("new", name)
    assert done.returncode == 2
    assert meant in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_generate(run: Run, scara: Path, tmp_path: Path) -> None:
    done = run("generate", "scara.ul", "--out", "build")
    assert done.returncode == 0, done.stderr
    assert "build/scara.py" in done.stdout
    assert "class " in (tmp_path / "build" / "scara.py").read_text()
    assert run("generate", "scara.ul", "--out", "build", "--check").returncode == 0
    scara.write_text(scara.read_text().replace("0x88", "0xC8"))
    stale = run("generate", "scara.ul", "--out", "build", "--check")
    assert stale.returncode == 1
    assert "scara.py" in stale.stderr
    assert run("generate", "scara.ul", "--out", "build").returncode == 0
    assert run("generate", "scara.ul", "--out", "build", "--check").returncode == 0


def test_generate_does_not_overwrite_a_file_of_the_user(run: Run, scara: Path, tmp_path: Path) -> None:
    (tmp_path / "scara.py").write_text("print('mine')\n")
    done = run("generate", "scara.ul", "--out", ".")
    assert done.returncode == 1
    assert "scara.py" in done.stderr
    assert (tmp_path / "scara.py").read_text() == "print('mine')\n"
    done = run("generate", "scara.ul", "--out", "x", "--only", "pyton")
    assert done.returncode == 2
    assert "python" in done.stderr


def test_the_examples_are_clean(run: Run) -> None:
    specs = sorted((ROOT / "examples").glob("*/*.ul"))
    assert specs
    assert run("check", *specs, "--json").stdout.strip() == json.dumps({"diagnostics": []}, indent=2)


def test_the_commands_of_the_page_of_the_language(run: Run, tmp_path: Path) -> None:
    page = (ROOT / "docs" / "ul-spec.md").read_text("utf-8")
    commands = re.findall(r"^unitylink (\w+) (.*?) *#", page, re.MULTILINE)
    assert {"check", "explain", "budget", "diff", "generate", "map", "import"} <= {
        name for name, _ in commands
    }
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    (tmp_path / "my_robot.ul").write_text(BAD.replace("IDD", "ID"))
    rdl = ROOT / "tests" / "unit" / "commands" / "rdl"
    (tmp_path / "registers.rdl").write_text(next(iter(sorted(rdl.glob("*.rdl")))).read_text("utf-8"))
    for name, arguments in commands:
        if name == "lsp":
            continue  # it waits for an editor
        more = ["--no-open"] if name == "map" else []
        done = run(name, *arguments.split(), *more)
        wrong = 1 if name == "diff" else 0  # the exit code of `diff` says that something breaks
        assert done.returncode == wrong, f"{name} {arguments}:\n{done.stdout}{done.stderr}"
    assert "@on = 0x10: WRITE();" in (tmp_path / "my_robot.ul").read_text()
    assert (tmp_path / "build" / "pa10" / "vhdl" / "pa10_design.vhd").is_file()
