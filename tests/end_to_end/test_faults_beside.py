# SPDX-License-Identifier: BSD-3-Clause
"""What docs/faults.md says about our side beside LiteX is true, and LiteX's side of it runs."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from unitylink_lab.bench.figure import Run
from unitylink_lab.experiments.peer_faults import FAULTS, Fault, met

HERE = Run(True, Path(__file__).resolve().parents[2], lambda text: None)
NAMED = {fault.name: fault for fault in FAULTS}
FIGURE = "a write and its proof"  # no test checks a time


@pytest.mark.parametrize("fault", [fault for name, fault in NAMED.items() if name != FIGURE], ids=str)
def test_ours_meets_what_litex_is_known_for(fault: Fault) -> None:
    told = met(HERE, fault.ours, fault)
    assert not told.bad, told.text
    assert told.text


@pytest.mark.parametrize("name", ["a write is lost", "a write's datagram is lost"])
def test_litex_meets_it_on_either_wire(name: str, program: Callable[[str], Path]) -> None:
    program("bench_uartbone")
    told = met(HERE, NAMED[name].theirs, NAMED[name])
    assert told.bad
    assert "no error; the word holds 0x40de0088" in told.text
