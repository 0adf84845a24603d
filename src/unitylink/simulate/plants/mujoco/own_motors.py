# SPDX-License-Identifier: BSD-3-Clause
"""The DC motors that one can name at a joint."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from unitylink.errors import ValueRangeError

from ...machine import MOTORS, DcMotorData


def motors_of(tables: Mapping[str, Any], file: str) -> dict[str, DcMotorData]:
    """Return the DC motors that one can name: those of the library, and those of a TOML."""
    found = dict(MOTORS)
    for name, table in tables.items():
        try:
            found[name] = DcMotorData(name, **table)
        except (TypeError, ValueRangeError) as error:
            text = str(error).replace("DcMotorData.__init__() ", "")
            raise ValueRangeError(f'{file}, motors."{name}": {text}') from error
    return found
