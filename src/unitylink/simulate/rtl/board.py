# SPDX-License-Identifier: BSD-3-Clause
"""A virtual board whose device is the gateware itself, compiled from its VHDL."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from typing import Any

from unitylink import _native
from unitylink.errors import UnityLinkError, ValueRangeError
from unitylink.generate.vhdl import RING_CUT
from unitylink.generate.vhdl.settings import core_settings_of
from unitylink.interface.board_configuration import BoardConfiguration
from unitylink.interface.components import check_clock
from unitylink.spec.model import Spec

from ..board import Board
from ..plant import AnyPlant
from ..state import BoardState
from .build import Progress, build_model
from .design import RtlDesign, RtlModel, design_of
from .trace import traceable

# An ordinary machine runs the first in real time, and it is enough for most robots. The others are for those
# that have a part with a faster clock of its own.
CLOCKS_HZ = tuple(mega * 1_000_000 for mega in (1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 25, 32, 40, 50))


def rtl_configuration(spec: Spec, **overrides: Any) -> BoardConfiguration:
    """Return the gateware that would be generated, but with a clock that can be simulated in real time.

    Without `clock_hz` it is the slowest of CLOCKS_HZ with which the spec works. Its engine is the one that
    the gateware would have with its own clock. Raises ValueRangeError if the spec works with none.
    """
    quick = {name: value for name, value in overrides.items() if name != "clock_hz"}
    quick["engine"] = BoardConfiguration.for_spec(spec, **quick).engine

    def with_clock(clock_hz: int) -> BoardConfiguration:
        made = BoardConfiguration.for_spec(spec, **quick, clock_hz=clock_hz)
        check_clock(made.components, clock_hz)
        return made

    if "clock_hz" in overrides:
        return with_clock(overrides["clock_hz"])
    for clock_hz in CLOCKS_HZ[:-1]:
        with suppress(ValueRangeError):
            return with_clock(clock_hz)
    return with_clock(CLOCKS_HZ[-1])


class ModelBoard(Board):
    """A `Board` whose device is compiled gateware: `model`."""

    def __init__(
        self,
        spec: Spec | None,
        model: RtlModel,
        *,
        configuration: BoardConfiguration,
        plant: AnyPlant | None,
        endpoint: str,
        bind: str,
    ) -> None:
        self._model = model
        super().__init__(spec, configuration=configuration, plant=plant, endpoint=endpoint, bind=bind)

    def _make_native(self, endpoint: str, bind: str) -> _native.Board:
        return _native.Board(self.configuration, endpoint, bind, self._model)

    def _power_up(self, spec: Spec) -> None:
        """Do nothing, because the design's reset sets the initial values of the spec."""

    def _make_safe(self) -> str:
        """Break the line, because only its own dead-man reaches the words of compiled gateware."""
        self._native.hang_up()
        return "with its line cut: its dead-man makes the outputs safe, if one is set"

    def save(self) -> BoardState:
        """Raise UnityLinkError, because the state of compiled gateware cannot be read out."""
        raise UnityLinkError(
            "the state of compiled gateware is not saved; save that of the twin (sim:), which does the same"
        )

    def set_online(self, online: bool) -> None:
        """Raise UnityLinkError, because only the twin has a model of the network."""
        raise UnityLinkError("the gateware's network cannot be broken from here; the twin's can: use `sim:`")

    def set_ring(self, ring: int, whole: bool) -> None:
        """Raise UnityLinkError, because only the twin has a model of the network."""
        raise UnityLinkError("no ring of the gateware can be broken from here; the twin's can: use `sim:`")

    def set_node(self, node: int, present: bool) -> None:
        """Raise UnityLinkError, because only the twin has a model of the network."""
        raise UnityLinkError("no node of the gateware's network leaves from here; the twin's can: use `sim:`")

    def damage_cycle(self) -> None:
        """Raise UnityLinkError, because only the twin has a model of the network."""
        raise UnityLinkError("the gateware's network cannot be damaged from here; the twin's can: use `sim:`")


class RtlBoard(ModelBoard):
    """A `Board` whose device is the compiled VHDL that `unitylink generate --only vhdl` makes of `spec`.

        with RtlBoard(spec, plant=ScaraPlant()) as board, Link(board.url) as link:
            link.read(0x88)

    The first build takes about half a minute. Later boards come from the cache ($XDG_CACHE_HOME/unitylink).
    Device time is clocks over `configuration.clock_hz`, by default 1 MHz or what the spec needs. Plants are
    stepped by this time. It follows real time. If the machine is too slow for this,
    `statistics.time_slipped_s` says how far the board is behind. The byte streams are behind the twin's
    physical layer, so `fifo`, `baud_hz` and `fifo_latency` have the same effect there.

    Words have one writer, as on an FPGA. A plant sets the words that the PC reads, and the PC sets the
    others.

    `design` is VHDL of your own instead of the generated one (docs/gateware/own-core.md). Then what
    moves behind the words is in this design or in a `plant`. By default there is no plant.

    `trace_program` is a file that gets the program steps of the engine (docs/rtl-simulation.md).

    Raises ToolError (GHDL, Verilator or the C++ compiler is missing or refuses the design), BindingError (the
    generated design cannot have what the configuration asks for), and everything that Board raises.
    """

    def __init__(
        self,
        spec: Spec,
        *,
        design: RtlDesign | None = None,
        configuration: BoardConfiguration | None = None,
        plant: AnyPlant | None = None,
        endpoint: str = "fd",
        bind: str = "127.0.0.1",
        progress: Progress | None = None,
        trace_program: str = "",
    ) -> None:
        chosen = configuration if configuration is not None else rtl_configuration(spec)
        check_clock(chosen.components, chosen.clock_hz)  # before a build of half a minute
        steps = traceable(trace_program, chosen) if trace_program else ""
        made = design if design is not None else design_of(spec, chosen)
        if steps:
            made = replace(made, trace_program=steps, settings=core_settings_of(chosen))
        model = build_model(made, progress)
        lines = len(made.pin_places[-1][0]) if RING_CUT in made.pins else 0
        network = chosen.tosnet
        self._ring_lines = lines // network.rings if network is not None else 0  # of each ring
        # with a spec but no plant, Board would add one
        shown = spec if design is None or plant is not None else None
        super().__init__(shown, model, configuration=chosen, plant=plant, endpoint=endpoint, bind=bind)

    def set_online(self, online: bool) -> None:
        """Cut the line of each ring in its middle, or mend it.

        Raises UnityLinkError for a design without a ring: the spec says `NODES=ring` for one.
        """
        network = self.configuration.tosnet
        if not self._ring_lines or network is None:
            super().set_online(online)
            return
        for ring in range(network.rings):
            self.set_ring(ring, online)

    def set_ring(self, ring: int, whole: bool) -> None:
        """Cut the line of one of the rings in its middle, or mend it.

        Raises UnityLinkError for a design without a ring, and ValueRangeError if it has no such ring.
        """
        network = self.configuration.tosnet
        if not self._ring_lines or network is None:
            super().set_ring(ring, whole)
            return
        if not 0 <= ring < network.rings:
            raise ValueRangeError(f"ring {ring}: the spec has {network.rings} (RINGS)")
        place = ring * self._ring_lines + self._ring_lines // 2
        self._native.drive(len(self.configuration.components), place, not whole)
