# SPDX-License-Identifier: BSD-3-Clause
"""Typed objects of C++ against the bare C ABI: the same round trips on one link, in turns."""

from __future__ import annotations

import os
from pathlib import Path

from unitylink.generate import generate, write_files
from unitylink.spec import load

from .awake import processors_awake
from .bare import with_option
from .figure import BenchError, Figure, Run
from .programs import Process, alone, made, twin
from .timing import Comparison, in_turns

WORDS = 36  # of a cycle: 18 positions and 18 targets
CLOCK_HZ = 1_000_000_000  # the device answers at once, as in `exchange`


def measure_read(run: Run) -> Figure:
    """Measure a read of one value."""
    result = _measured(run, "read")
    told = result.told_us("objects", "C ABI")
    return Figure(
        "cpp-read", "a read through objects of C++ / the C ABI, pty", 1.05, True, result.ratio, "x", told
    )


def measure_cycle(run: Run) -> Figure:
    """Measure a cycle of 18 values each way."""
    result = _measured(run, "cycle")
    told = result.told_us("objects", "C ABI")
    return Figure(
        "cpp-cycle",
        "a cycle of 18 values each way through objects of C++ / the C ABI, pty",
        1.05,
        True,
        result.ratio,
        "x",
        told,
    )


def _measured(run: Run, kind: str) -> Comparison:
    program = _program(run)
    with twin("pty", clock_hz=CLOCK_HZ, exchange_size=WORDS) as board:
        url = with_option(board.line(), "protocol=framed")
        with Process([program, url]) as trip, processors_awake():
            for side in ("objects", "abi"):
                trip.series(f"{kind}-{side} 200")
            return in_turns(
                lambda count: trip.series(f"{kind}-objects {count}"),
                lambda count: trip.series(f"{kind}-abi {count}"),
                rounds=run.rounds(101),
                count=200 if not run.quick else 50,
            )


def _program(run: Run) -> Path:
    """Compile the program, with the header made from its spec. One that is newer than its sources stays."""
    source = run.checkout / "bench" / "objects"
    library = run.checkout / "build" / "native"
    if not (library / "libunitylink.so").is_file():
        raise BenchError("build/native/libunitylink.so is not built; `make bench` builds it")
    with alone(run.build / "objects") as folder:
        write_files(generate(load(source / "walker.ul"), "cpp"), folder)
        program = folder / "trip"
        places = [f"-I{folder}", f"-I{run.checkout / 'native' / 'include'}"]
        linked = [f"-L{library}", f"-Wl,-rpath,{library}", "-lunitylink", "-o", str(program)]
        headers = (run.checkout / "native" / "include").rglob("*.h*")
        needs = [source / "trip.cpp", folder / "walker.hpp", *headers]
        if not program.is_file() or program.stat().st_mtime < max(one.stat().st_mtime for one in needs):
            compiler = os.environ.get("CXX", "c++")
            made([compiler, "-std=c++20", "-O2", *places, str(source / "trip.cpp"), *linked])
    return program
