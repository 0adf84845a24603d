# SPDX-License-Identifier: BSD-3-Clause
"""Run targets of `make help` as on a fresh machine, each in a clone of its own, with an empty home.

    make fresh                           all targets, in their short forms
    make fresh TARGETS="bench soak"      these only
    make fresh DOWNLOADS=FOLDER          pip's downloads are kept there; fetching them is not tried again
    make fresh DEBIAN=1                  as root, each on a bare Debian, where apt-get installs what is absent

It tries the last commit. The machine's Debian packages stay, except with DEBIAN=1. A compiler launcher of the
environment (CMAKE_CXX_COMPILER_LAUNCHER) stays too. The output of each target is in build/fresh.
"""

from __future__ import annotations

import argparse
import os
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from machines import Absent, Debian, Here
from short_forms import SHORT_FORMS

ROOT = Path(__file__).resolve().parents[2]
LONGEST_S = 3600  # for one target; a hang is then a failure with a name
LAST_LINES = 15  # printed of a target that failed


@dataclass(frozen=True)
class Outcome:
    """How a target ended."""

    command: str
    seconds: float
    complaint: str  # "" if all is well
    changed: str  # files of the clone that differ from the commit

    def row(self) -> str:
        end = f"FAILED: {self.complaint}" if self.complaint else "ok"
        return f"{self.command:52} {self.seconds:6.0f} s  {end}{self.changed and f'; changes {self.changed}'}"


def try_target(checkout: Path, machine: Here | Debian, name: str, variables: str, log: Path) -> Outcome:
    """Run one target in a clone of its own. The clone is removed at the end."""
    command = ["make", "--no-print-directory", name, *shlex.split(variables)]
    folder = Path(tempfile.mkdtemp(prefix="unitylink-fresh-"))
    clone = folder / "checkout"
    started = time.monotonic()
    try:
        git = _git(folder)
        subprocess.run(["git", "clone", "--quiet", checkout, clone], env=git, check=True)
        with log.open("wb") as out:
            running = machine.run(folder, command, out.fileno())
            complaint = _end_of(machine, folder, running)
        status = ["git", "status", "--porcelain"]
        told = subprocess.run(status, cwd=clone, env=git, capture_output=True, text=True, check=True).stdout
        changed = ", ".join(line.split(maxsplit=1)[1] for line in told.splitlines())
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    return Outcome(shlex.join([command[0], *command[2:]]), time.monotonic() - started, complaint, changed)


def _git(folder: Path) -> dict[str, str]:
    """Return an environment in which git reads a checkout of another user.

    In a container, that is often so.
    """
    settings = folder / "gitconfig"
    settings.write_text("[safe]\n\tdirectory = *\n")
    return {**os.environ, "GIT_CONFIG_GLOBAL": str(settings)}


def _end_of(machine: Here | Debian, folder: Path, running: subprocess.Popen[bytes]) -> str:
    """Wait, and end what the target left running. Return what was wrong with its end."""
    try:
        code = running.wait(LONGEST_S)
        return f"exit code {code}" if code else ""
    except subprocess.TimeoutExpired:
        return f"not done after {LONGEST_S} s"
    finally:
        running.kill()
        running.wait()
        machine.end_all(folder)


def run(
    names: Sequence[str],
    forms: Mapping[str, str],
    checkout: Path,
    machine: Here | Debian,
    logs: Path,
) -> list[Outcome]:
    """Try each target.

    After a failure, go on with the next one. Print the progress. Return how each target ended.
    """
    logs.mkdir(parents=True, exist_ok=True)
    outcomes = []
    for number, name in enumerate(names, 1):
        log = logs / f"{name}.log"
        print(f"[{number}/{len(names)}] make {name} {forms[name]} ...", flush=True)
        outcome = try_target(checkout, machine, name, forms[name], log)
        outcomes.append(outcome)
        print(f"  {outcome.seconds:.0f} s, {outcome.complaint or 'ok'}", flush=True)
        if outcome.complaint:
            last = log.read_text(encoding="utf-8", errors="replace").splitlines()[-LAST_LINES:]
            print(f"  the end of {log}:", *last, sep="\n    ", flush=True)
    return outcomes


def main() -> int:
    plain = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=plain)
    parser.add_argument("targets", nargs="*", metavar="TARGET")
    parser.add_argument("--downloads", type=lambda text: Path(text).resolve(), metavar="FOLDER")
    parser.add_argument("--debian", action="store_true")
    arguments = parser.parse_args()
    names = arguments.targets or list(SHORT_FORMS)
    if unknown := [name for name in names if name not in SHORT_FORMS]:
        parser.error(f"no target '{unknown[0]}'; there are: {', '.join(SHORT_FORMS)}")
    logs = ROOT / "build" / "fresh"
    machine: Here | Debian = Here(arguments.downloads)
    if arguments.debian:
        machine = Debian(logs / "debian", arguments.downloads)
        try:
            machine.make()
        except Absent as why:
            parser.exit(1, f"{why}\n")
    if subprocess.check_output(["git", "status", "--porcelain"], cwd=ROOT):
        print("note: what is not committed is not tried")
    # so that what runs is ended, and its clone is removed
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    outcomes = run(names, SHORT_FORMS, ROOT, machine, logs)
    failed = sum(bool(outcome.complaint) for outcome in outcomes)
    print(
        "", *(outcome.row() for outcome in outcomes), f"{failed} of {len(outcomes)} targets failed", sep="\n"
    )
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())
