# SPDX-License-Identifier: BSD-3-Clause
"""The models of the components do what the VHDL does, at every clock: pins, events and reads."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import pytest
from gateware.clock_true import Case, play_model, play_vhdl, random_stimuli

from unitylink import _native
from unitylink.interface.components import ComponentConfiguration, components_of
from unitylink.spec import compile_text
from unitylink.spec.text.imports import component_names

CASES = {
    "gpio": (
        Case("pins=8"),
        Case("pins=1, stable_clocks=3", pause=2000),
        Case("pins=32, stable_clocks=2"),
    ),
    "pwm": (
        Case(
            "channels=3, counter_bits=15",
            {0: (0, 1, 1, 1, 1, 3), 1: (0, 1, 2, 7, 40, 300)}
            | dict.fromkeys((2, 3, 4), (0, 1, 5, 40, 41, 1000)),
        ),
        Case(
            "channels=2, counter_bits=15, servo_minimum_us=1, servo_maximum_us=9",
            {0: (0, 3, 3, 3, 1), 1: (0, 20, 30)} | dict.fromkeys((2, 3), (0, 1, 5, 9, 400)),
            pause=2000,
        ),
    ),
    "quadrature_encoder": (
        Case(values={3: (0,)}),
        Case("stable_clocks=1", pause=2000),
        Case("stable_clocks=5"),
    ),
}
CLOCK_HZ = 2_300_000  # so that a microsecond is no whole number of clocks


def configuration(name: str, case: Case) -> ComponentConfiguration:
    spec = compile_text(f"link l(ADDRESS=8); public a() {{ one: {name}({case.arguments}); }}").spec
    assert spec is not None
    (one,) = components_of(spec, CLOCK_HZ)
    return dataclasses.replace(one, event_groups=tuple(range(len(one.events))))


def compare(make: Any, folder: Path, one: ComponentConfiguration, stimuli: Any, clocks: int) -> None:
    vhdl = play_vhdl(make, folder, one, stimuli, clocks)
    model = play_model(one, stimuli, clocks)
    first = next((pair for pair in zip(vhdl, model, strict=False) if pair[0] != pair[1]), None)
    assert first is None, f"the VHDL gives {first[0]}, the model {first[1]}"
    assert len(vhdl) == len(model)
    kinds = {what for _, what, _, _ in vhdl}
    assert kinds >= {"a"} | {"o" for pin in one.pins if pin[1] == "out"} | {"e" for _ in one.events}


def test_every_model_is_compared() -> None:
    assert {name for name in component_names() if _native.has_component_model(name)} == set(CASES)


@pytest.mark.parametrize(("name", "number"), [(name, i) for name in CASES for i in range(len(CASES[name]))])
def test_model_is_clock_true(ghdl: Any, tmp_path: Path, name: str, number: int) -> None:
    case = CASES[name][number]
    one = configuration(name, case)
    compare(type(ghdl), tmp_path, one, random_stimuli(one, case, 20_000, seed=number), 20_000)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("name", CASES)
def test_model_is_clock_true_for_long(ghdl: Any, tmp_path: Path, name: str, seed: int) -> None:
    case = CASES[name][seed % len(CASES[name])]
    one = configuration(name, case)
    clocks = 1_000_000
    compare(type(ghdl), tmp_path, one, random_stimuli(one, case, clocks, 100 + seed), clocks)
