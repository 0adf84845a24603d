# SPDX-License-Identifier: BSD-3-Clause
"""The committed page follows from the committed results. These have every cell of the paper's table."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import astuple
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from click.testing import CliRunner

from unitylink_lab.bench import FIGURES, Report
from unitylink_lab.bench.figure import Figure
from unitylink_lab.experiments import (
    PARTS,
    markdown,
    pictures,
    report,
    ros_rates,
    scaling,
    software_cost,
    write,
)
from unitylink_lab.experiments.ablations import ABLATIONS, ablations
from unitylink_lab.experiments.claims import CLAIMS
from unitylink_lab.experiments.command import command
from unitylink_lab.experiments.document import Heading
from unitylink_lab.experiments.gateware import GATEWARES
from unitylink_lab.experiments.link_parameters import LINKS
from unitylink_lab.experiments.model_figures import model_figures
from unitylink_lab.experiments.software_cost import SoftwareCost
from unitylink_lab.experiments.table_one import (
    APPROXIMATE,
    CELLS,
    HOST,
    LONG,
    ONE_PACKET,
    STACK_SI,
    TEXT,
    Cell,
)

ROOT = Path(__file__).resolve().parents[3]
RESULTS: dict[str, Any] = json.loads((ROOT / "docs" / "experiments.json").read_text(encoding="utf-8"))


def test_the_page_is_that_of_the_results() -> None:
    check = [sys.executable, ROOT / "tools" / "docs" / "experiments.py", "--check"]
    done = subprocess.run(check, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stderr


def test_the_committed_figures_are_what_the_model_says_today() -> None:
    cost = SoftwareCost(**RESULTS["software_cost"])
    figures = model_figures(cost)
    cells = RESULTS["table_one"] + RESULTS["text"]
    assert len(cells) == len(CELLS) + len(TEXT)
    for cell, row in zip((*CELLS, *TEXT), cells, strict=True):
        assert (row["table"], row["row"], row["quantity"], row["paper"]) == (
            cell.table,
            cell.row,
            cell.quantity,
            cell.paper,
        )
        assert row["model"] == pytest.approx(figures[cell.model]), cell
        assert row["difference"] == pytest.approx(row["model"] / row["paper"] - 1)
        assert row["cause"] == cell.cause.words
        assert [tried["ablation"] for tried in row["tried"]] == list(cell.cause.tried)


def test_what_is_called_a_cause_moves_its_cell_towards_the_paper() -> None:
    """The model is computed again with the change, because a text alone explains nothing."""
    cost = SoftwareCost(**RESULTS["software_cost"])
    figures, changed = model_figures(cost), ablations(cost)

    def distance(cell: Cell, found: dict[str, float]) -> float:
        return abs(found[cell.model] / cell.paper - 1)

    for cell in (*CELLS, *TEXT):
        before, causes = distance(cell, figures), cell.cause.tried
        after = {name: distance(cell, changed[name]) for name in causes}
        if cell.cause.words.startswith("not explained"):
            spoils = {
                name
                for name in causes
                if any(distance(other, changed[name]) > distance(other, figures) + 0.01 for other in CELLS)
            }
            assert all(after[name] > 0.2 or name in spoils or after[name] >= before for name in causes), cell
        elif before > 0.025 and cell.cause not in (APPROXIMATE, LONG):
            assert causes and min(after.values()) < 0.7 * before, cell
    for cell, row in zip((*CELLS, *TEXT), (*RESULTS["table_one"], *RESULTS["text"]), strict=True):
        for tried in row["tried"]:
            assert tried["model"] == pytest.approx(changed[tried["ablation"]][cell.model])


def test_the_numbers_in_the_texts_of_causes_follow_from_paper_and_model() -> None:
    figures = model_figures(SoftwareCost(**RESULTS["software_cost"]))
    script = [cell for cell in CELLS if (cell.row, cell.quantity) == ("Low-level python", "latency")]
    less_us = [round(1e6 * (figures[cell.model] - cell.paper)) for cell in script]
    assert f"the paper {min(less_us)} to {max(less_us)} us less" in HOST.words
    paper = {(cell.table, cell.row): 1e6 * cell.paper for cell in CELLS if cell.quantity == "latency"}
    cost = {
        table: round(paper[table, "Unity-SW"] - paper[table, "Low-level python"])
        for table in ("Read", "Read:SI", "Write", "Write:SI")
    }
    assert f"a read {cost['Read']} us without SI and {cost['Read:SI']} us with it" in STACK_SI.words
    assert f"a write {cost['Write']} and {cost['Write:SI']} us" in STACK_SI.words
    assert f"({cost['Read']} and {cost['Write']} us)" in ABLATIONS["stack"].words
    (burst,) = [cell for cell in CELLS if cell.cause is ONE_PACKET]
    assert f"needed {figures[burst.model] / burst.paper:.1f} microframes" in ONE_PACKET.words


def test_the_report_of_a_run_is_written_whole(tmp_path: Path) -> None:
    write(tmp_path / "new" / "folder", RESULTS)
    folder = tmp_path / "new" / "folder"
    assert json.loads((folder / "results.json").read_text(encoding="utf-8")) == RESULTS
    page = (folder / "report.html").read_text(encoding="utf-8")
    for name, text in pictures(RESULTS).items():
        assert f'src="{name}"' in page
        assert ElementTree.fromstring(text).tag.endswith("svg")
    assert all(cell.cause.words[:40] in (folder / "report.md").read_text() for cell in CELLS)


def test_the_cost_of_software_is_the_median_of_its_rounds(monkeypatch: pytest.MonkeyPatch) -> None:
    """It uses a clock by which the calls of each kind cost 1 us, 2 us ... in their order."""
    costs, taken = iter([1, 2, 3, 4, 5, 6] * 3), []

    def thread_s(call: Callable[[], object], count: int) -> float:
        taken.extend(call() for _ in range(count))
        return next(costs) * 1e-6

    monkeypatch.setattr(software_cost, "thread_s", thread_s)
    cost = software_cost.measure(rounds=3, count=2)
    assert [round(value * 1e6) for value in astuple(cost)] == [1, 2, 3, 4, 5, 6]
    assert len(taken) == 6 * 3 * 2 and taken[0] == b"#S_R:00000000\n", "the requests were made and answered"


def calls_of_a_read(registers: int) -> int:
    """Return how many calls Python makes for 50 reads by name in a spec with `registers` registers."""
    calls = 0

    def count(_frame: object, event: str, _argument: object) -> None:
        nonlocal calls
        calls += event in ("call", "c_call")

    with scaling._words(registers, 1) as turn:
        next(turn).read()
        sys.setprofile(count)
        try:
            for _ in range(50):
                next(turn).read()
        finally:
            sys.setprofile(None)
    return calls


def test_a_read_by_name_costs_the_same_in_a_large_spec() -> None:
    small, large = calls_of_a_read(10), calls_of_a_read(1000)
    assert small > 50 and large == small
    assert scaling.links_s(3, rounds=1, count=6) > 0
    assert scaling.links_wall_s(2, sorted(os.sched_getaffinity(0))[:1], 1, 4) > 0


def test_publishes_in_groups_arrive_and_leave_nothing_behind() -> None:
    told = scaling.publishes(3, 100, 0.3)
    assert told["received_hz"] > 100 and told["publish_s"] > 0
    memory = scaling.memory(1.0)
    assert memory["publishes"] > 1000
    assert memory["grown_bytes"] < 8 << 20


def test_a_folder_that_cannot_be_written_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("unitylink_lab.experiments.run_all", lambda **_: RESULTS)
    (tmp_path / "file").write_text("")
    result = CliRunner().invoke(command, ["--out", str(tmp_path / "file" / "below")])
    assert result.exit_code == 1
    assert "Not a directory" in result.output


def test_what_the_readme_claims_has_its_row() -> None:
    readme = " ".join((ROOT / "README.md").read_text(encoding="utf-8").split())
    headings = {block.text for block in report(RESULTS) if isinstance(block, Heading)}
    for claim in CLAIMS:
        assert " ".join(claim.words.split()) in readme, f"the README does not say {claim.words!r} any more"
        assert claim.section in headings or (ROOT / claim.section).is_file(), claim.section
        assert claim.figure(RESULTS)


def test_every_bullet_of_the_readme_that_claims_something_is_covered() -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    section = readme.partition("## Now with your board")[2].partition("\n## ")[0]
    bullets = [" ".join(part.split()) for part in section.split("\n- ")[1:]]
    covered = [" ".join(claim.words.split()) for claim in CLAIMS]
    # these bullets claim no quality
    told_how = ("The device tells its widths", "`tcp://` and `udp://` lead", "`unitylink generate SPEC")
    missing = [
        bullet
        for bullet in bullets
        if not bullet.startswith(told_how) and not any(words in bullet for words in covered)
    ]
    assert missing == [], "give each a row in experiments/claims.py"


def test_a_part_alone_has_its_section_its_pictures_and_no_claims(tmp_path: Path) -> None:
    one = CliRunner().invoke(command, ["--only", "simplicity", "--out", str(tmp_path)])
    assert one.exit_code == 0, one.output
    page = (tmp_path / "report.md").read_text(encoding="utf-8")
    assert "--only simplicity`" in page and "What the README claims" not in page and "## Table I" not in page
    assert not list(tmp_path.glob("*.svg"))
    assert set(pictures({**RESULTS, "parts": ["publishing"]})) == {"experiments-publishes.svg"}
    wrong = CliRunner().invoke(command, ["--only", "ross"])
    assert wrong.exit_code == 1 and "--only ross: there is no such part" in wrong.output


def test_every_part_has_a_section_and_every_section_its_command() -> None:
    assert RESULTS["parts"] == list(PARTS)
    page = markdown(report(RESULTS))
    assert all(f"--only {part}`" in page for part in PARTS)


def test_every_gateware_has_small_and_large_fifos_on_every_link() -> None:
    cases = {(row["link"], row["gateware"], row["fifo"]) for row in RESULTS["links"]}
    assert cases == {(link.name, name, fifo) for link in LINKS for name in GATEWARES for fifo in (16, 256)}


def test_the_paper_s_deviations_are_drawn() -> None:
    assert sum(cell.sd is not None for cell in CELLS) == 10
    drawn = pictures(RESULTS)["experiments-latencies.svg"].count("h6")
    assert drawn == 2 * sum(cell.sd is not None for cell in CELLS if cell.quantity == "latency")


def test_what_was_not_measured_is_said(tmp_path: Path) -> None:
    absent = "ROS 1 is not here: tools/setup.sh ros installs it on Debian"
    results = {
        **RESULTS,
        "peers": {"rows": [], "failure": "no index"},
        "ros": {"rows": [], "failures": {"ros1-out": absent}},
    }
    write(tmp_path, results)
    page = (tmp_path / "report.md").read_text(encoding="utf-8")
    assert "Not measured: no index" in page and f"Not measured: ros1-out: {absent}" in page


def test_topics_stand_beside_the_paper_s_and_missing_ones_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    details = {"node messages/s": 9000.0, "bare messages/s": 10_000.0}
    figures = [
        Figure(name, "FPGA -> topic, over bare", 0.9, False, 0.9, "x", details)
        for name in ("ros1-out", "dds-in")
    ]
    asked: list[object] = []

    def run(*, only: object, quick: bool, say: object) -> Report:
        asked.append(only)
        return Report(tuple(figures), {"ros1-in": "ROS 1 is not here: tools/setup.sh ros installs it"}, quick)

    monkeypatch.setattr("unitylink_lab.experiments.ros_rates.run", run)
    told = ros_rates.rates(quick=True, say=print)
    assert [(row["name"], row["paper_hz"], row["node_hz"]) for row in told["rows"]] == [
        ("ros1-out", 1800.0, 9000.0),
        ("dds-in", None, 9000.0),
    ]
    assert "tools/setup.sh ros" in told["failures"]["ros1-in"]
    ros_rates.rates(quick=False, say=print)
    assert asked == [ros_rates.FIGURES, (*ros_rates.FIGURES, *ros_rates.SLOWER)]
    assert set(FIGURES) >= {*ros_rates.FIGURES, *ros_rates.SLOWER}
