# SPDX-License-Identifier: BSD-3-Clause
"""The engine keeps its promises on a bad wire. The long form is `make soak`."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from statistics import median

import pytest
from click.testing import CliRunner

from unitylink import _native
from unitylink.commands.faults import RUN_MESSAGES, History, command, histories

ROOT = Path(__file__).resolve().parents[2]
PROFILES = [name for name, _ in _native.fault_profiles()]
LIARS = ["dead", "half-dead", "closing", "renewing", "refusing"]  # these are devices; the others are wires


def test_pages_name_the_profiles_and_the_shards_of_a_soak() -> None:
    """`make soak` says where the next shard begins. docs/faults.md and the help name the profiles."""
    shard = len(PROFILES) * RUN_MESSAGES  # messages that each seed gives, with one history for each profile
    assert f"SEED + MESSAGES / {shard})" in (ROOT / "Makefile").read_text("utf-8")
    table = (ROOT / "docs" / "faults.md").read_text("utf-8").partition("## The profiles")[2]
    assert re.findall(r"^\| `([\w-]+)` \|", table.partition("## When it fails")[0], re.M) == PROFILES
    assert command.help is not None
    said = command.help.partition("Profiles: ")[2].partition(";")[0]
    assert said.split() == PROFILES


@pytest.mark.parametrize("protocol", ["framed", "classic"])
@pytest.mark.parametrize("profile", PROFILES)
def test_a_history(profile: str, protocol: str) -> None:
    for window in (1, 32):
        history = History(7, 4000, profile, protocol, 16, window)
        report = history.run()
        assert report["violations"] == [], history.command()
        assert report["messages"] >= 4000
        assert report["good"] > 0
        assert (report["faults"] > 0) == (profile != "quiet")


ELSEWHERE = """
import json
from concurrent.futures import ThreadPoolExecutor

from unitylink import _native

kinds = [(name, framed) for name, _ in _native.fault_profiles() for framed in (True, False)]
with ThreadPoolExecutor(8) as pool:
    reports = pool.map(lambda kind: _native.run_faults(3, MESSAGES, *kind, 16, 32), kinds)
    print(json.dumps([report["digest"] for report in reports]))
"""


def test_the_same_seed_gives_the_same_history_on_any_machine() -> None:
    """The same byte by byte in two processes. One of them has fresh memory filled with another pattern."""
    code = ELSEWHERE.replace("MESSAGES", "1500")
    environment = {**os.environ, "MALLOC_PERTURB_": "85"}
    command = [sys.executable, "-c", code]
    other = subprocess.run(command, env=environment, capture_output=True, text=True, check=True, timeout=600)
    kinds = [(profile, protocol) for profile in PROFILES for protocol in ("framed", "classic")]
    ours = [History(3, 1500, *kind, 16, 32).run()["digest"] for kind in kinds]
    assert dict(zip(kinds, json.loads(other.stdout), strict=True)) == dict(zip(kinds, ours, strict=True))
    assert len(set(ours)) == len(kinds)
    assert History(4, 1500, *kinds[0], 16, 32).run()["digest"] != ours[0]


@pytest.mark.parametrize("window", [1, 32])
@pytest.mark.parametrize("protocol", ["framed", "classic"])
@pytest.mark.parametrize("profile", PROFILES)
def test_all_is_as_before_after_the_faults(profile: str, protocol: str, window: int) -> None:
    """On the virtual clock, 50 ms after the last fault, the rate is 95 % of the rate before the first fault.

    Behind a lying device, the 50 ms begin four timeouts later. No operation that begins after them fails.

    With a window of 1, the rates of one history differ by 5 % because of their kinds of requests. So the
    median of three counts.
    """
    shares = []
    for seed in range(1, 4 if window == 1 else 2):
        messages = 80_000 if profile in LIARS and protocol == "framed" and window == 32 else 40_000
        report = History(seed, messages, profile, protocol, 16, window).run()
        assert profile not in LIARS or report["violations"] == []
        assert report["calm_rate_hz"] > 0
        shares.append(report["recovered_rate_hz"] / report["calm_rate_hz"])
    assert median(shares) >= 0.95


@pytest.mark.parametrize("profile", LIARS)
def test_a_device_that_lies_makes_operations_fail(profile: str) -> None:
    """The profile makes operations fail.

    Every step of every history checks that each operation ends in its time.
    """
    report = History(7, 4000, profile, "framed", 16, 32).run()
    assert report["failed"] + report["unknown"] > report["good"]
    assert report["violations"] == []


def test_a_long_run_is_cut_into_histories() -> None:
    whole = History(5, 2 * RUN_MESSAGES + 1, "flips", "framed", 16, 32)
    cut = list(histories(whole))
    assert [(h.seed, h.messages) for h in cut] == [(5, RUN_MESSAGES), (6, RUN_MESSAGES), (7, 1)]


def test_the_command() -> None:
    done = CliRunner().invoke(command, ["--messages", "2000", "--profile", "loss"], standalone_mode=False)
    assert done.exception is None
    assert done.output.splitlines()[-1].endswith("faults, 0 violations")
    assert done.return_value == 0


def test_an_unknown_profile_names_those_there_are() -> None:
    done = CliRunner().invoke(command, ["--profile", "gremlins"])
    assert done.exit_code == 2
    assert "mixed" in done.output
