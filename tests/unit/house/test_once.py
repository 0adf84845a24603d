# SPDX-License-Identifier: BSD-3-Clause
"""Each function of the gateware stands in one file only. The other files use its package."""

from __future__ import annotations

import re
from collections import defaultdict

import pytest
from unit.house.files import files, text

BODY = re.compile(r"\bfunction\s+(\w+)\s*(\([^)]*\))?\s*return\s+([\w.]+)\s+is\b")


def signatures(vhdl: str) -> set[tuple[str, str, str]]:
    """Return (name, types of its parameters, type of its result) of each function with a body in `vhdl`.

    >>> signatures("function f (a, b : bit; c : word := 0) return bit is")
    {('f', 'bit bit word', 'bit')}
    """
    found = set()
    for name, parameters, result in BODY.findall(re.sub(r"--[^\n]*", "", vhdl)):
        types = []
        for group in parameters.strip("()").split(";") if parameters else []:
            names, _, kind = group.partition(":")
            types += [" ".join(kind.partition(":=")[0].split())] * len(names.split(","))
        found.add((name, " ".join(types), result))
    return found


def test_a_function_stands_once() -> None:
    places = defaultdict(list)
    for file in files((".vhd",)):
        if (
            file.parts[0] in ("gateware", "components")
            and file.parts[1] != "test"
            and not file.stem.endswith(("_tb", "_model"))
        ):  # a bench computes its expected values independently
            for signature in signatures(text(file)):
                places[signature].append(str(file))
    assert len(places) > 50
    twice = {signature: where for signature, where in places.items() if len(where) > 1}
    assert not twice, "put it into a package of gateware/common, or of the folder"


@pytest.mark.parametrize(
    ("vhdl", "found"),
    [
        ("function f return bit;", set()),
        ("function f return bit is", {("f", "", "bit")}),
        ("function f (a, b : bit; c : word := 0) return bit is", {("f", "bit bit word", "bit")}),
        ("-- function f return bit is", set()),
    ],
)
def test_the_functions_of_a_file(vhdl: str, found: set[tuple[str, str, str]]) -> None:
    assert signatures(vhdl) == found
