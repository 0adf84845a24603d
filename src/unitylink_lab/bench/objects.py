# SPDX-License-Identifier: BSD-3-Clause
"""Typed objects of C++ against the bare C ABI on one link, and those of Rust against those of C++.

All sides take turns.
"""

from __future__ import annotations

import os
from contextlib import ExitStack
from pathlib import Path

from unitylink.generate import generate, write_files
from unitylink.spec import load

from .awake import processors_awake
from .bare import with_option
from .cargo import cargo_build
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


def measure_rust_read(run: Run) -> Figure:
    """Measure a read of one value in Rust. Each program has a link and a board of its own."""
    programs = (_rust_program(run), _program(run))
    with ExitStack() as stack:
        trips = []
        for program in programs:
            board = stack.enter_context(twin("pty", clock_hz=CLOCK_HZ, exchange_size=WORDS))
            url = with_option(board.line(), "protocol=framed")
            trips.append(stack.enter_context(Process([program, url])))
        stack.enter_context(processors_awake())
        rust, cpp = trips
        for trip in trips:
            trip.series("read-objects 200")
        result = in_turns(
            lambda count: rust.series(f"read-objects {count}"),
            lambda count: cpp.series(f"read-objects {count}"),
            rounds=run.rounds(101),
            count=200 if not run.quick else 50,
        )
    told = result.told_us("Rust", "C++")
    return Figure(
        "rust-read", "a read through objects of Rust / of C++, pty", 1.2, True, result.ratio, "x", told
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


def _rust_program(run: Run) -> Path:
    """Compile the program in Rust, with the crates made from its spec. Cargo sees what is up to date."""
    source = run.checkout / "bench" / "objects"
    library = run.checkout / "build" / "native"
    with alone(run.build / "objects-rust") as folder:
        write_files(generate(load(source / "walker.ul"), "rust"), folder)
        lines = (
            '[package]\nname = "trip"\nversion = "0.1.0"\nedition = "2021"',
            '[dependencies]\nwalker = { path = "rust/walker" }',
            f'[[bin]]\nname = "trip"\npath = "{source / "trip.rs"}"\n',
        )
        manifest, text = folder / "Cargo.toml", "\n".join(lines)
        if not manifest.is_file() or manifest.read_text(encoding="utf-8") != text:
            manifest.write_text(text, encoding="utf-8")
        return cargo_build(folder, library, "--release") / "trip"
