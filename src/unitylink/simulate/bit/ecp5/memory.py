# SPDX-License-Identifier: BSD-3-Clause
"""The block RAMs of an ECP5 as Verilog: 18 kbit with two ports (Lattice's technical note TN1264)."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

from unitylink.errors import ToolError

from .logic import Nets

OUTPUT = re.compile(r"JDO([AB])(\d+)_EBR")
_MODES = {"NORMAL": 0, "WRITETHROUGH": 1, "READBEFOREWRITE": 2}


class Memory:
    """A block RAM. `values` are its settings, with the part before the first dot taken off."""

    def __init__(
        self, row: int, column: int, values: Mapping[str, str], first: tuple[int, ...], nets: Nets
    ) -> None:
        self._at = (row, column)
        self._values = values
        self._first = first
        self._nets = nets

    def cell(self, name: str) -> Iterator[str]:
        """Print the memory. `name`_a and `name`_b are the words that its ports give."""
        wide = self._values["MODE"] == "PDPW16KD"  # one port writes 36 bits, the other one reads
        kind = self._values["MODE"]
        if wide:
            widths = {"A": 36, "B": int(self._values["PDPW16KD.DATA_WIDTH_R"])}
        else:
            widths = {port: int(self._values[f"{kind}.DATA_WIDTH_{port}"]) for port in "AB"}
        modes = {port: 0 if wide else _MODES[self._values[f"{kind}.WRITEMODE_{port}"]] for port in "AB"}
        late = {port: self._values.get(f"REGMODE_{port}") == "OUTREG" for port in "AB"}
        if wide and any(late.values()):
            self._check_wide_register(late)
        parameters = [
            f".{port}_WIDTH({widths[port]}), .{port}_MODE({modes[port]}), .{port}_LATE({late[port]:d})"
            for port in "AB"
        ]
        content = sum(word << 9 * number for number, word in enumerate(self._first))
        links = [f".clock(clock), .doa({name}_a), .dob({name}_b)"]
        for port in "AB":
            if not self._nets.clock((*self._at, f"JCLK{port}_EBR")):  # this port is not used
                links += [f".{signal}{port.lower()}(1'b0)" for signal in ("ce", "oce", "we", "ad", "di")]
                continue
            self._check(port)
            links += [
                f".{signal.lower()}{port.lower()}({self._control(signal, port, wide)})"
                for signal in ("CE", "OCE", "WE")
            ]
            links += [
                f".{signal.lower()}{port.lower()}({self._bus(signal, port, bits)})"
                for signal, bits in (("AD", 14), ("DI", 18))
            ]
        yield f"wire [17:0] {name}_a, {name}_b;"
        parameters.append(f".FIRST(18432'h{content:x})")
        yield f"unitylink_ebr #({', '.join(parameters)}) {name} ({', '.join(links)});"

    def _bus(self, name: str, port: str, bits: int) -> str:
        return "{" + ", ".join(self._net(f"{name}{port}{bit}") for bit in reversed(range(bits))) + "}"

    def _net(self, signal: str) -> str:
        net = self._nets.net((*self._at, f"J{signal}_EBR"), "1'b1")
        return f"~{net}" if self._values.get(f"{signal}MUX") == "INV" else net

    def _control(self, signal: str, port: str, wide: bool) -> str:
        if wide and signal == "WE":
            return "1'b1" if port == "A" else "1'b0"
        return self._net(f"{signal}{port}")

    def _check(self, port: str) -> None:
        """Raise ToolError if the memory does something that the model does not do."""
        what = ""
        if self._net(f"RST{port}") != "~1'b1":
            what = "a reset"
        elif self._values.get(f"CSDECODE_{port}") != "111" or any(
            self._net(f"CS{port}{bit}") != "1'b1" for bit in range(3)
        ):
            what = "a chip select"
        elif self._values.get(f"CLK{port}MUX") != f"CLK{port}":
            what = "a falling edge of its clock"
        if what:
            raise self._refusal(what)

    def _check_wide_register(self, late: Mapping[str, bool]) -> None:
        """Raise ToolError if the halves of a word do not have the same register. Port B has its enable."""
        alone = self._net("OCEA")
        if not all(late.values()) or ("1'b" not in alone and alone != self._net("OCEB")):
            raise self._refusal("two different registers behind one word")

    def _refusal(self, what: str) -> ToolError:
        row, column = self._at
        at = f"row {row}, column {column}"
        return ToolError(f"the bitstream has a block RAM with {what}: that is not modelled ({at})")
