# SPDX-License-Identifier: BSD-3-Clause
"""Prove blocks and catch their mutants. Print progress and the table, and write record and page."""

from __future__ import annotations

import argparse
import json
import resource
import sys
import tempfile
import time
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from pathlib import Path
from typing import Any

import alone
import guides
import large
import merge
import sweep
from block import Block, Mutant
from blocks import BLOCKS
from digest import digest, stale
from model import Model, model, unreachable
from page import page, table
from solvers import (
    always,
    followed,
    inductive,
    reached,
    reached_late,
    violated,
    violated_at,
)

from unitylink.errors import ToolError

ROOT = Path(__file__).resolve().parents[2]
RECORD = ROOT / "gateware" / "formal.json"
PAGE = ROOT / "docs" / "gateware" / "formal.md"
TRACES = ROOT / "build" / "formal"

SECONDS_SILENT = 30  # after so long without a result, the tasks under way are printed

Result = dict[str, Any]


def prove(block: Block) -> Result:
    """Return the figures of a block.

    Raises ToolError if a property fails, or a case or cover is out of reach.
    """
    with tempfile.TemporaryDirectory(prefix="unitylink-formal-") as folder:
        made = model(block, Path(folder))
        TRACES.mkdir(parents=True, exist_ok=True)
        trace = TRACES / f"{block.name}.vcd"
        failed = violated(made, block.depth, trace) if block.depth else []  # with depth 0, only ABC searches
        if not failed and block.deep and violated_at(made, block.deep) is not None:
            failed = followed(made, trace)
        if failed:
            raise ToolError(f"{block.name}: {', '.join(failed)} can be violated; how is in {trace}")
        if block.induction is not None and not _is_inductive(block, made):
            raise ToolError(f"{block.name}: no induction at depth {block.induction}")
        search = sweep.always if block.name in sweep.SWEPT else always
        if block.pdr and not search(made):
            raise ToolError(
                f"{block.name}: a property can be violated after more than {block.searched} clocks"
            )
        for name in block.for_ever:
            if not always(made, name):
                raise ToolError(
                    f"{block.name}: {name} can be violated after more than {block.searched} clocks"
                )
        covers = (large.unreachable if block.guided else unreachable)(block, guides.left(block, made))
        clocks = reached(covers, block.reached)
        for name in set(covers.named) - set(clocks):
            if (
                name.rpartition("_case")[0] in block.for_ever
                and (late := reached_late(covers, name)) is not None
            ):
                clocks[name] = late
        for guide in guides.GUIDES.get(block.name, ()):
            if not (found := reached(guides.guided(block, made, guide), guide.reach)):
                raise ToolError(f"{block.name}: {guide.cover} is not reached with its guide")
            clocks |= found
        if missing := sorted(set(covers.named) - set(clocks)):
            raise ToolError(
                f"{block.name}: search deeper, or claim less; "
                f"not reached in {block.reached} clocks: {', '.join(missing)}"
            )
    return {
        "properties": made.named,
        "depth": block.searched,
        "induction": block.induction,
        "pdr": block.pdr,
        "for_ever": list(block.for_ever),
        "covers": dict(sorted(clocks.items())),
        "digest": digest(block),
    }


def _is_inductive(block: Block, made: Model) -> bool:
    assert block.induction is not None
    if block.name in merge.MERGED:
        return merge.inductive(made, block.induction)
    if block.name in alone.ALONE:
        return alone.inductive(made, block.induction)
    return (large.inductive if block.by_abc else inductive)(made, block.induction)


def catch(block: Block, mutant: Mutant) -> str:
    """Return the property that notices the fault first. Raises ToolError if none does."""
    with tempfile.TemporaryDirectory(prefix="unitylink-formal-") as folder:
        made = model(block, Path(folder), mutant)
        if block.by_abc:
            if not _is_inductive(block, made):
                return "induction"
        elif found := violated_at(made, block.reached):
            return found[1]
        for name in block.for_ever:
            if not always(made, name):
                return name
    raise ToolError(
        f"{block.name}: nothing notices {mutant.new!r} instead of {mutant.old!r} in {mutant.file}"
    )


