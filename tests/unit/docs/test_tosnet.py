# SPDX-License-Identifier: BSD-3-Clause
"""The figures of docs/tosnet.md are those of the budget, and each source of its comparison is used."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from unitylink.spec import compile_text
from unitylink.spec.isochrony.budget import budget
from unitylink.spec.isochrony.ring import ring_budget, ring_budgets
from unitylink.spec.model import RingOptions
from unitylink.spec.ring import Ring, RingNode

PAGE = (Path(__file__).resolve().parents[3] / "docs" / "tosnet.md").read_text("utf-8")
ROWS = re.findall(
    r"^\| (\d+)( with all eight registers)? +\| ([\d,]+) +\| ([\d,.]+) us +\| ([\d,]+) +\|$", PAGE, re.M
)


def number(text: str) -> float:
    return float(text.replace(",", ""))


@pytest.mark.parametrize(("nodes", "all_registers", "size", "cycle_us", "rate_hz"), ROWS)
def test_the_cycles_are_those_of_the_budget(
    nodes: str, all_registers: str, size: str, cycle_us: str, rate_hz: str
) -> None:
    own, *others = (RingNode(number, 0xFF if all_registers else 1) for number in range(1, int(nodes) + 1))
    one = ring_budget(Ring(0, own, tuple(others), RingOptions()))
    assert one.cycle_bytes == number(size)
    assert one.cycle_s * 1e6 == pytest.approx(number(cycle_us), abs=0.05)
    assert 1 / one.cycle_s == pytest.approx(number(rate_hz), abs=0.5)


def test_the_page_has_small_and_large_rings() -> None:
    assert [(int(row[0]), bool(row[1])) for row in ROWS] == [(2, False), (5, False), (15, False), (15, True)]


def test_the_robot_of_the_page_has_the_figures_that_it_tells() -> None:
    text, joint = re.findall(r"^```ul\n(.*?)^```", PAGE, re.M | re.S)
    assert not compile_text(joint, "leg.ul").diagnostics
    result = compile_text(text, "scara.ul")
    assert not result.diagnostics and result.spec is not None
    (device,) = result.spec.devices
    line = budget(device, read_many=8)
    (one,) = ring_budgets(result.spec.roots[0], device, line)
    assert [node.id for node in one.nodes] == [1, 2, 3, 4, 5]
    assert f"{1 / one.shortest_s:,.0f} cycles a second" in PAGE
    assert f"{4 / one.shortest_s:,.0f} cycles a second" in PAGE.replace("\n", " ")
    (publish,) = one.publishes
    assert publish.sensor.bound_s is not None
    assert f"{publish.sensor.bound_s * 1e3:.2f} ms old" in PAGE.replace("\n", " ")


def test_each_source_is_cited_and_each_citation_has_one() -> None:
    sources = {int(found) for found in re.findall(r"^(\d+)\. \[", PAGE, re.M)}
    cited = {int(found) for found in re.findall(r"\[(\d+)\]", PAGE)}
    assert sources == cited and len(sources) > 12
