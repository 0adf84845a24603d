# SPDX-License-Identifier: BSD-3-Clause
"""`make fresh` tries every target of `make help`, each as if none had run before."""

from __future__ import annotations

import importlib
import os
import re
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]
MAKEFILE = (ROOT / "Makefile").read_text("utf-8")
IDENTITY = ("-c", "user.name=nobody", "-c", "user.email=nobody@example.org", "-c", "init.defaultBranch=main")

TINY = """
remember:
\t@echo "home: $$(ls -A $$HOME)"; touch $$HOME/trace build
\t@[ ! -e trace ] && touch trace
know:
\t@echo "virtual $$VIRTUAL_ENV secret $$SECRET pip $$PIP_CACHE_DIR path $$PATH"
fail:
\t@echo what went wrong; exit 3
stay:
\t@setsid sleep 600 & echo $$! > $(PID)
hang:
\t@sleep 600
"""
FORMS = {"remember": "", "know": "", "fail": "", "stay": "PID=pid", "hang": ""}
Try = Callable[..., list[Any]]


@pytest.fixture
def fresh(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Import tools/fresh/every_target.py, which is no package."""
    monkeypatch.syspath_prepend(str(ROOT / "tools" / "fresh"))
    return importlib.import_module("every_target")


@pytest.fixture
def tiny(tmp_path: Path) -> Path:
    """A checkout with targets that leave traces, fail, leave a process or hang."""
    checkout = tmp_path / "tiny"
    checkout.mkdir()
    (checkout / "Makefile").write_text(TINY)
    for words in (["init", "--quiet"], ["add", "Makefile"], ["commit", "--quiet", "-m", "Start"]):
        subprocess.run(["git", *IDENTITY, *words], cwd=checkout, check=True)
    return checkout


@pytest.fixture
def try_targets(fresh: Any, tiny: Path, tmp_path: Path) -> Try:
    def run(*names: str, **forms: str) -> list[Any]:
        outcomes: list[Any] = fresh.run(names, FORMS | forms, tiny, fresh.Here(), tmp_path / "logs")
        return outcomes

    return run


def targets_of_help(fresh: Any) -> list[str]:
    told = subprocess.run(["make", "help"], cwd=ROOT, capture_output=True, text=True, check=True)
    found: list[str] = importlib.import_module("short_forms").targets(told.stdout)
    return found


def test_every_target_of_help_has_a_short_form_and_no_other(fresh: Any) -> None:
    assert set(targets_of_help(fresh)) == set(fresh.SHORT_FORMS)


def test_help_names_every_target_of_the_makefile(fresh: Any) -> None:
    rules = set(re.findall(r"^([a-z][a-z0-9-]*):", MAKEFILE, re.M)) - {"help"}
    assert rules == set(targets_of_help(fresh))
    phony = re.findall(r"^\.PHONY: ((?:.*\\\n)*.*)", MAKEFILE, re.M)[0].replace("\\\n", " ").split()
    assert rules | {"help"} == set(phony), "a file of that name would be taken for the target"


def test_the_variables_of_short_forms_are_those_of_the_makefile(fresh: Any) -> None:
    for name, form in fresh.SHORT_FORMS.items():
        for variable in re.findall(r"(\w+)=", form):
            assert re.search(
                rf"\$\({variable}[):]|\$\(if \$\({variable}\)|ifdef {variable}$", MAKEFILE, re.M
            ), f"make {name} {form}"


def test_the_tests_that_short_forms_name_are_there(fresh: Any) -> None:
    named = [path for form in fresh.SHORT_FORMS.values() for path in re.findall(r"=(tests/\S+)", form)]
    assert named and all((ROOT / path).exists() for path in named), named


def test_no_failure_of_a_set_up_is_ignored() -> None:
    recipes = re.findall(r"^\t@?-.*|^\t.*\|\| true.*", MAKEFILE, re.M)
    assert not recipes, "a target goes on without what it needs"


def test_the_smallest_target_runs_in_a_clone_of_this_checkout() -> None:
    command = ["make", "--no-print-directory", "fresh", "TARGETS=clean"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert re.search(r"^make clean +\d+ s  ok$", done.stdout, re.M)
    assert "0 of 1 targets failed" in done.stdout
    assert "rm -rf build .venv" in (ROOT / "build" / "fresh" / "clean.log").read_text()


def test_no_target_sees_what_another_one_left(try_targets: Try, tmp_path: Path) -> None:
    for outcome in try_targets("remember", "remember"):
        assert not outcome.complaint
        assert (tmp_path / "logs" / "remember.log").read_text() == "home: \n"
        assert outcome.changed == "build, trace"


def test_a_target_sees_nothing_of_the_user_who_runs_it(
    try_targets: Try, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("SECRET", "VIRTUAL_ENV", "PIP_CACHE_DIR"):
        monkeypatch.setenv(name, f"/mine/{name}")
    monkeypatch.setenv("PATH", f"/mine/VIRTUAL_ENV/bin:{os.environ['PATH']}")
    assert not try_targets("know")[0].complaint
    said = (tmp_path / "logs" / "know.log").read_text()
    assert said.startswith("virtual  secret  pip  path ") and "/mine" not in said


def test_it_goes_on_after_a_failure_and_shows_its_end(
    try_targets: Try, capsys: pytest.CaptureFixture[str]
) -> None:
    failed, well = try_targets("fail", "know")
    assert (failed.complaint, well.complaint) == ("exit code 2", "")  # make's own
    assert "FAILED: exit code 2" in failed.row() and well.row().endswith("ok")
    said = capsys.readouterr().out
    assert "what went wrong" in said and "[2/2] make know" in said


def state_of(pid: str) -> str:
    """Return the letter of a process's state, or X if the process is gone."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().split()[2]
    except OSError:
        return "X"


def test_a_target_that_hangs_fails_and_leaves_nothing_running(
    fresh: Any, try_targets: Try, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pid = tmp_path / "pid"
    assert not try_targets("stay", stay=f"PID={pid}")[0].complaint
    for _ in range(1000):  # the kernel may still be removing the killed processes
        if state_of(pid.read_text().strip()) in "ZX":
            break
        time.sleep(0.01)
    else:
        raise AssertionError("the process still runs")
    monkeypatch.setattr(fresh, "LONGEST_S", 0.1)
    assert try_targets("hang")[0].complaint == "not done after 0.1 s"


def test_one_failure_is_the_end_of_make_fresh(
    fresh: Any, tiny: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(fresh, "ROOT", tiny)
    monkeypatch.setattr(fresh, "SHORT_FORMS", FORMS)
    monkeypatch.setattr(fresh.signal, "signal", lambda *_: None)  # pytest has its own handlers
    for targets, code in (("know",), 0), (("fail", "know"), 1):
        monkeypatch.setattr(fresh.sys, "argv", ["every_target.py", *targets])
        assert fresh.main() == code
    assert capsys.readouterr().out.endswith("1 of 2 targets failed\n")


def test_a_target_that_is_not_there_is_refused(fresh: Any) -> None:
    done = subprocess.run(
        ["make", "fresh", "TARGETS=tset"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 2
    assert "no target 'tset'; there are: demo, " in done.stderr


def test_a_bare_debian_has_what_the_build_asks_for_and_no_more(fresh: Any) -> None:
    """The packages that must be there before the first command.

    Without one, `make build` stops and names it.
    """
    build = (ROOT / "tools" / "setup.sh").read_text("utf-8").partition("\nbuild)")[2].partition("\n  ;;")[0]
    asked = set(re.findall(r'^  need (?:"[^"]*"|\S+) (\S+) ', build, re.M))
    assert len(asked) == 5
    machines = importlib.import_module("machines")
    assert set(machines.ASKED) == asked | {"make", "ca-certificates"}


def test_a_bare_debian_wants_debootstrap(fresh: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(fresh.Absent, match="needs root and debootstrap"):
        fresh.Debian(tmp_path / "debian").make()
