# SPDX-License-Identifier: BSD-3-Clause
"""The cost on this host when there are more registers, links, cores, groups or higher rates, and the memory
over time.
"""

from __future__ import annotations

import os
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from itertools import cycle
from pathlib import Path
from statistics import median
from typing import Any

from unitylink_lab.bench.programs import twin

from .software_cost import on_processors, thread_s

REGISTERS = (10, 100, 1000, 5000)
LINKS = (1, 2, 4, 8, 16, 32)
GROUPS = (1, 4, 16)
GROUP_HZ = 1000
RATES_HZ = (100, 1000, 10_000, 100_000)
MEMORY_HZ = 10_000
_PAGE_BYTES = os.sysconf("SC_PAGE_SIZE")


def scaling(*, rounds: int, window_s: float, memory_s: float, count: int = 100) -> dict[str, Any]:
    """Return three things: the cost of a read by name against registers and links, the cost of publishes
    against groups and rates, and the growth of the memory over `memory_s` of publishes.
    """
    cores = sorted(os.sched_getaffinity(0))
    return {
        "registers": [
            {"count": number, "read_s": registers_s(number, rounds=rounds, count=count)}
            for number in REGISTERS
        ],
        "links": [
            {"count": number, "read_s": links_s(number, rounds=rounds, count=count)} for number in LINKS
        ],
        "cores": [
            {"links": number, "cores": len(some), "read_s": links_wall_s(number, some, rounds, count)}
            for some in (cores[:1], cores[:2])
            for number in LINKS
        ],
        "groups": [
            {"count": number, "hz": GROUP_HZ, **publishes(number, GROUP_HZ, window_s)} for number in GROUPS
        ],
        "rates": [{"hz": hz, **publishes(1, hz, window_s)} for hz in RATES_HZ],
        "memory": memory(memory_s),
    }


def registers_s(number: int, *, rounds: int, count: int) -> float:
    """Return the seconds of a read. The reads are spread over the registers of a spec."""
    with on_processors(), _words(number, 1) as turn:
        return median(thread_s(lambda: next(turn).read(), count) for _ in range(rounds))


def links_s(number: int, *, rounds: int, count: int) -> float:
    """Return the seconds of a read. The reads go in turns over several links in one process."""
    with on_processors(), _words(1, number) as turn:
        return median(thread_s(lambda: next(turn).read(), count) for _ in range(rounds))


def links_wall_s(number: int, cores: Sequence[int], rounds: int, count: int) -> float:
    """Return the wall time of such a read. The process and its boards stay on `cores`."""
    with on_processors(cores), _words(1, number) as turn:
        samples = []
        for _ in range(rounds):
            start = time.perf_counter()
            for _ in range(count):
                next(turn).read()
            samples.append((time.perf_counter() - start) / count)
        return median(samples)


def publishes(groups: int, hz: int, window_s: float) -> dict[str, float]:
    """Return the cost in layer 4 of several groups of one word, which another process publishes at `hz`."""
    with _publishing(groups, hz) as tree:
        first, start, cpu = _received(tree), time.perf_counter(), time.process_time()
        time.sleep(window_s)
        cpu, wall_s = time.process_time() - cpu, time.perf_counter() - start
        taken = _received(tree) - first
    return {"received_hz": taken / wall_s, "core": cpu / wall_s, "publish_s": cpu / max(taken, 1)}


def memory(duration_s: float) -> dict[str, float]:
    """Return how the memory of this process grows while publishes come. The first fifth is a warm-up."""
    with _publishing(1, MEMORY_HZ) as tree:
        time.sleep(duration_s / 5)
        first, before = _received(tree), _resident_bytes()
        time.sleep(duration_s * 4 / 5)
        taken, grown = _received(tree) - first, _resident_bytes() - before
    return {"duration_s": duration_s, "publishes": taken, "grown_bytes": grown, "resident_bytes": before}


def _resident_bytes() -> int:
    return int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1]) * _PAGE_BYTES


def _received(tree: Any) -> int:
    return sum(report.received for report in tree.publisher.reports())


def _spec(lines: str) -> Any:
    from unitylink.spec import compile_text

    spec = compile_text(f"link plain;\npublic many() {{\n{lines}}}\n".encode(), "many.ul").spec
    assert spec is not None
    return spec


@contextmanager
def _words(registers: int, links: int) -> Iterator[Iterator[Any]]:
    """Yield the words of the registers on each link in turn, without end."""
    from unitylink import connect
    from unitylink.layer4_data import load_spec_objects
    from unitylink.simulate import Board, BoardConfiguration

    spec = _spec("".join(f'   @r{n} = {n:#x}: READ(ID="r{n}");\n' for n in range(registers)))
    configuration = BoardConfiguration.for_spec(spec)
    with ExitStack() as stack:
        words: list[Any] = []
        for _ in range(links):
            board = stack.enter_context(Board(configuration=configuration))
            tree = load_spec_objects(spec, stack.enter_context(connect(f"{board.url}?timeout=10")))
            words += [tree[f"r{n}"] for n in range(0, registers, max(1, registers // 16))]
        yield cycle(words)


@contextmanager
def _publishing(groups: int, hz: int) -> Iterator[Any]:
    """Yield a tree of objects. A twin in another process publishes its words, each in a group of its own."""
    from unitylink import connect
    from unitylink.layer4_data import load_spec_objects

    spec = _spec("".join(f"   @w{n} = {n:#x}: READ(PUBLISH(1,1,GROUP=g{n}));\n" for n in range(groups)))
    with (
        twin("tcp", base_hz=hz, groups=groups, clock_hz=1_000_000_000) as board,
        connect(f"{board.line()}?timeout=5") as link,
    ):
        tree = load_spec_objects(spec, link)
        with tree.publishing():
            yield tree
