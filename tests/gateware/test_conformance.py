# SPDX-License-Identifier: BSD-3-Clause
"""The core in GHDL replays the recordings of the 2012 gateware, and answers correctly where that had a
defect.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from unitylink_lab.conformance.replay import Report, difference, replay

FILE = Path(__file__).parents[1] / "conformance" / "classic-transcripts.json"


def wrong(report: Report, status: str) -> str:
    return "\n\n".join(
        "\n".join([f"run {e.run}, {e.name}", *difference(e)])
        for e in report.exchanges
        if e.status == status and not e.passed
    )


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
