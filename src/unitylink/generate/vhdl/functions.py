# SPDX-License-Identifier: BSD-3-Clause
"""Functions between the user's records and the design's vectors, with one line for each part of a value."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from ..quoting import Vhdl
from .records import Leaf, Tree
from .value_types import SLOT, slices


@dataclass(frozen=True)
class Function:
    """`name`(`parameter`: `takes`) returns `gives`.

    Its lines make `result`, a variable of the type `variable`.
    """

    name: str
    parameter: str
    takes: Vhdl
    gives: Vhdl
    result: str
    variable: Vhdl
    lines: tuple[Vhdl, ...]


def to_words(tree: Tree, words: int, data_bits: int) -> Function:
    """Return the function from the outputs of the user's logic to the vector of words that the PC reads."""
    lines = [Vhdl("words := (others => '0');")]
    for leaf in tree.leaves:
        lines += _to_words(leaf, data_bits)
    vector = _vector(SLOT * words)
    gives = Vhdl("std_ulogic_vector")
    return Function("to_words", "to_pc", tree.type, gives, "words", vector, tuple(lines))


def from_words(tree: Tree, words: int, data_bits: int) -> Function:
    """Return the function from the vector of words that the PC wrote to the records of the user's logic."""
    lines = tuple(_from_words(leaf, data_bits) for leaf in tree.leaves)
    return Function("from_words", "words", _vector(SLOT * words), tree.type, "from_pc", tree.type, lines)


def from_strobes(name: str, tree: Tree, words: int) -> Function:
    """Return the function from a vector with one bit for each word to records."""
    lines = tuple(Vhdl.of("strobes_of.{} := strobes({});", leaf.path, leaf.index) for leaf in tree.leaves)
    return Function(name, "strobes", _vector(words), tree.type, "strobes_of", tree.type, lines)


def _to_words(leaf: Leaf, data_bits: int) -> Iterator[Vhdl]:
    low, high = leaf.part.low, leaf.part.high
    for last, first, bit in slices(leaf.index, low, high, data_bits):
        if leaf.part.base == "std_ulogic":
            yield Vhdl.of("words({}) := to_pc.{};", first, leaf.path)
        else:
            start = bit - low
            whole = last - first == high - low
            inside = Vhdl("") if whole else Vhdl.of("({} downto {})", start + last - first, start)
            value = Vhdl.of("std_ulogic_vector(to_pc.{}{})", leaf.path, inside)
            yield Vhdl.of("words({} downto {}) := {};", last, first, value)


def _from_words(leaf: Leaf, data_bits: int) -> Vhdl:
    places = list(slices(leaf.index, leaf.part.low, leaf.part.high, data_bits))
    if leaf.part.base == "std_ulogic":
        return Vhdl.of("from_pc.{} := words({});", leaf.path, places[0][1])
    pieces = Vhdl(" & ").join(Vhdl.of("words({} downto {})", last, first) for last, first, _ in places)
    value = pieces if len(places) == 1 else Vhdl.of("std_ulogic_vector'({})", pieces)
    return Vhdl.of("from_pc.{} := {}({});", leaf.path, leaf.part.base, value)


def _vector(width: int) -> Vhdl:
    return Vhdl.of("std_ulogic_vector({} downto 0)", width - 1)
