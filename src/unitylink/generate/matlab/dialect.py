# SPDX-License-Identifier: BSD-3-Clause
"""How MATLAB spells tables and numbers. The MEX file reads them, so constants are numbers of its headers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ..objects.dialect import Dialect
from ..quoting import Code, Matlab

# Words of MATLAB and Octave, and methods of the classes in runtime/.
RESERVED = frozenset((Path(__file__).parent / "reserved.txt").read_text(encoding="ascii").split())
# The numbers of UL_KIND and UL_VALUE in native/include/unitylink/value.h. A test compares them.
CONSTANTS = {
    "KIND": {
        "UNSIGNED": 0,
        "SIGNED": 1,
        "REAL": 2,
        "SCALED": 3,
        "BOOL": 4,
        "ENUM": 5,
        "BITS": 6,
    },
    "VALUE": {
        "SIGNED": 1,
        "SATURATE": 2,
        "CHECKED": 4,
        "READ_AGAIN": 8,
        "WRITE_AGAIN": 16,
        "OPEN": 32,
        "FRAMES": 64,
    },
}


@dataclass(frozen=True)
class MatlabDialect(Dialect):
    """A table is a cell. Whole numbers of 64 bits are hexadecimal, because others are read as a double."""

    def unsigned(self, number: int) -> Code:
        return self.number(number)

    def constant(self, group: str, name: str) -> Code:
        return self.code.of("{}", CONSTANTS[group][name])

    def either(self, flags: Sequence[Code]) -> Code:
        return self.code(" + ").join(flags) or self.code("0")


MATLAB = MatlabDialect(Matlab, "u64", Matlab("[]"), RESERVED)
