# SPDX-License-Identifier: BSD-3-Clause
"""XML from a stranger: a tree of its elements. Without entities it cannot grow, nor read other files."""

from __future__ import annotations

from pathlib import Path
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

from unitylink.errors import UnityLinkError

from .bounded import read_bounded

MOST_BYTES = 4_000_000
MOST_ELEMENTS = 50_000
MOST_DEPTH = 40


def read_xml(path: Path) -> Element:
    """Return the root element of a file.

    Raises UnityLinkError, with the line, if it is no XML, has a DOCTYPE, or is too large.
    """
    data = read_bounded(path, MOST_BYTES, "no URDF needs so much")
    parser, builder = expat.ParserCreate(), TreeBuilder()
    depth = count = 0

    def wrong(what: str) -> UnityLinkError:
        return UnityLinkError(f"{path}: line {parser.CurrentLineNumber}: {what}")

    def doctype(*_: object) -> None:
        raise wrong("a DOCTYPE is not read, because its entities can be anything; remove it")

    def begin(name: str, attributes: dict[str, str]) -> None:
        nonlocal depth, count
        depth, count = depth + 1, count + 1
        if depth > MOST_DEPTH or count > MOST_ELEMENTS:
            raise wrong(f"more than {MOST_DEPTH} elements within each other, or {MOST_ELEMENTS} in all")
        builder.start(name, attributes)

    def end(name: str) -> None:
        nonlocal depth
        depth -= 1
        builder.end(name)

    parser.StartDoctypeDeclHandler = doctype
    parser.StartElementHandler = begin
    parser.EndElementHandler = end
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        raise UnityLinkError(f"{path}: line {error.lineno}: {expat.errors.messages[error.code]}") from error
    except (LookupError, ValueError) as error:  # an encoding that nobody knows
        raise UnityLinkError(f"{path}: {error}") from error
    return builder.close()
