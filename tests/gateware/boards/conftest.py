# SPDX-License-Identifier: BSD-3-Clause
"""Make the netlist of each design once.

GHDL takes two seconds for one, and these tests are about the later steps.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pytest

from unitylink.boards import flow, vendor
from unitylink.gateware import netlist

_made: dict[object, str] = {}


def _once(top: str, *, sources: Sequence[Path], generics: Mapping[str, Any], assertions: bool) -> str:
    texts = tuple((path.name, path.read_bytes()) for path in sources)
    key = (top, texts, tuple(sorted(generics.items())), assertions)
    if key not in _made:
        _made[key] = netlist(top, sources=sources, generics=generics, assertions=assertions)
    return _made[key]


@pytest.fixture(autouse=True)
def netlists_are_made_once(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (flow, vendor):
        monkeypatch.setattr(module, "netlist", _once)
