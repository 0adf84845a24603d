# SPDX-License-Identifier: BSD-3-Clause
"""The figures of ROS can be measured; their numbers are no business of a test."""

from __future__ import annotations

import pytest

from unitylink.tools.bench import run


@pytest.mark.parametrize("name", ["ros1-out", "dds-in"])
def test_figure_yields_a_number(name: str) -> None:
    report = run(only=[name], quick=True, say=lambda message: None)
    assert not report.failures
    (figure,) = report.figures
    assert figure.measured > 0 and figure.details["bare messages/s"] > 0
