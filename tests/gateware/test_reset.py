# SPDX-License-Identifier: BSD-3-Clause
"""After a reset at any clock of any kind of message, the core answers as after power-up."""

from __future__ import annotations

from typing import Any

import pytest

MESSAGES = {
    "read": "#R:12\n",
    "write": "#W:20DEADBEEF\n",
    "write checked": "$W:20DEADBEEF*99\n",
    "read-many": "#RM:03101112\n",
    "configuration": "#RLC\n",
    "group": "#WSA:00021112\n#RSI:00\n#WSR:000005\n",
    "mask": "#WIC:0003\n#RIC\n",
    "publish": "#WSA:00021112\n#WSR:000001\n#EPS\n#RSI:00\n",
    "publish checked": "#WSA:00021112\n#WSR:000001\n#WSA:010113\n#WSR:010001\n#EPC\n",
    "errors": "#R:F5\n#R:zz\n%",
}


def as_bytes(text: str) -> bytes:
    """Return the same requests for a core without a datalink, where data are bytes."""
    lines = [line.partition(":") for line in text.splitlines()]
    return b"".join(f"{head}{colon}".encode() + bytes.fromhex(data) + b"\n" for head, colon, data in lines)


@pytest.mark.parametrize("message", MESSAGES)
def test_reset_at_every_clock(ghdl: Any, message: str) -> None:
    ghdl.run("reset_tb", message=MESSAGES[message].encode().hex())


@pytest.mark.parametrize("message", ["write", "read-many", "group", "mask", "publish", "errors"])
def test_reset_at_every_clock_without_checks(ghdl: Any, message: str) -> None:
    ghdl.run("reset_tb", message=MESSAGES[message].encode().hex(), datalink="lite")


@pytest.mark.parametrize("message", ["read", "write", "read-many", "group", "mask", "publish"])
def test_reset_at_every_clock_with_data_as_bytes(ghdl: Any, message: str) -> None:
    ghdl.run("reset_tb", message=as_bytes(MESSAGES[message]).hex(), datalink="none")
