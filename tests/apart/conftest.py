# SPDX-License-Identifier: BSD-3-Clause
"""The board of the histories."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def journal_board(program: Callable[[str], Path]) -> Path:
    return program("journal_board")
