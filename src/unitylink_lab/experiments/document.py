# SPDX-License-Identifier: BSD-3-Clause
"""A report as blocks, written as Markdown or HTML."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from typing import Union


@dataclass(frozen=True)
class Heading:
    level: int
    text: str


@dataclass(frozen=True)
class Paragraph:
    text: str


@dataclass(frozen=True)
class Code:
    text: str


@dataclass(frozen=True)
class Table:
    """A table of rows under headers. `caption` describes them."""

    caption: str
    headers: Sequence[str]
    rows: Sequence[Sequence[str]]


@dataclass(frozen=True)
class Figure:
    """A picture. `name` is the file beside the report."""

    caption: str
    name: str


Block = Union[Heading, Paragraph, Code, Table, Figure]


def markdown(blocks: Sequence[Block], *, images: str = "") -> str:
    """Write the blocks as Markdown. `images` is the folder of the pictures.

    >>> print(markdown([Heading(1, "A"), Table("t", ["x"], [["1"]])]), end="")
    # A
    <BLANKLINE>
    t
    <BLANKLINE>
    | x |
    |---|
    | 1 |
    """
    return "\n\n".join(_markdown(block, images) for block in blocks) + "\n"


def _markdown(block: Block, images: str) -> str:
    if isinstance(block, Heading):
        return f"{'#' * block.level} {block.text}"
    if isinstance(block, Paragraph):
        return block.text
    if isinstance(block, Code):
        return f"```sh\n{block.text}\n```"
    if isinstance(block, Figure):
        return f"![{block.caption}]({images}{block.name})\n\n{block.caption}"
    lines = [block.headers, ["---"] * len(block.headers), *block.rows]
    table = "\n".join(
        "|---" * len(line) + "|" if line[0] == "---" else "| " + " | ".join(line) + " |" for line in lines
    )
    return f"{block.caption}\n\n{table}"


STYLE = (
    "body{font:15px/1.5 sans-serif;max-width:60em;margin:2em auto;padding:0 1em}"
    "table{border-collapse:collapse;font-size:13px}"
    "td,th{border:1px solid #ccc;padding:2px 8px;text-align:left}"
    "caption,figcaption{text-align:left;font-style:italic;padding:.5em 0}pre{background:#f4f4f4;padding:.6em}"
)


def html(blocks: Sequence[Block], title: str) -> str:
    """Write the blocks as a page of HTML."""
    body = "\n".join(_html(block) for block in blocks)
    return (
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>{escape(title)}</title>'
        f"<style>{STYLE}</style></head><body>\n{body}\n</body></html>\n"
    )


def _with_code(text: str) -> str:
    """Write the text between backticks as code.

    >>> _with_code("`a <b`, c")
    '<code>a &lt;b</code>, c'
    """
    return re.sub("`([^`]+)`", r"<code>\1</code>", escape(text))


def _html(block: Block) -> str:
    if isinstance(block, Heading):
        return f"<h{block.level}>{escape(block.text)}</h{block.level}>"
    if isinstance(block, Paragraph):
        return f"<p>{_with_code(block.text)}</p>"
    if isinstance(block, Code):
        return f"<pre>{escape(block.text)}</pre>"
    if isinstance(block, Figure):
        caption = _with_code(block.caption)
        image = f'<img src="{escape(block.name)}" alt="{escape(block.caption)}">'
        return f"<figure>{image}<figcaption>{caption}</figcaption></figure>"
    head = "".join(f"<th>{escape(name)}</th>" for name in block.headers)
    rows = "\n".join(
        "<tr>" + "".join(f"<td>{_with_code(cell)}</td>" for cell in row) + "</tr>" for row in block.rows
    )
    return f"<table><caption>{_with_code(block.caption)}</caption><tr>{head}</tr>\n{rows}</table>"
