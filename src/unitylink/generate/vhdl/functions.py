# SPDX-License-Identifier: BSD-3-Clause
"""Functions between the records of the user and the vectors of the design, a line a part of a value."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from .records import Leaf, Tree
from .value_types import SLOT, slices


@dataclass(frozen=True)
class Function:
    """`name`(`parameter`: `takes`) returns `gives`; `result`, of type `variable`, is made by `lines`."""

    name: str
    parameter: str
    takes: str
    gives: str
    result: str
    variable: str
    lines: tuple[str, ...]


def to_words(tree: Tree, words: int, data_bits: int) -> Function:
    """What the user's logic gives, as the vector of all words that the PC reads."""
    lines = ["words := (others => '0');"]
    for leaf in tree.leaves:
        lines += _to_words(leaf, data_bits)
    vector = _vector(SLOT * words)
    return Function("to_words", "to_pc", tree.type, "std_ulogic_vector", "words", vector, tuple(lines))


def from_words(tree: Tree, words: int, data_bits: int) -> Function:
    """The vector of all words that the PC wrote, as the user's logic sees them."""
    lines = tuple(_from_words(leaf, data_bits) for leaf in tree.leaves)
    return Function("from_words", "words", _vector(SLOT * words), tree.type, "from_pc", tree.type, lines)


def from_strobes(name: str, tree: Tree, words: int) -> Function:
    """A vector with a bit a word, as records."""
    lines = tuple(f"strobes_of.{leaf.path} := strobes({leaf.index});" for leaf in tree.leaves)
    return Function(name, "strobes", _vector(words), tree.type, "strobes_of", tree.type, lines)


def _to_words(leaf: Leaf, data_bits: int) -> Iterator[str]:
    low, high = leaf.part.low, leaf.part.high
    for last, first, bit in slices(leaf.index, low, high, data_bits):
        if leaf.part.base == "std_ulogic":
            yield f"words({first}) := to_pc.{leaf.path};"
        else:
            start = bit - low
            whole = last - first == high - low
            inside = "" if whole else f"({start + last - first} downto {start})"
            yield f"words({last} downto {first}) := std_ulogic_vector(to_pc.{leaf.path}{inside});"


def _from_words(leaf: Leaf, data_bits: int) -> str:
    places = list(slices(leaf.index, leaf.part.low, leaf.part.high, data_bits))
    if leaf.part.base == "std_ulogic":
        return f"from_pc.{leaf.path} := words({places[0][1]});"
    pieces = " & ".join(f"words({last} downto {first})" for last, first, _ in places)
    value = pieces if len(places) == 1 else f"std_ulogic_vector'({pieces})"
    return f"from_pc.{leaf.path} := {leaf.part.base}({value});"


def _vector(width: int) -> str:
    return f"std_ulogic_vector({width - 1} downto 0)"
