# SPDX-License-Identifier: BSD-3-Clause
"""Prove every block and catch every mutant; print the table, and write record and page."""

from __future__ import annotations

import argparse
import json
import resource
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path
from typing import Any

from block import Block, Mutant
from blocks import BLOCKS
from model import model, unreachable
from page import page, table
from solvers import always, followed, inductive, reached, violated, violated_at

from unitylink.errors import ToolError

ROOT = Path(__file__).resolve().parents[2]
RECORD = ROOT / "gateware" / "formal.json"
PAGE = ROOT / "docs" / "gateware" / "formal.md"
TRACES = ROOT / "build" / "formal"

Result = dict[str, Any]


def prove(block: Block) -> Result:
    """Return the figures of a block; raise ToolError if a property fails or a cover is out of reach."""
    begun = _cpu_s()
    with tempfile.TemporaryDirectory(prefix="unitylink-formal-") as folder:
        made = model(block, Path(folder))
        TRACES.mkdir(parents=True, exist_ok=True)
        trace = TRACES / f"{block.name}.vcd"
        failed = violated(made, block.depth, trace)
        if not failed and block.deep and violated_at(made, block.deep) is not None:
            failed = followed(made, trace)
        if failed:
            raise ToolError(f"{block.name}: {', '.join(failed)} can be violated; how is in {trace}")
        if block.induction is not None and not inductive(made, block.induction):
            raise ToolError(f"{block.name}: no induction at depth {block.induction}")
        if block.pdr and not always(made):
            raise ToolError(
                f"{block.name}: a property can be violated after more than {block.searched} clocks"
            )
        covers = unreachable(block, made)
        clocks = reached(covers, block.reached)
        if missing := sorted(set(covers.named) - set(clocks)):
            raise ToolError(f"{block.name}: not reached in {block.reached} clocks: {', '.join(missing)}")
    return {
        "properties": made.named,
        "depth": block.searched,
        "induction": block.induction,
        "pdr": block.pdr,
        "covers": dict(sorted(clocks.items())),
        "seconds": round(_cpu_s() - begun, 1),
    }


def catch(block: Block, mutant: Mutant) -> str:
    """Return the property that notices the fault first; raise ToolError if none does."""
    with tempfile.TemporaryDirectory(prefix="unitylink-formal-") as folder:
        found = violated_at(model(block, Path(folder), mutant), max(block.searched, block.reached))
    if found is None:
        raise ToolError(
            f"{block.name}: nothing notices {mutant.new!r} instead of {mutant.old!r} in {mutant.file}"
        )
    return found[1]


def _cpu_s() -> float:
    """Return the processor time of the programs this process has run; wall time says much of other work."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def run_all(blocks: list[Block], jobs: int) -> tuple[dict[str, Result], list[str]]:
    """Prove `blocks`, so many things at a time; the results of the blocks that passed, and what is wrong."""
    results: dict[str, Result] = {}
    caught: dict[tuple[str, int], str] = {}
    wrong: list[str] = []
    begun = time.monotonic()
    with ProcessPoolExecutor(jobs) as pool:
        # The slow ones first, so that none is left alone at the end.
        tasks = {pool.submit(prove, block): (block, -1) for block in blocks}
        tasks |= {
            pool.submit(catch, block, mutant): (block, number)
            for block in blocks
            for number, mutant in enumerate(block.mutants)
        }
        for done, task in enumerate(as_completed(tasks), 1):
            block, number = tasks[task]
            what = block.name if number < 0 else f"{block.name}, mutant {number + 1}"
            try:
                found = task.result()
                if isinstance(found, dict):
                    results[block.name] = found
                    said = f"{len(found['properties'])} properties hold, {found['seconds']} s"
                else:
                    caught[block.name, number] = found
                    said = f"caught by {found}"
            except ToolError as error:
                wrong.append(str(error))
                said = "FAILED: " + str(error).partition("\n")[0]
            print(f"[{done}/{len(tasks)}, {time.monotonic() - begun:.0f} s] {what}: {said}", flush=True)
    for block in blocks:
        if block.name in results:
            results[block.name]["mutants"] = [
                caught.get((block.name, n), "") for n in range(len(block.mutants))
            ]
    return {block.name: results[block.name] for block in blocks if block.name in results}, wrong


def main() -> int:
    """Prove; 0 if everything holds and every mutant is caught."""
    parser = argparse.ArgumentParser(description=__doc__)
    names = [block.name for block in BLOCKS]
    parser.add_argument(
        "--blocks", nargs="+", choices=names, help="these only; the others keep their figures"
    )
    parser.add_argument("--jobs", type=int, default=2, help="solvers at the same time")
    arguments = parser.parse_args()
    blocks = [block for block in BLOCKS if block.name in (arguments.blocks or names)]
    results, wrong = run_all(blocks, arguments.jobs)
    print("\n" + table(blocks, results))
    for text in wrong:
        print(text, file=sys.stderr)
    # What failed is in neither record nor page.
    known = json.loads(RECORD.read_text(encoding="utf-8")) if RECORD.exists() else {}
    known = {name: known[name] for name in known if name not in {block.name for block in blocks}} | results
    record = {name: known[name] for name in names if name in known}
    RECORD.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    PAGE.write_text(page(record), encoding="utf-8")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
