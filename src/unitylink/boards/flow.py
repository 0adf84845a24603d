# SPDX-License-Identifier: BSD-3-Clause
"""From a spec to a bitstream: generate, GHDL, yosys, nextpnr, pack. Each step is reported."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from unitylink.errors import BoardError, ToolError
from unitylink.gateware import find_program, map_cells, netlist, ports_of, run_tool
from unitylink.generate import SpecPlan, planned_files, write_files
from unitylink.interface.board_configuration import BoardConfiguration
from unitylink.interface.components import check_clock
from unitylink.spec.isochrony.budget import DeviceBudget, budget
from unitylink.spec.isochrony.latency import BITS_PER_BYTE
from unitylink.spec.model import Spec

from .families import FAMILIES
from .fit import too_large
from .folder import make_folder
from .line import check_line, told_baud_hz
from .logic import Logic, Wanted, design_sources, logic_of, spec_of
from .manifest import CHIP_CLOCK_HZ, Board
from .memories import memories_of, shortage
from .pins import TRIPPED, Pinout, assign_pins, lines_of
from .placement import Placing, place
from .pll import Pll, pll_of
from .report import Report, budget_of, forget
from .wrapper import NAME, constraints, has_reset, wrapper

Tell = Callable[[str], None]
_LINES_SHOWN = 6


@dataclass(frozen=True, kw_only=True)
class Order(Wanted):
    """A design to build, for a board. None means that spec and board decide."""

    board: Board
    clock_hz: int | None = None
    baud_hz: int | None = None
    seeds: int = 3


@dataclass(frozen=True)
class Prepared:
    """What is known before anything takes long. The VHDL of the design is in the order's folder."""

    spec: Spec
    clock_hz: int
    baud_hz: int
    pll: Pll | None
    configuration: BoardConfiguration
    logic: Logic
    budgets: tuple[DeviceBudget, ...]
    place_command: tuple[str, ...]
    bitstream: str  # the name of its file


def prepare(order: Order) -> Prepared:
    """Write the VHDL that `order` asks for into its folder. What an earlier build left there is forgotten.

    Raises what `build_bitstream` raises, except that the design is too large or too slow.
    """
    board, family = order.board, FAMILIES[order.board.family]
    spec = spec_of(order)
    clock_hz, baud_hz = rates(spec, order)
    pll = None if clock_hz == board.clock_hz else pll_of(board.family, board.clock_hz, clock_hz)
    clock_hz = round(pll.hz) if pll else clock_hz
    place = family.place_command(board)  # so that a missing tool is noticed before anything takes long
    find_program(family.packers, family.pack_remedy)
    folder = order.folder
    make_folder(folder)
    made = f"{spec.name}-{board.name.replace(':', '-')}.{family.bitstream}"
    forget(folder, made)
    line = {"clock_hz": clock_hz, **({"baud_hz": baud_hz} if baud_hz else {})}
    configuration = board.configuration(spec, order.protocol, {**line, **order.settings})
    check_clock(configuration.components, clock_hz)
    plan = SpecPlan(spec, configuration)
    write_files(planned_files(plan, ["vhdl"]), folder)
    budgets = tuple(budgets_of(spec, configuration, clock_hz, baud_hz))
    logic = logic_of(plan, order, pin_for_trips=bool(board.roles.get(TRIPPED)))
    return Prepared(spec, clock_hz, baud_hz, pll, configuration, logic, budgets, tuple(place), made)


def build_bitstream(order: Order, tell: Tell = lambda _: None) -> Report:
    """Build a bitstream and its report in `order.folder`. `tell` is called at the beginning of each step.

        board = load_board("icebreaker")
        report = build_bitstream(Order(spec_file="servo.ul", board=board, folder=Path("build/servo")))

    Raises SpecError, BindingError, ToolError (a program is missing or refuses its input) or BoardError (pins
    do not exist, the design does not fit, or it is too slow for the clock).
    """
    started = time.monotonic()
    board, family, folder = order.board, FAMILIES[order.board.family], order.folder
    design = prepare(order)
    spec, logic, configuration = design.spec, design.logic, design.configuration
    clock_hz, baud_hz = design.clock_hz, design.baud_hz
    tell(logic.whence)
    tell(f"GHDL makes a netlist of {logic.top}")
    generics = {"clock_hz": clock_hz, "baud_hz": baud_hz}
    verilog = netlist(
        logic.top,
        sources=[*design_sources(spec, folder), *logic.sources],
        generics={name: generics[name] for name in sorted(logic.generics)},
        assertions=False,
    )
    if too_many := shortage(memories_of(verilog, logic.top), board.device):
        raise too_large(board, configuration, "\n  ".join(too_many))
    ports = ports_of(verilog, logic.top)
    pinout = assign_pins(board, lines_of(ports), order.pins, logic.components)
    (folder / "design.v").write_text(verilog, encoding="utf-8")
    (folder / "board.v").write_text(wrapper(board, logic.top, ports, pinout, design.pll), encoding="utf-8")
    (folder / f"board.{family.constraints}").write_text(constraints(board, pinout), encoding="utf-8")
    tell(f"yosys maps it on {board.family}")
    map_cells(family.synthesis, NAME, ["design.v", "board.v"], "board.json", folder)
    placing = Placing(board, configuration, design.place_command, folder, clock_hz, order.seeds)
    placed = place(placing, tell)
    tell("the bitstream is packed")
    _run(family.pack_command(f"board.{family.routed[1]}", design.bitstream), folder)
    notices = [*logic.notices, *pinout.notices, *board.notes]
    if placed.link_fmax_hz is not None:
        notices.append(
            f"the chip's clock on {board.link_clock}: {CHIP_CLOCK_HZ / 1e6:g} MHz, and the design reaches "
            f"{placed.link_fmax_hz / 1e6:.1f} MHz; nextpnr does not check the pins' set-up times"
        )
    if not has_reset(ports):
        notices.append(f"{logic.top} has no port reset: its logic runs before clock and block RAMs are ready")
    report = Report(
        spec=spec.name,
        hash=spec.hash,
        protocol=configuration.protocol,
        board=board.reference,
        title=board.title,
        top=logic.top,
        clock_hz=clock_hz,
        fmax_hz=placed.fmax_hz,
        seed=placed.seed,
        placer=placed.placer,
        area=placed.area,
        baud_hz=baud_hz,
        url=link_url(board, baud_hz),
        pins=_shown(board, pinout),
        words=logic.words,
        notices=tuple(notices),
        bitstream=str(folder / design.bitstream),
        budget=tuple(budget_of(one) for one in design.budgets),
        tools=_versions(design.place_command[0], folder),
        seconds=round(time.monotonic() - started, 1),
    )
    report.write(folder)
    return report