def timed(block: Block, mutant: Mutant | None) -> tuple[Result | str, float]:
    """Do one task. Return its result and its processor seconds, because wall time depends on other work."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    found = prove(block) if mutant is None else catch(block, mutant)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return found, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def run_all(blocks: list[Block], jobs: int) -> tuple[dict[str, Result], list[str]]:
    """Prove `blocks`, with so many tasks at a time.

    Return the results of the blocks that passed, and what is wrong.
    """
    results: dict[str, Result] = {}
    caught: dict[tuple[str, int], str] = {}
    wrong: list[str] = []
    begun = time.monotonic()
    with ProcessPoolExecutor(jobs) as pool:
        # The slow rows are last in the table. They are started first, so that none runs alone at the end.
        tasks: dict[Future[tuple[Result | str, float]], tuple[Block, int]] = {}
        for block in reversed(blocks):
            tasks[pool.submit(timed, block, None)] = (block, -1)
        for block in reversed(blocks):
            for number, mutant in enumerate(block.mutants):
                tasks[pool.submit(timed, block, mutant)] = (block, number)
        print(f"{len(blocks)} blocks, {len(tasks)} tasks, {jobs} at a time", flush=True)
        left = set(tasks)
        while left:
            done, left = wait(left, timeout=SECONDS_SILENT, return_when=FIRST_COMPLETED)
            if not done:
                under_way = ", ".join(
                    _named(*tasks[task]) for task in tasks if task in left and task.running()
                )
                print(f"[{time.monotonic() - begun:.0f} s] under way: {under_way}", flush=True)
            for task in done:
                block, number = tasks[task]
                try:
                    found, seconds = task.result()
                    if isinstance(found, dict):
                        results[block.name] = found
                        said = f"{len(found['properties'])} properties hold, {seconds:.1f} s"
                    else:
                        caught[block.name, number] = found
                        said = f"caught by {found}"
                except ToolError as error:
                    wrong.append(str(error))
                    said = "FAILED: " + str(error).partition("\n")[0]
                passed = f"{len(tasks) - len(left)}/{len(tasks)}, {time.monotonic() - begun:.0f} s"
                print(f"[{passed}] {_named(block, number)}: {said}", flush=True)
    for block in blocks:
        if block.name in results:
            results[block.name]["mutants"] = [
                caught.get((block.name, n), "") for n in range(len(block.mutants))
            ]
    return {block.name: results[block.name] for block in blocks if block.name in results}, wrong


def _named(block: Block, mutant: int) -> str:
    return block.name if mutant < 0 else f"{block.name}, mutant {mutant + 1}"


def main() -> int:
    """Prove everything. Return 0 if all properties hold and every mutant is caught."""
    parser = argparse.ArgumentParser(description=__doc__)
    names = [block.name for block in BLOCKS]
    parser.add_argument(
        "--blocks",
        nargs="+",
        choices=names,
        help="these only; the others keep their figures",
    )
    parser.add_argument("--stale", action="store_true", help="only those whose sources have changed since")
    parser.add_argument("--jobs", type=int, default=2, help="solvers at the same time")
    arguments = parser.parse_args()
    known = json.loads(RECORD.read_text(encoding="utf-8")) if RECORD.exists() else {}
    wanted = stale(BLOCKS, known) if arguments.stale else arguments.blocks or names
    blocks = [block for block in BLOCKS if block.name in wanted]
    results, wrong = run_all(blocks, arguments.jobs)
    print("\n" + table(blocks, results))
    for text in wrong:
        print(text, file=sys.stderr)
    # A block that failed is neither in the record nor on the page.
    known = {name: known[name] for name in known if name not in {block.name for block in blocks}} | results
    record = {name: known[name] for name in names if name in known}
    RECORD.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    PAGE.write_text(page(record), encoding="utf-8")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
