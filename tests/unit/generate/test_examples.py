# SPDX-License-Identifier: BSD-3-Clause
"""The examples run. The files that stand beside their specs are those that are generated from them."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import pytest

from unitylink.generate import stale
from unitylink.spec import load

EXAMPLES = Path(__file__).resolve().parents[3] / "examples"


def test_the_walker_fits_the_paper() -> None:
    for name in ("walker18", "walker18_si"):
        path = EXAMPLES / "walker18" / f"{name}.ul"
        assert len(path.read_text("utf-8").splitlines()) <= 23
        published = [element for _, element in load(path).walk() if element.publish is not None]
        assert len(published) == 18


def test_scara_proxies_are_up_to_date() -> None:
    folder = EXAMPLES / "scara"
    assert stale(load(folder / "scara.ul"), folder) == [], "run: unitylink generate examples/scara/scara.ul"


def test_scara_judges_itself(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """A run that ends elsewhere, or in which a joint never moved, counts as a failure."""
    import numpy as np

    monkeypatch.syspath_prepend(str(EXAMPLES / "scara"))
    # loaded by its path, because every example has a run.py and another test may have imported one
    found = importlib.util.spec_from_file_location("scara_run", EXAMPLES / "scara" / "run.py")
    assert found is not None and found.loader is not None
    example = importlib.util.module_from_spec(found)
    monkeypatch.setitem(sys.modules, found.name, example)
    found.loader.exec_module(example)

    def judged(measured: np.ndarray, snapshot: np.ndarray) -> bool:
        times_s = np.arange(len(measured)) / 100
        return bool(
            example.tell(
                example.Run(
                    phases=(("all", 0.0),),
                    asked_s=times_s,
                    asked=np.zeros((len(measured), 4)),
                    measured_s=times_s,
                    measured=measured,
                    lost=0,
                    rate_hz=100.0,
                    snapshot=snapshot,
                )
            )
        )

    moving = np.outer(np.linspace(0, 50, 20), np.ones(4))
    assert judged(moving, np.zeros(4))
    assert not judged(moving, np.array([0, 0, 3.0, 0]))
    assert "j3 (lift) is 3.00 mm from its set-point" in capsys.readouterr().err
    assert not judged(moving * [1, 1, 1, 0], np.zeros(4))
    assert "j4 never moved" in capsys.readouterr().err
