# SPDX-License-Identifier: BSD-3-Clause
"""A reset at any clock of any kind of message leaves a core that answers as after power-up."""

from __future__ import annotations

from typing import Any

import pytest


@pytest.mark.parametrize(
    "message",
    [
        "#R:12\n",
        "$W:20DEADBEEF*99\n",
        "#RM:03101112\n",
        "#RLC\n",
        "#WSA:00021112\n#WSR:000001\n#EPS\n#RSI:00\n",
        "#R:F5\n#R:zz\n%",
    ],
    ids=["read", "write", "read-many", "configuration", "publish", "errors"],
)
def test_reset_at_every_clock(ghdl: Any, message: str) -> None:
    ghdl.run("reset_tb", message=message.encode().hex())
