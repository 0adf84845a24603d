# SPDX-License-Identifier: BSD-3-Clause
"""Names of a spec as Python names. One rule serves generated classes and objects made at run time."""

from __future__ import annotations

import keyword
from collections.abc import Iterable


def python_names(names: Iterable[str], reserved: Iterable[str] = ()) -> dict[str, str]:
    """Map names of a spec to Python names. A name is unchanged if that works, else it gets "_" at the end.

    Leading underscores are dropped, because they mean private (and Python changes names with two of them).

    >>> python_names(["cpos", "class", "class_", "path", "__x"], {"path"})
    {'cpos': 'cpos', 'class': 'class__', 'class_': 'class_', 'path': 'path_', '__x': 'x_'}
    """
    names, blocked = list(names), set(reserved)
    plain = {n for n in names if not (keyword.iskeyword(n) or n in blocked or n.startswith("_"))}
    taken = plain | blocked
    result = {}
    for name in names:
        attribute = name
        if name not in plain:
            attribute = name.lstrip("_")
            attribute = (attribute if attribute.isidentifier() else f"n{attribute}") + "_"
            while attribute in taken:
                attribute += "_"
            taken.add(attribute)
        result[name] = attribute
    return result
