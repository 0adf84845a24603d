# SPDX-License-Identifier: BSD-3-Clause
"""From a property file to models for the solvers: GHDL's output is repaired and goes through yosys."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from block import Block, Mutant
from cases import with_cases

from unitylink.errors import ToolError
from unitylink.gateware import Ghdl, gateware_sources, property_sources
from unitylink.gateware.repairs import repaired

SECONDS_MOST = 1800.0  # for one call of a program

# GHDL prints PSL in a form that no reader of Verilog takes for a property.
_FATAL = r'always @\*\s*if \(!(\S+)\)\s*\$fatal\(1, "'
_PSL = tuple(
    (re.compile(pattern, re.MULTILINE), replacement)
    for pattern, replacement in (
        (r"^\s*(\S+): assert (\S+) = '1' severity warning; --  assume$", r"  always @* \1: assume(\2);"),
        (r"^\s*(\S+): assert (\S+) = '1' severity note; --  cover$", r"  always @* \1: cover(\2);"),
        (_FATAL + r'assertion\(cover\) failure (\S+)"\);', ""),  # GHDL's own cover; `cases` says more
        (_FATAL + r'assertion failure (\S+)"\);', r"always @* \2: assert(\1);"),
    )
)

# `setundef` comes before any optimisation. So what the VHDL leaves open stays open, and yosys does not choose
# a value. `rename -hide` hides the names that GHDL made up. So nets keep the names of the VHDL, and traces
# can be read.
_SCRIPT = """
read_verilog -formal {verilog}
hierarchy -check -top {top}
{removed}
rename -hide w:n*_o w:n*_q
proc
setundef -undriven -anyseq
flatten
{loose}
{given}
{seen}
opt_clean
memory -nordff -nomap
memory_map
opt -full
async2sync
opt_clean
check -assert
dffunmap
write_smt2 {smt2}
chformal -cover -remove
techmap
opt_clean
setundef -undriven -anyseq
aigmap
opt_clean
write_aiger -zinit -no-startoffset -map {aiger}.map {aiger}
"""


@dataclass(frozen=True)
class Model:
    """The input of the solvers, and the names that it asserts, in the order in which ABC numbers them."""

    top: str
    smt2: Path
    aiger: Path
    asserted: tuple[str, ...]
    several_clocks: bool = False

    @property
    def witness(self) -> Path:
        """The file in which ABC puts the inputs that violate a property."""
        return self.aiger.with_suffix(".aiw")

    @property
    def named(self) -> list[str]:
        """The asserts that have a label. GHDL numbers the others, such as those about generics."""
        return sorted(name for name in self.asserted if not re.fullmatch(r"n\d+", name.rpartition(".")[2]))


def model(block: Block, folder: Path, mutant: Mutant | None = None) -> Model:
    """Make the model of `block` in `folder`. If there is a `mutant`, one text of the design is replaced."""
    sources = list(gateware_sources())
    if mutant is not None:
        sources = [_mutated(path, mutant, folder) if path.name == mutant.file else path for path in sources]
    for path in property_sources():
        copy = folder / path.name
        copy.write_text(with_cases(path.read_text(encoding="utf-8")), encoding="utf-8")
        sources.append(copy)
    ghdl = Ghdl(folder, sources)
    verilog, vhdl = (ghdl.synthesise(block.top, language, block.generics) for language in ("verilog", "vhdl"))
    return _made(block, with_properties(repaired(verilog, vhdl)), folder / "model.v")


def unreachable(block: Block, model: Model) -> Model:
    """Return a model that asserts only that each cover is never reached."""
    source = model.smt2.with_suffix(".v")
    verilog = re.sub(r"(?m)^.*\bassert\(.*$", "", source.read_text(encoding="utf-8"))
    return _made(block, re.sub(r"\bcover\(", "assert(!", verilog), source.with_name("covers.v"))


def _made(block: Block, verilog: str, source: Path) -> Model:
    source.write_text(verilog, encoding="utf-8")
    smt2, aiger = source.with_suffix(".smt2"), source.with_suffix(".aig")
    script = _SCRIPT.format(
        verilog=source,
        top=block.top,
        removed=_removed(block),
        loose=_loose(block),
        given=_given(block),
        seen=_seen(block),
        smt2=smt2,
        aiger=aiger,
    )
    if block.several_clocks:
        script = script.replace("async2sync", "clk2fflogic")
    code, said = run(["yosys", "-q", "-p", "; ".join(filter(None, script.split("\n")))])
    if code != 0:
        raise ToolError(f"yosys refuses the model of {block.top}:\n{said[-3000:]}")
    names = re.findall(r"^; yosys-smt2-assert \d+ (\S+)", smt2.read_text(encoding="utf-8"), re.MULTILINE)
    return Model(block.top, smt2, aiger, tuple(names), block.several_clocks)


def _removed(block: Block) -> str:
    """Return the commands that remove parts of the design. Their outputs then have any value."""
    patterns = [f"{entity}_*/{instance}" for entity, instance in block.without]
    return "\n".join(f"select -assert-count 1 {each}\ndelete {each}" for each in patterns)


def _seen(block: Block) -> str:
    """Return the commands that give inputs of the property file the values of signals in the flat design."""
    commands = [f"delete -input w:{port}" for port in block.seen]
    commands += [f"connect -nomap -set \\{port} \\{signal}" for port, signal in block.seen.items()]
    return "\n".join([f"cd {block.top}", *commands, "cd .."])


def _loose(block: Block) -> str:
    """Return the commands that remove the drivers of signals in the flat design."""
    return "\n".join(f"select -assert-count 1 w:{each}\ncutpoint w:{each}" for each in block.loose)


def _given(block: Block) -> str:
    """Return the commands that drive signals of the flat design with outputs of the property file."""
    commands = [f"select -assert-count 1 w:{each}\ncutpoint w:{each}" for each in block.given]
    commands += [f"connect -nomap -set \\{signal} \\{own}" for signal, own in block.given.items()]
    commands += [f"delete -output w:{own}" for own in block.given.values()]
    return "\n".join([f"cd {block.top}", *commands, "cd .."]) if commands else ""


def with_properties(verilog: str) -> str:
    """Return the netlist with GHDL's properties in a form that Verilog has.

    Raises ToolError if one is left.
    """
    for pattern, replacement in _PSL:
        verilog = pattern.sub(replacement, verilog)
    if left := re.search(r"^.*(\$fatal|severity).*$", verilog, re.MULTILINE):
        raise ToolError(f"GHDL prints a property in a way that is not known here: {left.group().strip()}")
    return verilog


def run(command: Sequence[str], seconds_most: float = SECONDS_MOST) -> tuple[int, str]:
    """Run a program to its end. Return its exit code and its whole output.

    Raises ToolError if it is missing or does not end.
    """
    try:
        done = subprocess.run(
            command,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            timeout=seconds_most,
            check=False,
        )
    except FileNotFoundError as error:
        raise ToolError(f"{command[0]} is missing; `tools/setup.sh formal` installs it") from error
    except subprocess.TimeoutExpired as error:
        raise ToolError(f"{command[0]}: no end after {seconds_most:.0f} s") from error
    return done.returncode, done.stdout


def _mutated(path: Path, mutant: Mutant, folder: Path) -> Path:
    text = path.read_text(encoding="utf-8")
    if (found := text.count(mutant.old)) != 1:
        raise ToolError(f"{path.name} has the text of a mutant {found} times instead of once: {mutant.old!r}")
    copy = folder / path.name
    copy.write_text(text.replace(mutant.old, mutant.new), encoding="utf-8")
    return copy
