# SPDX-License-Identifier: BSD-3-Clause
"""The figures of ROS can be measured. No test looks at the numbers."""

from __future__ import annotations

import pytest

from unitylink_lab.bench import run


@pytest.mark.parametrize(
    ("name", "of"),
    [
        ("ros1-delay", "us"),
        ("dds-delay", "us"),
        pytest.param("ros1-out", "messages/s", marks=pytest.mark.long),
    ],
)
def test_figure_yields_a_number(name: str, of: str) -> None:
    report = run(only=[name], quick=True, say=lambda message: None)
    assert not report.failures
    (figure,) = report.figures
    assert figure.details[f"node {of}"] > 0 and figure.details[f"bare {of}"] > 0
