# SPDX-License-Identifier: BSD-3-Clause
"""A PC for a simulation with cocotb 2: the link and its typed objects, at the pins of your design.

    @cocotb.test()
    async def the_lamp_is_lit(dut):
        Clock(dut.clock, 100, "ns").start()
        async with UnityLinkMaster(dut, "lamp.ul", baud_hz=1_000_000) as pc:
            await pc.run(pc.robot["led"].write, 5)
            assert dut.leds.value == 5

The package does not need cocotb. Only this module does.
"""

from __future__ import annotations

import select
import socket
import threading
from collections.abc import Callable
from concurrent.futures import Future
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, TypeVar

from unitylink.errors import UnityLinkError, UrlError
from unitylink.optional import absent

try:
    import cocotb
    from cocotb.triggers import FallingEdge, Timer
except ImportError as error:
    raise absent("cocotb", "unitylink.cocotb") from error

if TYPE_CHECKING:
    from typing_extensions import Self

    from unitylink.layer2_message import Link
    from unitylink.layer4_data import Node
    from unitylink.spec.model import Spec

Result = TypeVar("Result")

_BITS = 10  # of a byte on the line: start, 8 data, stop
_THINKING_S = 0.0005  # so long the simulation waits for the program, each time that the line is quiet
_QUIET_BYTES = 4  # after so many byte times without a byte
_CHUNK = 4096


class UnityLinkMaster:
    """The PC at a UART of the design: a `Link`, and the objects of the spec.

    `dut` has the pins `rx` (into the FPGA) and `tx` (out of it). `spec` is a file or a compiled spec.
    `baud_hz` is that of the design. `options` are those of a link URL.

    A link waits, and a simulation cannot. So `run` calls a function in a thread while the simulation goes on.
    Any object that has a link works in there: `robot`, generated classes (`Arm(pc.link)`), `link` itself.
    """

    link: Link
    robot: Node
    _ours: socket.socket

    def __init__(
        self,
        dut: Any,
        spec: Spec | str | Path,
        *,
        rx: str = "rx_line",
        tx: str = "tx_line",
        baud_hz: float = 3_000_000,
        options: str = "timeout=20",
    ) -> None:
        self._spec = spec
        self._options = options
        self._bit_ps = round(1e12 / baud_hz)
        self._to_board, self._from_board = (_pin(dut, name) for name in (rx, tx))
        self._to_board.value = 1
        self._tasks: list[Any] = []
        self._calls = 0
        self._quiet = 0

    async def __aenter__(self) -> Self:
        """Connect. The clock of the design must run."""
        from unitylink.layer2_message import Link
        from unitylink.layer4_data import load_spec_objects
        from unitylink.spec import load

        spec = load(self._spec) if isinstance(self._spec, (str, Path)) else self._spec
        await Timer(_BITS * self._bit_ps, "ps")  # the receiver of the design sees a line at rest
        self._ours, theirs = socket.socketpair()
        self._ours.setblocking(False)
        self._tasks = [cocotb.start_soon(self._send()), cocotb.start_soon(self._receive())]
        url = f"fd:{theirs.detach()}" + (f"?{self._options}" if self._options else "")
        try:
            self.link = await self.run(Link, url)
            self.robot = await self.run(load_spec_objects, spec, self.link)
        except BaseException:
            await self._leave()
            raise
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self._leave()

    async def run(self, function: Callable[..., Result], *arguments: Any, **named: Any) -> Result:
        """Call `function` in a thread while the simulation goes on, and return its result.

        Several tasks may do so at once. `function` must not touch the design: cocotb's handles belong to the
        simulator's thread.
        """
        outcome: Future[Result] = Future()

        def call() -> None:
            try:
                outcome.set_result(function(*arguments, **named))
            except BaseException as error:  # handed to the caller, whatever it is
                outcome.set_exception(error)

        threading.Thread(target=call, name="unitylink.cocotb", daemon=True).start()
        self._calls += 1
        try:
            while not outcome.done():
                await Timer(_BITS * self._bit_ps, "ps")
        finally:
            self._calls -= 1
        return outcome.result()

    async def _leave(self) -> None:
        if hasattr(self, "link"):
            await self.run(self.link.close)
        for task in self._tasks:
            task.cancel()
        self._ours.close()

    async def _send(self) -> None:
        """Put the bytes of the link on the line, one after the other, for ever."""
        while True:
            data = self._next_bytes()
            for byte in data:
                for bit in (0, *(byte >> place & 1 for place in range(8)), 1):
                    self._to_board.value = bit
                    await Timer(self._bit_ps, "ps")
            if not data:
                self._quiet += 1
                await Timer(_BITS * self._bit_ps, "ps")

    def _next_bytes(self) -> bytes:
        """Return what the link has sent.

        While a call is under way and nothing is on the line, the program gets some real time to send more.
        Otherwise its requests would be many clocks apart on a busy machine, and the simulation longer.
        """
        if self._calls and self._quiet > _QUIET_BYTES:
            select.select([self._ours], [], [], _THINKING_S)
        try:
            data = self._ours.recv(_CHUNK)
        except BlockingIOError:
            return b""
        if data:
            self._quiet = 0
        return data

    async def _receive(self) -> None:
        """Take the bytes of the design from the line, and give them to the link."""
        waiting = bytearray()
        while True:
            await FallingEdge(self._from_board)
            self._quiet = 0
            await Timer(self._bit_ps // 2, "ps")
            byte = 0
            for place in range(8):
                await Timer(self._bit_ps, "ps")
                byte |= int(self._from_board.value) << place
            await Timer(self._bit_ps, "ps")
            if int(self._from_board.value) != 1:
                raise UnityLinkError(
                    f"{self._from_board._path}: a byte without a stop bit; does the design have "
                    f"{1e12 / self._bit_ps:.0f} baud? say it with baud_hz="
                )
            waiting.append(byte)
            try:
                del waiting[: self._ours.send(waiting)]
            except BlockingIOError:
                continue  # the program does not read; the bytes wait
            except OSError:
                return  # the link is closed


def _pin(dut: Any, name: str) -> Any:
    try:
        return getattr(dut, name)
    except AttributeError:
        raise UrlError(
            f"{dut._name} has no pin {name}; say which the link has: UnityLinkMaster(dut, spec, rx=, tx=)"
        ) from None
