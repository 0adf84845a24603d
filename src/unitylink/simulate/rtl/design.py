# SPDX-License-Identifier: BSD-3-Clause
"""The design that is compiled: its byte streams, and the places of the words for the user's logic."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Union

from unitylink.generate import SpecPlan, planned_files
from unitylink.generate.templates import environment
from unitylink.generate.vhdl import FOLDER, RING_CUT, Plan, plan_designs
from unitylink.interface.board_configuration import BoardConfiguration
from unitylink.interface.components import ComponentConfiguration
from unitylink.spec.model import Spec

PinPlaces = tuple[tuple[tuple[int, ...], tuple[int, ...]], ...]  # for each component: inputs, outputs
_HERE = Path(__file__).parent
LATENCY_MS = 16  # how long a new FTDI chip waits for more bytes
# Physical layers that are simulated -> the model at the other end of their wires. The streams of this model
# are the board's. The SPI master takes a byte for each byte that it gives. For rs485, the stream has what a
# UART of ours hears on the pair.
BEHIND = {"ft245_async": "ft245_chip.vhd", "spi": "spi_master.vhd", "rs485": None}


@dataclass(frozen=True)
class RtlDesign:
    """An entity `top` and the VHDL that the gateware lacks: `files`, name to text.

    Its ports are clock, reset, rx_valid, rx_ready, rx_data, rx_error, tx_valid, tx_ready, tx_data, events
    (one bit for each group), read_words and write_words (32 bits for each address, in the order of the
    addresses here). The last three may be missing. `pins` are the ports of components. `pin_places` has for
    each component where its inputs and its outputs are among the bits of all. Further inputs are held low.
    Further outputs are ignored.
    """

    top: str
    files: Mapping[str, str] = field(default_factory=dict)
    read_addresses: tuple[int, ...] = ()
    write_addresses: tuple[int, ...] = ()
    generics: Mapping[str, Union[int, str, bool]] = field(default_factory=dict)
    pins: tuple[str, ...] = ()
    pin_places: PinPlaces = ()
    trace_program: str = ""  # the file that gets the program steps of the engine
    settings: str = ""  # of its core, as VHDL; what is traced needs them


def design_of(spec: Spec, configuration: BoardConfiguration) -> RtlDesign:
    """Return the design that `unitylink generate --only vhdl` makes of `spec`. Raises BindingError.

    A physical layer of `BEHIND` is put in front of it, with a model of the other end of its wires. Other
    layers are left out. Then the byte streams are those of the design itself.
    """
    if configuration.tosnet is not None and configuration.tosnet.ring:
        # Nobody is at the pins of the line here. So all nodes of the ring are in the simulation.
        configuration = replace(configuration, tosnet=replace(configuration.tosnet, ring="inside"))
    plan = SpecPlan(spec, configuration)
    (design,) = plan.part(plan_designs)
    top = f"{design.name}_design"
    around = [f"{FOLDER}/{design.name}_{part}" for part in ("user_pkg.vhd", "top.vhd", "build.sh")]
    files = {
        name.rpartition("/")[2]: text
        for name, text in planned_files(plan, ["vhdl"]).items()
        if name not in around
    }
    if configuration.physical in BEHIND:
        top = f"{design.name}_behind_{configuration.physical}"
        files |= _behind(design, top)
    nodes = design.tosnet.here if design.tosnet else ()
    inner = (part for node in nodes if node.parts for part in node.parts.components)
    placed = {part.path: part for part in (*design.components, *inner)}
    own = [
        name for one in configuration.components for _, name in placed[one.path].pins if name in _pins(design)
    ]
    cuts = [RING_CUT] if RING_CUT in _pins(design) else []
    places = _pin_places(design, configuration.components)
    return RtlDesign(
        top=top,
        files=files,
        read_addresses=tuple(design.words.read),
        write_addresses=tuple(design.words.write),
        generics={"clock_hz": configuration.clock_hz},
        pins=(*own, *cuts),
        pin_places=(*places, *(_cut_places(design, places) for _ in cuts)),
    )


def _pins(design: Plan) -> set[str]:
    return {port.name for port in design.pins if port.direction in ("in", "out")}


def _pin_places(design: Plan, components: Sequence[ComponentConfiguration]) -> PinPlaces:
    """Return the places of the pins of each component, in the order of the spec."""
    counted = {"in": 0, "out": 0}
    places = []
    for one in components:
        own: dict[str, tuple[int, ...]] = {"in": (), "out": ()}
        for _, direction, bits in one.pins:
            if direction in own:
                first = counted[direction]
                counted[direction] += bits or 1
                own[direction] += tuple(range(first, counted[direction]))
        places.append((own["in"], own["out"]))
    return tuple(places)


def _cut_places(design: Plan, components: PinPlaces) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Return the places of the lines of a ring that can be cut. They are behind those of the components."""
    assert design.tosnet is not None
    first = sum(len(inputs) for inputs, _ in components)
    count = len(design.tosnet.lines_here) * design.tosnet.configuration.rings
    # The line with the lowest index is the highest bit of the vector.
    return tuple(first + count - 1 - line for line in range(count)), ()


def _behind(design: Plan, top: str) -> dict[str, str]:
    template = environment(_HERE).get_template("behind.vhd.jinja")
    text = template.render(plan=design, top=top, latency_ms=LATENCY_MS)
    made = {f"{top}.vhd": text}
    other_end = BEHIND[design.configuration.physical]
    if other_end is not None:
        made[other_end] = (_HERE / other_end).read_text(encoding="utf-8")
    return made


@dataclass(frozen=True)
class RtlModel:
    """A compiled design: the shared library and the places of its words and pins."""

    library: str
    read_addresses: tuple[int, ...]
    write_addresses: tuple[int, ...]
    pin_places: PinPlaces = ()
