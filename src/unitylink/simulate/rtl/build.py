# SPDX-License-Identifier: BSD-3-Clause
"""From a design to a shared library: GHDL, the repairs, Verilator, the C++ compiler."""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import sys
import tempfile
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cached_property
from pathlib import Path

from unitylink.errors import ToolError
from unitylink.gateware import gateware_sources, netlist, run_tool
from unitylink.resources import resource_folder

from .cache import cached
from .design import RtlDesign, RtlModel
from .trace import program_texts, traced
from .verilated import has_one_trigger
from .verilog import either_edge_will_do, model_of, pins_of, stream_ports_of

Progress = Callable[[str], None]

_HERE = Path(__file__).parent
_MAKERS = [
    _HERE / name
    for name in ("build.py", "verilog.py", "lean.py", "verilated.py", "model.cpp", "trace.py", "trace.cpp")
]
_VERILATOR = (
    "--cc",
    "--language",
    "1364-2005",
    "-O3",
    "-fno-case",
    "--x-assign",
    "fast",
    "--x-initial",
    "fast",
    "-Wno-fatal",
)
_COMPILE = (
    "-std=c++20", "-fPIC", "-fvisibility=hidden", "-fno-gnu-unique", "-w",
    "-DVM_COVERAGE=0", "-DVM_SC=0", "-DVM_TRACE=0",
)  # fmt: skip
_LINK = ("-shared", "-Wl,-Bsymbolic", "-pthread")  # so that two models in one program stay separate
_SECONDS_MOST = 900.0
_LINES_SHOWN = 20


def build_model(design: RtlDesign, progress: Progress | None = None) -> RtlModel:
    """Return `design`, compiled. The first time takes about half a minute. Later it comes from the cache.

    `progress` gets the name of each step, and "" at the end. By default it is a line on stderr, if that is a
    terminal. Raises ToolError.
    """
    tools = _Tools()
    say = progress if progress is not None else on_terminal()

    def build(library: Path) -> None:
        with tempfile.TemporaryDirectory(prefix="unitylink-rtl-") as folder:
            _build(design, tools, Path(folder), library, say)

    try:
        library = cached(_key(design, tools), build, say)
    finally:
        say("")
    return RtlModel(str(library), design.read_addresses, design.write_addresses, design.pin_places)


def build_of_netlist(verilog: str, top: str, say: Progress, pins: Sequence[str] = ()) -> str:
    """Return the shared library of the netlist `verilog` of `top`, from the cache if it is there.

    `pins` are names of ports of it.

    Raises ToolError if Verilator or the C++ compiler is missing, or refuses it.
    """
    tools = _Tools("verilator")
    parts = [tools.versions, repr((_VERILATOR, _COMPILE, _LINK, top, pins)), verilog]
    parts += [path.read_text(encoding="utf-8") for path in (_interface(), *_MAKERS)]
    key = hashlib.sha256("\0".join(parts).encode()).hexdigest()[:32]

    def build(library: Path) -> None:
        compile_netlist(verilog, top, library, tools=tools, say=say, pins=pins)

    try:
        return str(cached(key, build, say))
    finally:
        say("")


def _interface() -> Path:
    return resource_folder("native") / "include" / "unitylink" / "rtl_model.h"


class _Tools:
    """The programs that it needs. All of them are searched before anything starts."""

    def __init__(self, *others: str) -> None:
        self.compiler = os.environ.get("CXX") or next(
            (name for name in ("c++", "g++", "clang++") if shutil.which(name)), "g++"
        )
        self.names = (*(others or ("ghdl", "verilator")), self.compiler)
        needed = {name: name for name in self.names} | {self.compiler: "g++"}
        if missing := [name for name in needed if shutil.which(name) is None]:
            raise ToolError(
                f"missing: {', '.join(missing)}; simulating the gateware itself needs GHDL, Verilator and a "
                "C++ compiler; on Debian or Ubuntu: sudo apt-get install "
                + " ".join(needed[name] for name in missing)
            )

    @cached_property
    def versions(self) -> str:
        return "\n".join(_run([name, "--version"]) for name in self.names)

    def verilator_include(self) -> Path:
        return Path(_run(["verilator", "--getenv", "VERILATOR_ROOT"]).strip()) / "include"


def _key(design: RtlDesign, tools: _Tools) -> str:
    """Return a hash of everything that goes into the library."""
    parts = [
        tools.versions,
        repr((_VERILATOR, _COMPILE, _LINK, design.top, sorted(design.generics.items()), design.pins)),
        design.trace_program and repr((design.trace_program, design.settings, program_texts())),
    ]
    parts += [f"{path.name}\n{path.read_text(encoding='utf-8')}" for path in gateware_sources()]
    parts += [f"{name}\n{text}" for name, text in sorted(design.files.items())]
    parts += [path.read_text(encoding="utf-8") for path in (_interface(), *_MAKERS)]
    repairs = Path(netlist.__code__.co_filename).parent
    parts += [path.read_text(encoding="utf-8") for path in sorted(repairs.glob("*.py"))]
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:32]


def _build(design: RtlDesign, tools: _Tools, folder: Path, library: Path, say: Progress) -> None:
    say(f"compiling the gateware of {design.top}, this once: ghdl")
    verilog = netlist_of(design, folder)
    calls = ""
    if design.trace_program:
        verilog, calls = traced(verilog, design.trace_program, design.settings)
    compile_netlist(verilog, design.top, library, tools=tools, say=say, pins=design.pins, calls=calls)


