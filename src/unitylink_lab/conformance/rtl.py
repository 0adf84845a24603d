# SPDX-License-Identifier: BSD-3-Clause
"""A replay on the gateware: GHDL runs its core in the bench gateware/test/replay_tb.vhd."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, Protocol

from unitylink.errors import ToolError
from unitylink.gateware import Ghdl, every_source, gateware_folder

if TYPE_CHECKING:
    from unitylink.simulate import BoardConfiguration


# The letter of a step in the bench's file. It is the first letter of its name, except here: `r` is `reset`.
LETTERS = {"rx_error": "x", "deaf": "d", "dead": "k"}


class Simulator(Protocol):
    """What runs a bench: `unitylink.gateware.Ghdl`, or a stand-in of a test."""

    def run(self, bench: str, **generics: int | str | bool) -> str: ...


class RtlPlayer:
    """A player that gives the steps to the core in GHDL, as `play_on_twin` in bench.py gives them to the
    twin.

    `times` holds (kind, clock, byte or address or -1) for the last run. The head of replay_tb.vhd explains
    the kinds.
    """

    def __init__(self, ghdl: Simulator, folder: Path) -> None:
        self.ghdl = ghdl
        self.folder = folder
        self.runs = 0
        self.times: list[tuple[str, int, int]] = []

    def __call__(
        self,
        configuration: BoardConfiguration,
        exchanges: Sequence[Sequence[tuple[str, Any]]],
        /,  # positional only, because the bench has a generic of that name, too
        **generics: int | str | bool,
    ) -> list[bytes]:
        """Do the exchanges in order from reset.

        Return the bytes that the core sent during each one. Raises ToolError.
        """
        self.runs += 1
        steps_file = self.folder / f"steps_{self.runs}.txt"
        answers_file = self.folder / f"answers_{self.runs}.txt"
        steps = [step for exchange in exchanges for step in exchange]
        steps_file.write_text(
            "".join(
                f"{LETTERS.get(kind, kind[0])} "
                f"{argument.encode('latin-1').hex() if kind == 'send' else argument}\n"
                for kind, argument in steps
            ),
            encoding="ascii",
        )
        self.ghdl.run(
            "replay_tb",
            **{
                "steps_file": str(steps_file),
                "answers_file": str(answers_file),
                **generics_of(configuration),
                **generics,
            },
        )
        sent = self._sent(answers_file)
        if len(sent) != len(steps) + 1:
            raise ToolError(f"replay_tb played {len(sent) - 1} of {len(steps)} steps: see {answers_file}")
        after_all = sent.pop()
        sent[-1] += after_all
        parts = iter(sent)
        return [b"".join(next(parts) for _ in exchange) for exchange in exchanges]

    def _sent(self, answers_file: Path) -> list[bytes]:
        """Return the bytes sent in each step. The last entry holds those sent after all steps."""
        sent: list[bytes] = [b""]
        self.times = []
        for line in answers_file.read_text(encoding="ascii").splitlines():
            kind, *numbers = line.split()
            if numbers:
                self.times.append((kind, int(numbers[0]), int(numbers[1]) if len(numbers) > 1 else -1))
            if kind == "b":
                sent[-1] += bytes([int(numbers[1])])
            elif kind == "s":
                sent.append(b"")
        return sent


_CLASSIC = ["address_bits", "data_bits", "base_hz", "groups", "group_size", "rate_bytes", "read_many"]
_CLASSIC += ["publish_mode", "configuration_command", "datalink", "checksum", "polynomial"]


def generics_of(configuration: BoardConfiguration) -> dict[str, int | str | bool]:
    """Return the generics of the bench. A replay of text does not use the settings of frames."""
    return {
        **{name: getattr(configuration, name) for name in _CLASSIC},
        "edge_events": sum(1 << group for group in configuration.edge_events),
        "recorded": int(configuration.bench_memory),
    }


@contextmanager
def rtl_player() -> Iterator[RtlPlayer]:
    """Yield a player on the VHDL of this checkout. Raises ToolError if GHDL or the benches are missing."""
    benches = gateware_folder() / "test"
    if not (benches / "replay_tb.vhd").is_file():
        raise ToolError("the benches of the gateware did not come with this installation: use a checkout")
    with TemporaryDirectory(prefix="unitylink-conformance-") as work:
        folder = Path(work)
        yield RtlPlayer(Ghdl(folder, every_source()), folder)
