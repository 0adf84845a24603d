# SPDX-License-Identifier: BSD-3-Clause
"""A run of the bench: what it does if a figure cannot be measured, or does not exist."""

from __future__ import annotations

import pytest

from unitylink_lab.bench import BenchError, Figure, run
from unitylink_lab.bench.figure import Run
from unitylink_lab.bench.start_up import flat_spec
from unitylink_lab.bench.stolen import ProcessorTime


def test_a_figure_that_cannot_be_measured_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(context: Run) -> Figure:
        raise BenchError("there is no index to install LiteX from")

    monkeypatch.setattr("unitylink_lab.bench.litex.measure_single", broken)
    report = run(only=["litex-single", "version"], quick=True, say=lambda message: None)
    assert [figure.name for figure in report.figures] == ["version"]
    assert report.failures == {"litex-single": "there is no index to install LiteX from"}
    assert not report.met
    assert ("stolen by the host %" in report.figures[0].details) == (ProcessorTime.read() is not None)
    assert "litex-single: not measured: there is no index" in report.text()


def test_an_unknown_figure_is_named() -> None:
    with pytest.raises(BenchError, match="no figure speed; there are: sync-read"):
        run(only=["speed"])


def test_flat_spec_is_valid_and_as_long_as_asked() -> None:
    from unitylink.spec import compile_text

    result = compile_text(flat_spec(100).encode(), "flat.ul")
    assert result.spec is not None
    assert sum(1 for _ in result.spec.walk()) == 100
    assert not result.diagnostics
