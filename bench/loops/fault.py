# SPDX-License-Identifier: BSD-3-Clause
"""The time that a component needs from an input to an output, from its clock-true model."""

from __future__ import annotations

from unitylink import _native
from unitylink.interface.components import components_of
from unitylink.spec import compile_text

CLOCK_HZ = 50_000_000
DUTY, CONTROL, FAULT = 3, 0, 0  # words of h_bridge, and its only input
RUNNING_CLOCKS = 40_000  # from its start until its gates change in each period


def fault_clocks() -> list[int]:
    """Return the clocks from a fault until the last change of a gate of h_bridge, sorted.

    The faults come at any time of a period.
    """
    spec = compile_text("link l(ADDRESS=8); public a() { motor: h_bridge(frequency_hz=20000); }").spec
    assert spec is not None
    (one,) = components_of(spec, CLOCK_HZ)
    found = []
    for late in range(0, 2500, 7):  # a period has 2500 clocks
        at = RUNNING_CLOCKS + late
        stimuli = [(10, "w", DUTY, 0x800), (20, "w", CONTROL, 1), (at, "p", FAULT, 1)]
        seen = _native.ComponentModel(one).play(stimuli, at + 5000)
        changes = [clock for clock, what, _, _ in seen if what == "o" and clock > at]
        found += [max(changes) - at] if changes else []  # in a dead time all gates are off already
    return sorted(found)