def budgets_of(
    spec: Spec, configuration: BoardConfiguration, clock_hz: int, baud_hz: int
) -> list[DeviceBudget]:
    """Return the limits of the link of this design. Raises BoardError if the link is too slow.

    They are those of the protocol that a link chooses. This is the framed one if the design speaks both.
    """
    protocol = "classic" if configuration.protocol == "classic" else "framed"
    budgets = [
        budget(
            device,
            protocol=protocol,
            clock_hz=clock_hz,
            baud_hz=baud_hz or None,
            engine=configuration.engine,
        )
        for device in spec.devices
    ]
    for one in budgets:
        if one.load is not None and one.load > 1:
            raise BoardError(
                f"{one.root}: publishes need {one.bytes_per_s * BITS_PER_BYTE:,.0f} baud; the line "
                f"has {baud_hz:,}: publish slower or less, or choose a higher --baud "
                "(`unitylink budget` shows what each group costs)"
            )
    return budgets


def rates(spec: Spec, order: Order) -> tuple[int, int]:
    """Return the clock of the design and the baud rate of the link.

    Raises BoardError if they are impossible.
    """
    board = order.board
    clock_hz = order.clock_hz or board.design_hz
    if board.physical != "uart":
        if order.baud_hz is not None:
            raise BoardError(
                f"--baud {order.baud_hz}: {board.name} has no serial line; its link is {board.physical}"
            )
        return clock_hz, 0
    baud_hz = order.baud_hz or told_baud_hz(spec) or board.baud_hz
    if baud_hz > board.baud_hz_most:
        raise BoardError(
            f"{board.name}: the line takes at most {board.baud_hz_most:,} baud, and {baud_hz:,} are asked"
        )
    check_line(clock_hz, baud_hz)
    return clock_hz, baud_hz


def _run(command: Sequence[str], folder: Path) -> None:
    ended = run_tool(command, folder, joined=True)
    if ended.code != 0:
        lines = "\n".join(ended.out.strip().splitlines()[-_LINES_SHOWN:])
        raise ToolError(f"{Path(command[0]).name} ended with {ended.code}:\n{lines}")


LINKS = {
    "spi": "spi:/dev/spidev0.0",
    "ft245_async": "ftdi:?mode=fifo",
    "ft245_sync": "ftdi:?channel=A&mode=sync-fifo",
}


def link_url(board: Board, baud_hz: int) -> str:
    """Return the link that most likely leads to the board."""
    if board.physical != "uart":
        return LINKS[board.physical]
    return f"serial:/dev/ttyUSB{1 if 'FT2232H' in ''.join(board.notes) else 0}?baud={baud_hz}"


def _shown(board: Board, pinout: Pinout) -> dict[str, str]:
    names = ("clock", "rx", "tx")
    pins = {
        port: f"{name} (site {board.pins[name].site})"
        for port, (name, _) in zip(names, board.fixed_pins, strict=False)
    }
    for line, number, pin in pinout:
        low = ", active low" if pin.active_low else ""
        pins[line.bit(number)] = f"{pin.name} (site {pin.site}{low})"
    return pins


def _versions(placer: str, folder: Path) -> tuple[str, ...]:
    lines = []
    for command in (["ghdl", "--version"], ["yosys", "-V"], [placer, "--version"]):
        said = run_tool(command, folder, joined=True).out
        lines.append(said.strip().splitlines()[0] if said.strip() else command[0])
    return tuple(lines)
