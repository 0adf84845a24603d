# SPDX-License-Identifier: BSD-3-Clause
"""A virtual board whose device is a bitstream, unpacked and compiled."""

from __future__ import annotations

from unitylink.boards import load_board
from unitylink.errors import DeviceMismatch
from unitylink.interface.board_configuration import BoardConfiguration
from unitylink.spec.model import Spec

from ..plant import AnyPlant
from ..rtl.board import ModelBoard
from ..rtl.build import Progress, build_of_netlist, on_terminal
from ..rtl.design import RtlModel
from .pins import TOP, Pins, pin_map, wired
from .place import Placed, check_runs
from .unpack import unpack


class BitBoard(ModelBoard):
    """A `Board` that runs a bitstream: that of `placed`, for the board of its report.

        with BitBoard(placed_in(Path("build/lamp-icebreaker")), spec) as board, Link(board.url) as link:
            link.write(0x40, 1)
            board.pins["LEDG_N"]

    IceStorm or Project Trellis unpacks it. Verilator compiles it, which takes half a minute the first time.
    Then it comes from the cache. Device time is clocks over the rate that the bitstream's PLL makes. A UART
    is at the pins of the link, and `pins` are the others. A plant has those words of the spec that are on
    pins, if `unitylink build` made the logic around the link. Every other word is inside the chip.

    Raises BoardError (the board's link is no UART, or the file is not a bitstream of its chip),
    DeviceMismatch (it was built from another spec), ToolError (a program is missing, or the bitstream has a
    part that is not modelled), and everything that Board raises.
    """

    def __init__(
        self,
        placed: Placed,
        spec: Spec | None = None,
        *,
        plant: AnyPlant | None = None,
        endpoint: str = "fd",
        bind: str = "127.0.0.1",
        progress: Progress | None = None,
    ) -> None:
        report = placed.report
        if spec is not None and report["hash"] not in (None, spec.hash):
            raise DeviceMismatch(
                f"the bitstream was built from another spec: its hash is {report['hash']}, and that of "
                f"{spec.name} is {spec.hash}; build it again with `unitylink build`"
            )
        chip_board = load_board(report["board"])
        check_runs(chip_board)
        say = progress if progress is not None else on_terminal()
        say("unpacking the bitstream")
        try:
            chip = unpack(placed.bitstream, chip_board)
        finally:
            say("")
        words = {port: (address, bit) for port, (address, bit) in report.get("words", {}).items()}
        places = pin_map(chip, chip_board, report["pins"], words)
        library = build_of_netlist(wired(chip, chip_board, report["baud_hz"], places), TOP, say)
        model = RtlModel(library, places.read_addresses, places.write_addresses)
        # the line is in the model, so the streams beyond it have none
        given = {"clock_hz": chip.clock_hz, "protocol": report.get("protocol", "both")}
        configuration = BoardConfiguration.for_spec(spec, **given) if spec else BoardConfiguration(**given)
        super().__init__(
            spec if plant is not None else None,
            model,
            configuration=configuration,
            plant=plant,
            endpoint=endpoint,
            bind=bind,
        )
        self.pins = Pins(self._native, places, chip_board)
