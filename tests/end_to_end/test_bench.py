# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink bench`: its command line; the figures have tests of their own."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable

Run = Callable[..., "subprocess.CompletedProcess[str]"]


def test_the_figures_have_names(run: Run) -> None:
    names = run("bench", "--list").stdout.split()
    assert {"sync-read", "in-flight", "version"} <= set(names)
    done = run("bench", "--only", "sync-raed")
    assert done.returncode == 2
    assert all(name in done.stderr for name in names)


def test_a_figure_as_json(run: Run) -> None:
    done = run("bench", "--quick", "--only", "version", "--json")
    assert done.returncode == 0, done.stderr
    report = json.loads(done.stdout)
    assert [figure["name"] for figure in report["figures"]] == ["version"]
    assert report["figures"][0]["measured"] > 0
    assert report["quick"] is True
