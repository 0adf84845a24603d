# SPDX-License-Identifier: BSD-3-Clause
"""The core in GHDL replays the recordings of the 2012 gateware, and answers correctly where that had a
defect.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from unitylink_lab.conformance.chip import ChipPlayer
from unitylink_lab.conformance.replay import Report, difference, replay

FILE = Path(__file__).parents[1] / "conformance" / "classic-transcripts.json"


def wrong(report: Report, status: str) -> str:
    return "\n\n".join(
        "\n".join([f"run {e.run}, {e.name}", *difference(e)])
        for e in report.exchanges
        if e.status == status and not e.passed
    )


@pytest.mark.long
def test_recordings_on_bitstreams() -> None:
    """Each of the 22 cores is placed on an iCE40 HX8K and unpacked again, which takes a minute."""
    report = replay(FILE, ChipPlayer(protocol="classic"))
    failures = wrong(report, "required") + wrong(report, "defect") + wrong(report, "optional")
    assert not failures, failures
    assert (report.passed, report.count("defect", True), report.count("optional", True)) == (366, 57, 16)


def test_recordings(rtl: Any) -> None:
    """The core has both protocols here.

    The command line plays the recordings to a core with classic only (test_rtl.py).
    """

    def player(configuration: Any, exchanges: Any) -> Any:
        # the other datalinks are for classic text only
        chosen = "both" if configuration.datalink == "full" else "classic"
        return rtl(configuration, exchanges, protocol=chosen)

    report = replay(FILE, player)
    failures = wrong(report, "required") + wrong(report, "defect") + wrong(report, "optional")
    assert not failures, failures
    assert report.passed == 366
    assert report.count("defect", True) == 57
    assert report.count("optional", True) == 16
