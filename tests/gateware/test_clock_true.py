# SPDX-License-Identifier: BSD-3-Clause
"""The models of the components do what the VHDL does, at every clock: pins, events and reads."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import pytest
from gateware.clock_true import Case, Trace, play_model, play_vhdl, random_stimuli, sources_of
from gateware.clock_true_cases import CASES
from gateware.clock_true_faults import FAULTS
from gateware.simulators import Ghdl, PatientGhdl

from unitylink import _native
from unitylink.interface.components import ComponentConfiguration, components_of
from unitylink.spec import compile_text
from unitylink.spec.text.imports import component_names

BEGINNING = 8  # one of so many parts
LONG_CLOCKS = 250_000
# Components to which wires lead.
OTHERS = (
    "from: quadrature_encoder(); to: h_bridge(); second: h_bridge(); "
    "other: pid(feedback=from.position, output=second.duty, loop_hz=380000); "
    "bridge: three_phase_pwm(); "
)


def configuration(name: str, case: Case) -> ComponentConfiguration:
    spec = compile_text(
        f"link l(ADDRESS=8); public a() {{ {OTHERS if 'from.' in case.arguments else ''} "
        f"one: {case.device or name}({case.arguments}); }}"
    ).spec
    assert spec is not None
    one = components_of(spec, case.clock_hz)[-1]
    if case.program:
        generics = tuple({**dict(one.generics), "program": case.program, **case.generics}.items())
        one = dataclasses.replace(one, generics=generics)
    return dataclasses.replace(one, event_groups=tuple(range(len(one.events))))


def simulator(clocks: int) -> type[Ghdl]:
    """Return what plays so many clocks soonest."""
    return PatientGhdl if clocks > LONG_CLOCKS else Ghdl


def difference(vhdl: Trace, model: Trace) -> str:
    """Return the first difference of two traces, or nothing."""
    first = next((pair for pair in zip(vhdl, model, strict=False) if pair[0] != pair[1]), None)
    return f"the VHDL gives {first[0]}, the model {first[1]}" if first else ""


def compare(make: Any, folder: Path, one: ComponentConfiguration, stimuli: Any, clocks: int) -> None:
    vhdl = play_vhdl(make, folder, one, stimuli, clocks)
    model = play_model(one, stimuli, clocks)
    assert not (found := difference(vhdl, model)), found
    assert len(vhdl) == len(model)
    if one.entity == "stepgen":  # it plays many clocks at once, and says of each pin when it changed
        assert play_model(one, stimuli, clocks, late=True) == model
    # So a beginning may be compared, too.
    begun = play_model(one, stimuli, clocks // BEGINNING)
    assert begun == [said for said in model if said[0] <= clocks // BEGINNING]
    kinds = {what for _, what, _, _ in vhdl}
    assert kinds >= {"a"} | {"o" for pin in one.pins if pin[1] == "out"} | {"e" for _ in one.events}


def test_every_model_is_compared() -> None:
    assert {name for name in component_names() if _native.has_component_model(name)} == set(CASES)


@pytest.mark.parametrize(("name", "number"), [(name, i) for name in CASES for i in range(len(CASES[name]))])
def test_model_is_clock_true(tmp_path: Path, name: str, number: int) -> None:
    case = CASES[name][number]
    one = configuration(name, case)
    stimuli = random_stimuli(one, case, case.clocks, seed=number)
    compare(simulator(case.clocks), tmp_path, one, stimuli, case.clocks)


# In short one fault of each component, which is the first.
SOME_FAULTS = [
    fault if fault[0] not in [one[0] for one in FAULTS[:at]] else pytest.param(fault, marks=pytest.mark.long)
    for at, fault in enumerate(FAULTS)
]


def faulty_source(fault: tuple[str, int, str, str], sources: Any) -> Path:
    """Return the one source that has the text of a fault, and has it once."""
    name, _, old, _ = fault
    found = [path for path in sources if old in path.read_text(encoding="utf-8")]
    right = [path for path in found if path.stem.startswith(name)] or found
    assert len(right) == 1 and right[0].read_text(encoding="utf-8").count(old) == 1, (fault, right)
    return right[0]


def test_each_fault_has_its_place() -> None:
    tried = {(name, number): configuration(name, CASES[name][number]) for name, number, _, _ in FAULTS}
    for fault in FAULTS:
        faulty_source(fault, sources_of(tried[fault[:2]].entity))


@pytest.mark.parametrize("fault", SOME_FAULTS)
def test_a_fault_is_noticed(tmp_path: Path, fault: tuple[str, int, str, str]) -> None:
    """Most faults show soon, so the beginning is played first."""
    name, number, old, new = fault
    case = CASES[name][number]
    one = configuration(name, case)
    stimuli = random_stimuli(one, case, case.clocks, seed=number)

    def with_fault(folder: Path, sources: Any) -> Any:
        right = faulty_source(fault, sources)
        wrong = folder / right.name
        wrong.write_text(right.read_text(encoding="utf-8").replace(old, new), encoding="utf-8")
        return simulator(clocks)(folder, [*(path for path in sources if path != right), wrong])

    for clocks in (case.clocks // BEGINNING, case.clocks):
        vhdl = play_vhdl(with_fault, tmp_path, one, stimuli, clocks)
        if difference(vhdl, play_model(one, stimuli, clocks)):
            return
    raise AssertionError("the VHDL with a fault does what the model does")


@pytest.mark.long
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("name", CASES)
def test_model_is_clock_true_for_long(tmp_path: Path, name: str, seed: int) -> None:
    case = CASES[name][seed % len(CASES[name])]
    one = configuration(name, case)
    clocks = 1_000_000
    compare(simulator(clocks), tmp_path, one, random_stimuli(one, case, clocks, 100 + seed), clocks)


@pytest.mark.parametrize("clock_mhz", [12, 50, 75, 76, 100, 200])
def test_an_axis_reaches_its_target_with_any_clock(clock_mhz: int) -> None:
    """A phase and its carry have room in a word, so a step up is one."""
    clock_hz = clock_mhz * 1_000_000
    one = configuration("stepgen", Case("axes=2", clock_hz=clock_hz))
    words = {2: 20_000 << 8, 3: 4_000_000 // 64, 1: 60, 0: 1}
    stimuli = [
        (300 + 50 * number, "w", address, value) for number, (address, value) in enumerate(words.items())
    ]
    counted, forward, rests = 0, 1, 0
    for _, what, number, value in play_model(one, stimuli, clock_hz // 100):
        if (what, number) == ("o", 2):
            forward = 1 if value else -1
        elif (what, number, value) == ("o", 0, 1):
            counted += forward
        rests += what == "e"
    assert (counted, rests) == (60, 1)
