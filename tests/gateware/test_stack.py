# SPDX-License-Identifier: BSD-3-Clause
"""A whole design, from the PC's wire to the pins."""

from __future__ import annotations

from typing import Any

import pytest


@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.long)])
def test_uart_core_interconnect_and_every_slave(ghdl: Any, seed: int) -> None:
    ghdl.run("stack_tb", seed=seed)
