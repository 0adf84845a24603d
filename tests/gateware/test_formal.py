# SPDX-License-Identifier: BSD-3-Clause
"""The short form of `make formal`: quick blocks hold and notice a fault. Rows, record and page agree."""

from __future__ import annotations

import dataclasses
import importlib
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from unitylink.errors import ToolError
from unitylink.gateware import every_source, property_sources

ROOT = Path(__file__).resolve().parents[2]
GATEWARE = ROOT / "gateware"
RECORD = json.loads((GATEWARE / "formal.json").read_text(encoding="utf-8"))


@pytest.fixture
def tools(monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    """Import tools/formal, which is no package, by its name."""
    monkeypatch.syspath_prepend(str(ROOT / "tools" / "formal"))
    yield importlib.import_module


def block_of(tools: Any, name: str) -> Any:
    return next(block for block in tools("blocks").BLOCKS if block.name == name)


def test_no_proof_is_stale(tools: Any) -> None:
    stale = tools("digest").stale(tools("blocks").BLOCKS, RECORD)
    assert not stale, f"their sources have changed: make formal BLOCKS='{' '.join(stale)}'"


def test_the_digest_is_of_all_that_the_block_is_made_of(tools: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    digests = tools("digest")
    block = block_of(tools, "frame_application")
    names = {path.name for path in digests.sources_of(block)}
    assert {
        "frame_application_formal.vhd",
        "frame_post_pkg.vhd",
        "bii_user_view.vhd",
        "protocol_pkg.vhd",
    } <= names
    assert "wishbone_master.vhd" not in names
    before = digests.digest(block)
    assert digests.digest(dataclasses.replace(block, not_proven="other words")) == before
    assert digests.digest(dataclasses.replace(block, deep=block.deep - 1)) != before
    read = digests.plain_text
    monkeypatch.setattr(
        digests, "plain_text", lambda path: read(path) + " x" * (path.name == "frame_post_pkg.vhd")
    )
    assert digests.digest(block) != before


def test_the_guide_of_a_cover_is_in_the_digest_of_its_block_alone(
    tools: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    digests, guides = tools("digest"), tools("guides").GUIDES
    assert guides.keys() & RECORD.keys()
    for name, those in ((name, guides[name]) for name in guides if name in RECORD):
        late = {label.rpartition(".")[2]: clock for label, clock in RECORD[name]["covers"].items()}
        assert all(block_of(tools, name).reached < late[guide.cover] <= guide.reach for guide in those), (
            "a cover that is not so deep needs no guide"
        )
    blocks = [block_of(tools, name) for name in ("crc8", *guides)]
    before = [digests.digest(block) for block in blocks]
    read = digests._python
    monkeypatch.setattr(digests, "_python", lambda path: read(path) + "x" * (path.name == "guides.py"))
    assert [digests.digest(block) == old for block, old in zip(blocks, before, strict=True)] == [
        block.name not in guides for block in blocks
    ]


def test_a_comment_makes_no_proof_stale(tools: Any, tmp_path: Path) -> None:
    path = tmp_path / "some.vhd"
    path.write_text('a <= "--";  -- why\n', encoding="utf-8")
    assert tools("digest").plain_text(path) == 'a <= "--";'


@pytest.mark.parametrize(
    ("claim", "moments"),
    [
        ("a = '1' -> b", ["true = ((a = '1'))"]),
        ("a = '1' -> next (b)", ["true = ((a = '1')); true"]),
        ("a = '1' -> next[3] (b)", ["true = ((a = '1')); true; true; true"]),
        ("a -> next (b or c -> next (d))", ["true = ((a)); true = ((b or c)); true"]),
        ("begun = '0' or c = d", ["true = ((not (begun = '0')))"]),
        ("a -> holds(b and (c or d))", ["true = ((a))", "true = ((a) and (not (c)))"]),
        ("waited <= most", ["true = ((waited = most))"]),
        ("a -> waited < 2 * most", ["true = ((a) and (waited = 2 * most - 1))"]),
        ("(a and b) = c", []),
    ],
)
def test_each_part_of_a_claim_has_its_moment(tools: Any, claim: str, moments: list[str]) -> None:
    assert tools("cases").cases(claim) == moments


def late_block(tools: Any, depth: int, **others: Any) -> Any:
    """Return the block `fifo`, searched for fewer clocks than it takes to fill it.

    It is bounded unless `others` say otherwise.
    """
    return dataclasses.replace(block_of(tools, "fifo"), **{"depth": depth, "pdr": False} | others)


def test_a_property_whose_moment_is_not_searched_is_refused(tools: Any) -> None:
    with pytest.raises(ToolError, match=r"not reached in 5 clocks: .*never_overflows_case"):
        tools("prove").prove(late_block(tools, 5))
    assert not tools("prove").prove(late_block(tools, 5, pdr=True, reach=10))["induction"]


def test_a_bounded_proof_has_no_covers_beyond_its_search(tools: Any) -> None:
    with pytest.raises(ValueError, match="fifo: what a bounded proof does not search"):
        late_block(tools, 5, reach=10)


def test_the_page_says_how_far_each_proof_goes(tools: Any) -> None:
    rows = dict(
        re.findall(
            r"^\| (proven for ever|proven for a number of clocks|in no proof)[^|]*\| (.*) \|$",
            (ROOT / "docs" / "gateware" / "formal.md").read_text(encoding="utf-8"),
            re.MULTILINE,
        )
    )
    bounded = {
        name: found["depth"] for name, found in RECORD.items() if not found["induction"] and not found["pdr"]
    }
    assert re.findall(r"\[(\w+)\]", rows["proven for ever"]) == [
        name for name in RECORD if name not in bounded
    ]
    said = re.findall(r"\[(\w+)\]\S* \((\d+)\)", rows["proven for a number of clocks"])
    assert {name: int(depth) for name, depth in said} == bounded
    left = re.findall(r"`(\w+)`", rows["in no proof"])
    assert left == tools("page").in_no_proof()
    # These rows are about the lines, that is about absolute_encoder_line, spi_master and i2c_device_master.
    assert set(left) & set(RECORD) == {"absolute_encoder", "spi_device", "i2c_device"}
    assert not {"absolute_encoder_line", "spi_master", "i2c_device_master"} & set(left)


def test_the_small_engine_has_an_effect_only_where_the_facts_allow_it(tools: Any) -> None:
    facts, program = tools("small_facts"), tools("small_blocks").PLAIN
    found = facts.Analysis(program)
    effects = [
        place
        for place, line in enumerate(program.lines)
        if (line.operation, line.operand)
        in {("out", "read"), ("out", "write"), ("tell", "start"), ("tell", "arm")}
    ]
    assert len(effects) == 4
    sites = found.sites()
    kinds = []
    for place in effects:
        # A WRITE and a POST write in the same routine: there the facts are those that its call has kept, too.
        for kept in [found.carried[site] for site in sites.get(place, ())] or [0]:
            known = found.facts[place] | kept
            assert known & facts.BIT["none"]
            next_post = known & facts.BIT["is_post"] and known & facts.BIT["next"]
            assert known & facts.BIT["older"] or next_post
            kinds.append(bool(next_post))
    assert sorted(kinds) == [False] * 4 + [True]
    assert found.facts[program.labels["done"]] & facts.BIT["settled"]


def test_a_fact_ends_where_a_byte_of_it_is_stored(tools: Any) -> None:
    facts, small = tools("small_facts"), tools("small_blocks")
    text = small._assemble.SOURCE.read_text(encoding="utf-8")
    # The id changes behind `judge`, so nothing is known about it at the access.
    changed = text.replace("            out read\n", "            st id_l\n            out read\n")
    program = small._assemble.assemble(changed, "plain")
    place = next(
        at for at, line in enumerate(program.lines) if (line.operation, line.operand) == ("out", "read")
    )
    assert not facts.Analysis(program).facts[place] & facts.BIT["older"]


QUICK = ["fifo", "crc8", "wishbone_interconnect"]


@pytest.mark.parametrize("name", QUICK)
def test_a_quick_block_is_proven(tools: Any, name: str) -> None:
    block = block_of(tools, name)
    found = tools("prove").prove(block)
    assert found["properties"] == RECORD[name]["properties"], "`make formal` records what is new"
    assert found["covers"] == RECORD[name]["covers"]


@pytest.mark.parametrize("name", QUICK)
def test_a_quick_block_notices_a_fault(tools: Any, name: str) -> None:
    block = block_of(tools, name)
    assert tools("prove").catch(block, block.mutants[0]) in RECORD[name]["properties"]


def test_each_property_alone_is_the_same_induction(tools: Any, tmp_path: Path) -> None:
    block = block_of(tools, "wishbone_interconnect")
    for mutant in (None, block.mutants[0]):
        folder = tmp_path / ("sound" if mutant is None else "faulty")
        folder.mkdir()
        made = tools("model").model(block, folder, mutant)
        assert tools("alone").inductive(made, block.induction) == (mutant is None)
        assert tools("solvers").inductive(made, block.induction) == (mutant is None)


def test_a_fault_that_is_none_is_not_noticed(tools: Any) -> None:
    mutant = tools("block").Mutant("fifo.vhd", "loaded <= load or", "loaded <= load  or")
    with pytest.raises(ToolError, match="0 times instead of once"):
        tools("prove").catch(block_of(tools, "fifo"), mutant)
    mutant = tools("block").Mutant(
        "fifo.vhd", "store <= write_valid and not full", "store <= not full and write_valid"
    )
    with pytest.raises(ToolError, match="fifo: nothing notices"):
        tools("prove").catch(block_of(tools, "fifo"), mutant)


def test_a_property_that_is_printed_in_an_unknown_way_is_refused(tools: Any) -> None:
    with pytest.raises(ToolError, match="not known here"):
        tools("model").with_properties("  hold: assert n1_o = '1' severity surprise; --  restrict")


def test_quick_rows_are_those_of_the_test(tools: Any) -> None:
    assert [block.name for block in tools("blocks").BLOCKS if block.quick] == QUICK


def test_rows_and_property_files_belong_together(tools: Any) -> None:
    files = {path.stem for path in property_sources() if path.stem.endswith("_formal")}
    assert files == {block.top for block in tools("blocks").BLOCKS}


def test_every_property_has_a_sentence_and_every_block_a_mutant(tools: Any) -> None:
    for block in tools("blocks").BLOCKS:
        assert block.mutants, block.name
        assert all(sentence.endswith(".") for _, _, sentence in tools("page").sentences(block.name)), (
            block.name
        )


def test_the_text_of_every_mutant_occurs_once(tools: Any) -> None:
    sources = {path.name: path.read_text(encoding="utf-8") for path in every_source()}
    wrong = [
        (block.name, mutant.old)
        for block in tools("blocks").BLOCKS
        for mutant in block.mutants
        if sources[mutant.file].count(mutant.old) != 1
    ]
    assert not wrong


def test_the_record_is_complete_and_the_page_is_the_record(tools: Any) -> None:
    blocks = tools("blocks").BLOCKS
    assert list(RECORD) == [block.name for block in blocks], "`make formal` proves what is new"
    for block in blocks:
        found = RECORD[block.name]
        written = {
            re.sub(r".*\.", "", label)
            for label, kind, _ in tools("page").sentences(block.name)
            if kind == "assert"
        }
        proven = {re.sub(r".*\.", "", name) for name in found["properties"]}
        assert written <= proven, block.name
        assert (found["depth"], found["induction"], found["pdr"], found["for_ever"]) == (
            block.searched,
            block.induction,
            block.pdr,
            list(block.for_ever),
        )
        assert len(found["mutants"]) == len(block.mutants) and all(found["mutants"]), block.name
    assert (ROOT / "docs" / "gateware" / "formal.md").read_text(encoding="utf-8") == tools("page").page(
        RECORD
    )
