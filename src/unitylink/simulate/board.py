# SPDX-License-Identifier: BSD-3-Clause
"""A virtual board: the twin of the gateware, served on an endpoint.

Its clock follows the real one, or goes in steps.
"""

from __future__ import annotations

import atexit
import logging
from collections.abc import Callable
from dataclasses import dataclass
from types import TracebackType

from unitylink import _native
from unitylink.errors import UnityLinkError, ValueRangeError
from unitylink.interface.board_configuration import BoardConfiguration
from unitylink.interface.components import check_clock
from unitylink.spec.model import Spec
from unitylink.values import Codec, Quantity

from .changes import ChangeWatch
from .components import BoardComponents
from .plant import AnyPlant, check_plant
from .plant_start import PlantStart
from .plants.ramp import RampPlant
from .plants.words import WordPlant
from .registers import Registers
from .state import BoardState, restore_plant, saved_addresses, saved_plant

_log = logging.getLogger(__name__)
_open: set[Board] = set()


@dataclass(frozen=True)
class BoardStatistics:
    """Counters since the board was made.

    `overruns` counts bytes lost at a full receive FIFO. `bytes_dropped` counts bytes published while no
    client was there. `plant_steps` counts the steps that were left out because nobody could see them, too.
    `time_slipped_s` is how far the device clock is behind the real one because the machine was too busy.
    """

    bytes_received: int
    bytes_sent: int
    overruns: int
    datalink_errors: int
    clients: int
    bytes_dropped: int
    plant_steps: int
    time_slipped_s: float


