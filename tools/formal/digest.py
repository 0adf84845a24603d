# SPDX-License-Identifier: BSD-3-Clause
"""The digest of everything on which a proof depends.

The record keeps it, so that a stale proof is noticed.
"""

from __future__ import annotations

import ast
import hashlib
from collections.abc import Mapping
from dataclasses import fields
from functools import cache
from pathlib import Path

from alone import ALONE
from block import Block
from guides import GUIDES
from merge import MERGED
from sweep import SWEPT

from unitylink.gateware import gateware_sources, property_sources
from unitylink.gateware import ghdl as ghdl_module
from unitylink.gateware import repairs as repairs_module
from unitylink.gateware.dependencies import needed_sources, plain_text

_HERE = Path(__file__).parent
_ASKS = (  # the files that make the models and ask the solvers
    *(_HERE / name for name in ("cases.py", "model.py", "solvers.py")),
    *(Path(str(module.__file__)) for module in (ghdl_module, repairs_module)),
)
_ASKS_GUIDED = _HERE / "guides.py"  # for blocks that have a guide there
_ASKS_LARGE = _HERE / "large.py"  # for blocks that set one of these fields
_ASKS_SWEPT = _HERE / "sweep.py"  # for the blocks that it names
_ASKS_MERGED = _HERE / "merge.py"  # likewise
_ASKS_ALONE = _HERE / "alone.py"  # likewise
_LARGE = ("by_abc", "guided")
_WORDS_ONLY = ("what", "not_proven", "quick")  # fields of a row that change no question


def digest(block: Block) -> str:
    """Return 16 hex digits over all VHDL of `block`, over its row, and over the questions for the solvers.

    Comments, docstrings and blanks do not count. Nor do the versions of the solvers, because a proof stays
    valid.
    """
    said = hashlib.sha256()
    for part in (_row(block), *map(plain_text, sources_of(block)), *map(_python, _asks(block))):
        said.update(part.encode() + b"\0")
    return said.hexdigest()[:16]


def sources_of(block: Block) -> list[Path]:
    """Return the VHDL files of the block and of its properties."""
    return needed_sources(block.top, [*gateware_sources(), *property_sources()])


def stale(blocks: tuple[Block, ...], record: Mapping[str, Mapping[str, object]]) -> list[str]:
    """Return the blocks that have no proof in the record, or one of other sources."""
    return [block.name for block in blocks if record.get(block.name, {}).get("digest") != digest(block)]


@cache
def _python(path: Path) -> str:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        if (
            isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef))
            and ast.get_docstring(node) is not None
        ):
            del node.body[0]
    return ast.dump(tree)


def _asks(block: Block) -> tuple[Path, ...]:
    asks = (*_ASKS, _ASKS_LARGE) if _is_large(block) else _ASKS
    if block.name in GUIDES:
        asks = (*asks, _ASKS_GUIDED)
    if block.name in MERGED:
        asks = (*asks, _ASKS_MERGED)
    if block.name in ALONE:
        asks = (*asks, _ASKS_ALONE)
    return (*asks, _ASKS_SWEPT) if block.name in SWEPT else asks


def _is_large(block: Block) -> bool:
    return any(getattr(block, name) for name in _LARGE)


def _row(block: Block) -> str:
    """Return what a row asks. The fields for large blocks count only there."""
    left_out = _WORDS_ONLY if _is_large(block) else (*_WORDS_ONLY, *_LARGE)
    return repr([getattr(block, each.name) for each in fields(block) if each.name not in left_out])