def netlist_of(design: RtlDesign, folder: Path, *, assertions: bool = True) -> str:
    """Return GHDL's netlist of `design`, whose files are written into `folder`. Raises ToolError."""
    sources = []
    for name, text in design.files.items():
        sources.append(folder / name)
        sources[-1].write_text(text, encoding="utf-8")
    return netlist(design.top, sources=sources, generics=design.generics, assertions=assertions)


def compile_netlist(
    verilog: str,
    top: str,
    library: Path,
    *,
    tools: _Tools | None = None,
    say: Progress | None = None,
    pins: Sequence[str] = (),
    calls: str = "",
) -> None:
    """Make the shared library of the netlist `verilog` of `top`. `pins` are names of ports of it.

    `calls` is C++ that the netlist calls.

    Raises ToolError.
    """
    tools = tools if tools is not None else _Tools()
    say = say if say is not None else _silent
    with tempfile.TemporaryDirectory(prefix="unitylink-verilator-") as work:
        folder = Path(work)
        (folder / "model.v").write_text(model_of(verilog, top, pins), encoding="utf-8")
        say(f"compiling the gateware of {top}, this once: verilator")
        _run(
            [
                "verilator",
                *_VERILATOR,
                "--top-module",
                "model",
                "--prefix",
                "Vmodel",
                "--Mdir",
                "made",
                "model.v",
            ],
            folder,
        )
        (folder / "calls.cpp").write_text(calls, encoding="utf-8")
        kind = [*_kind(verilog, top, pins), f"-DONE_TRIGGER={has_one_trigger(folder / 'made'):d}"]
        _compile(folder, kind, top, library, tools=tools, say=say)


def _kind(verilog: str, top: str, pins: Sequence[str]) -> list[str]:
    inputs, outputs = pins_of(verilog, top, pins)
    bits = {port.name: port.bits for port in stream_ports_of(verilog, top)}
    return [
        f"-DREAD_WORDS={bits.get('read_words', 0) // 32}",
        f"-DWRITE_WORDS={bits.get('write_words', 0) // 32}",
        f"-DWRITTEN={bits.get('written', 0)}",
        f"-DGROUPS={bits.get('events', 0)}",
        f"-DPINS_IN={sum(pin.bits for pin in inputs)}",
        f"-DPINS_OUT={sum(pin.bits for pin in outputs)}",
        f"-DEITHER_EDGE={either_edge_will_do(verilog):d}",
    ]


def _compile(
    folder: Path, kind: Sequence[str], top: str, library: Path, *, tools: _Tools, say: Progress
) -> None:
    include = tools.verilator_include()
    flags = [*_COMPILE, *kind, f"-I{include}", f"-I{folder / 'made'}", f"-I{_interface().parents[1]}"]
    flags += ["-include", str(_interface())]  # the netlist calls unitylink_failed()
    # All are compiled as one file, because the headers take a fifth of the remaining time. Code that runs
    # only once need not be fast.
    made = sorted((folder / "made").glob("*.cpp"))
    once = [path for path in made if re.search("Slow|Syms|ConstPool", path.name)]
    often = [folder / "calls.cpp", _HERE / "model.cpp", *(path for path in made if path not in once)]
    lines = [f'#include "{path}"' for path in often]
    lines += ['#pragma GCC optimize("O0")', *(f'#include "{path}"' for path in once)]
    source, target = folder / "model.cpp", folder / "model.o"
    source.write_text("\n".join(lines) + "\n", encoding="utf-8")
    say(f"compiling the gateware of {top}, this once: {tools.compiler}")
    with ThreadPoolExecutor(1) as pool:
        runtime = pool.submit(_runtime, tools, include)
        # -O1 alone copies each byte of a register by itself. -O2 takes a third longer to compile.
        _run([tools.compiler, *flags, "-O1", "-fstore-merging", "-c", str(source), "-o", str(target)])
        _run([tools.compiler, *_LINK, str(target), str(runtime.result()), "-o", str(library)])


def _runtime(tools: _Tools, include: Path) -> Path:
    """Return the compiled part of Verilator that all models share."""
    sources = [include / name for name in ("verilated.cpp", "verilated_threads.cpp")]
    parts = [tools.versions, repr((_COMPILE, include))]

    def build(target: Path) -> None:
        with tempfile.TemporaryDirectory(prefix="unitylink-verilator-") as work:
            objects = []
            for source in sources:
                objects.append(str(Path(work) / f"{source.stem}.o"))
                _run([tools.compiler, *_COMPILE, f"-I{include}", "-O1", "-c", str(source), "-o", objects[-1]])
            _run([tools.compiler, "-r", "-nostdlib", *objects, "-o", str(target)])

    key = hashlib.sha256("\0".join(parts).encode()).hexdigest()[:32]
    return cached(key, build, kind="rtl-runtime", suffix=".o")


def _run(command: Sequence[str], folder: Path | None = None) -> str:
    ended = run_tool(command, folder, called=command[0], timeout_s=_SECONDS_MOST)
    if ended.code != 0:
        lines = [line for line in (ended.err + ended.out).splitlines() if not line.startswith("%Warning")]
        raise ToolError(f"{command[0]} ended with {ended.code}:\n" + "\n".join(lines[:_LINES_SHOWN]))
    return ended.out


def _silent(_text: str) -> None:
    pass


def on_terminal() -> Progress:
    """Return a function that shows one changing line on stderr.

    It shows nothing if stderr is not a terminal.
    """
    if not sys.stderr.isatty() or os.environ.get("TERM") == "dumb":
        return _silent
    return lambda text: print(f"\r\x1b[K{text}", end="", file=sys.stderr, flush=True)