class Board:
    """A virtual board. It runs from its constructor to `close()`. It is a context manager.

        with Board(spec, endpoint="tcp") as board, Link(board.url) as link:
            link.read(0x88)

    `endpoint` is one of these: "fd" is a descriptor for a link in this process, and the link then owns it.
    Once that link has closed, `url` names a new one. "pty" or "pty:PATH" is a serial port in software.
    "tcp[:PORT]" and "udp[:PORT]" are at the local address `bind`. "lockstep" is as "fd", but the time of
    the board goes in steps. It passes only while a call of a link waits (docs/lockstep.md). Either all
    virtual boards of a process follow real time, or all go in steps.

    There is one client at a time. A second one gets "?busy". When a client leaves, the board is free, and all
    settings stay. Publishing goes on, as on a real board. A UDP client may vanish without a message. This is
    noticed only when its system reports that its port is closed. If a client does not read, the board's
    transmit FIFO fills and the board waits.

    Without a plant, a board with a spec gets `RampPlant`. The components of the spec behave as in the FPGA.
    Their outside is `components`.

    With a `state`, which `save` of another board made, it goes on from there. Its plant waits for `go_on`.

    Raises ValueRangeError (for the configuration), LinkNotFound (the endpoint cannot be made) or
    UnityLinkError (for the plant).
    """

    _model: object | None = None  # compiled gateware, instead of the twin

    def __init__(
        self,
        spec: Spec | None = None,
        *,
        configuration: BoardConfiguration | None = None,
        plant: AnyPlant | None = None,
        endpoint: str = "fd",
        bind: str = "127.0.0.1",
        state: BoardState | None = None,
    ) -> None:
        if configuration is None:
            configuration = BoardConfiguration.for_spec(spec) if spec is not None else BoardConfiguration()
        if plant is None and spec is not None:
            plant = RampPlant()
        check_clock(configuration.components, configuration.clock_hz)
        self.configuration = configuration
        self.spec = spec
        self.plant = plant
        self._plant_error: UnityLinkError | None = None
        self._native = self._make_native(endpoint, bind)
        self.components = BoardComponents(self._native, configuration.components)
        self.registers = Registers(self._native, configuration.data_bits, self.components)
        self._closed = False
        self._state = state
        self._again = PlantStart(plant) if plant is not None and endpoint == "lockstep" else None
        self._begin()
        if state is not None:
            self._native.hold_plant()
        self._native.start()
        _open.add(self)

    def _begin(self) -> None:
        """Give words and plant their start."""
        if self.spec is not None:
            self._power_up(self.spec)
        if self.plant is not None:
            self._attach(self.plant)

    def _make_native(self, endpoint: str, bind: str) -> _native.Board:
        return _native.Board(self.configuration, endpoint, bind)

    def _power_up(self, spec: Spec) -> None:
        """Give plain words the initial values of the spec, as registers in gateware do."""
        for path, element in spec.walk():
            if element.initial is not None and element.link.kind == "memory":
                codec = Codec(path, Quantity.of(element), self.configuration.data_bits)
                words = codec.split(codec.encode(element.initial))
                for address, word in zip(element.addresses, words, strict=True):
                    if not self.components.owns(address):
                        self.registers[address] = word

    def _attach(self, plant: AnyPlant) -> None:
        name = type(plant).__name__
        if not isinstance(plant, WordPlant):
            check_plant(plant, "plant")
        try:
            plant.attach(self.spec, self.registers)
        except UnityLinkError:
            raise
        except Exception as error:
            raise UnityLinkError(f"{name}.attach(): {type(error).__name__}: {error}") from error
        if self._state is not None:
            self._take_over(plant, self._state)
        watch = ChangeWatch(self.spec, self.registers, self._native.pulse_event) if self.spec else None
        if isinstance(plant, WordPlant) and not watch:
            self._native.set_word_plant(plant.period_s, plant.ramps, plant.echoes)
            return
        moved = self._movement(plant)

        look = watch.look if watch else None

        def moved_and_seen(time_s: float) -> None:
            moved(time_s)
            if look is not None:
                look()

        step = moved if look is None else moved_and_seen

        def guarded(time_s: float) -> bool:
            try:
                step(time_s)
            except BaseException as error:  # sys.exit() in a step must not go unnoticed either
                if isinstance(error, KeyboardInterrupt) and self._native.in_steps:
                    raise  # it is for the program, in whose thread the plant runs
                raised = UnityLinkError(f"{name}.step({time_s:.6f}): {type(error).__name__}: {error}")
                raised.__cause__ = error
                self._plant_error = raised
                made_safe = self._make_safe()
                _log.exception(
                    "%s failed at %.6f s of device time; the board goes on without it, %s",
                    name,
                    time_s,
                    made_safe,
                )
                return False
            return True

        self._native.set_plant(plant.period_s, guarded)

    def _movement(self, plant: AnyPlant) -> Callable[[float], None]:
        """Return what each period calls. On the twin the plant also plays what it has in place of VHDL."""
        play = getattr(plant, "play", None)
        if play is None or self._model is not None:
            return plant.step

        def played(time_s: float) -> None:
            play(time_s)
            plant.step(time_s)

        return played

    def _make_safe(self) -> str:
        """Write the SAFE values, as the dead-man does. Return what was done, for the log."""
        for address, word in self.configuration.safe_words:
            self._native.write(address, word)
        return "with safe outputs"

    def _take_over(self, plant: AnyPlant, state: BoardState) -> None:
        if list(state.words) != saved_addresses(self.spec):
            raise UnityLinkError("the state is of a board with another spec")
        restore_plant(plant, state.plant, self.registers)
        for address, word in state.words.items():
            if not self._native.preset(address, word):
                raise UnityLinkError(f"the word at {address:#06x} of the state cannot be set in this board")

    def save(self) -> BoardState:
        """Return the state of words and plant (docs/lockstep.md). `connect(url, state=...)` goes on from it.

        Raises UnityLinkError for what is not saved: components, FIFOs, and a plant that cannot be copied.
        """
        addresses = saved_addresses(self.spec)
        words = dict(zip(addresses, self.registers.read_many(addresses), strict=True))
        if self.plant is None:
            raise UnityLinkError("a board without a plant has no state to save")
        return BoardState(words, saved_plant(self.plant, self.registers), self._native.plant_phase)

    def go_on(self) -> None:
        """Let the plant of a board with a `state` make its steps, in the rhythm of the other board."""
        if self._state is not None and self._state.phase is not None:
            self._native.release_plant(*self._state.phase)

    def reset(self, seed: int | None = None) -> None:
        """Begin anew: device, components and plant are as in a board that has just been made.

        It is for boards in steps, and its link ends: `Link.reset` does this with a link, and begins another
        session. A plant with `seed(number)` gets the seed, or the one of its URL. A plant with `reset()` puts
        itself back. Any other gets the attributes that it was given with. Then it is attached again.

        Raises UnityLinkError: time passes by itself, or the plant cannot be put back.
        """
        self.check_resets()
        if not self._native.begin_anew(self.configuration, self._model):
            raise UnityLinkError("the board is closed, or its own plant wants to reset it in a step")
        self.components.forget()
        self._plant_error = None
        self._state = None
        if self._again is not None:
            self.plant = self._again.made(seed)
        self._begin()

    def check_resets(self) -> None:
        """Raise UnityLinkError if `reset` cannot be."""
        if not self._native.in_steps:
            raise UnityLinkError(
                "a board whose time passes by itself cannot be reset; open it with time=lockstep"
            )
        if self._again is not None:
            self._again.check()

    @property
    def url(self) -> str:
        """The URL for a Link: "fd:7", "serial:/dev/pts/3", "tcp://127.0.0.1:40213" or "udp://…"."""
        return self._native.url()

    @property
    def error(self) -> UnityLinkError | None:
        """The exception that ended the plant, or the reason why the device itself stands still.

        None otherwise.
        """
        if self._plant_error is None and (failure := self._native.failure()):
            return UnityLinkError(f"the gateware has stopped: assertion at {failure} failed")
        return self._plant_error

    @property
    def closed(self) -> bool:
        return self._closed

    @property
    def time_s(self) -> float:
        """Device time since the board was made."""
        return self._native.time_s()

    @property
    def statistics(self) -> BoardStatistics:
        return BoardStatistics(**self._native.statistics())

    def event(self, group: int | str, high: bool | None = None) -> None:
        """Set the event input of a publish group. If `high` is None, pulse it once.

        It has an effect if WIC enabled it.
        """
        if isinstance(group, str):
            group = self._line(group)
        if not 0 <= group < self.configuration.groups:
            raise ValueRangeError(f"group {group}; the board has groups 0 to {self.configuration.groups - 1}")
        if high is None:
            self._native.pulse_event(group)
        else:
            self._native.set_event(group, high)

    def _line(self, event: str) -> int:
        """Return the group that an event of the spec triggers."""
        devices = self.spec.devices if self.spec is not None else ()
        lines = {g.event: g.number for device in devices for g in device.groups if g.trigger == "event"}
        if event not in lines:
            raise ValueRangeError(
                f"no group is published on {event!r}; there are {', '.join(lines) or 'none'}"
            )
        return lines[event]

    def receive_error(self, bits: int) -> None:
        """Let the board's physical layer report errors: 1 parity, 2 framing, 4 overrun."""
        self._native.receive_error(bits & 7)

    def set_online(self, online: bool) -> None:
        """Break the TosNet network, or mend it. Meanwhile nothing is exchanged, and commits stay pending."""
        self._native.set_online(online)

    def set_ring(self, ring: int, whole: bool) -> None:
        """Break one of the rings of the TosNet network, 0 or 1, or mend it.

        The network runs while a ring does. The spec says how many there are, `RINGS=2`.
        """
        if not (0 <= ring < 2 and self._native.set_ring(ring, whole)):
            raise ValueRangeError(f"ring {ring}: the board has no TosNet with such a ring; see RINGS")

    def set_node(self, node: int, present: bool) -> None:
        """Let a node of the TosNet network leave, or come back. The others find their ring anew.

        While it is away, its words do not change for the PC.
        """
        if not (0 <= node < 16 and self._native.set_node(node, present)):
            raise ValueRangeError(
                f"node {node}: the board has no TosNet with such a node beside the PC's own"
            )

    def damage_cycle(self) -> None:
        """Let one TosNet cycle arrive damaged. The error counter counts it, and PCKERR is set for one
        cycle."""
        self._native.damage_cycle()

    def hang_up(self) -> None:
        """Break the line to the client, as when a cable is pulled.

        The board runs on, and takes the next client.

        A pseudo-terminal has no cable. For one, close the board and make another at the same path.
        """
        self._native.hang_up()

    def close(self) -> None:
        """End the board. A connected client loses its port. Calling it twice does no harm."""
        self._closed = True
        _open.discard(self)
        self._native.stop()

    def __enter__(self) -> Board:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


@atexit.register
def _close_all() -> None:
    """A board's thread must not outlive the interpreter in which it calls plants."""
    for board in list(_open):
        board.close()
