# SPDX-License-Identifier: BSD-3-Clause
"""Measure how plain texts are:  python tools/docs/plain.py [--of KIND] [--draw N --seed S] [PATH ...]

It prints the sentences, the mean words in one, the share with a semicolon, and the longest, for each file and
for all. `--draw N` prints N sentences instead, for a person to read. A PATH is a file or a folder. Without
one, the whole checkout is read.

KIND is `pages` (Markdown, the default), `python` (docstrings and comments), `vhdl` or `c++` (comments).

A sentence is prose: no code block (fenced or indented), table, heading or front matter. In a docstring, an
example (`>>>`) with its output is no prose, nor is a block that click prints unwrapped. In a comment of VHDL
or C++, indented lines after an empty one are a drawing or a table. A list item ends its sentence. A link
counts as its text, and code in a line as one word. Fewer than three words are no sentence.
"""

from __future__ import annotations

import argparse
import ast
import inspect
import os
import random
import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[2]
NOT_READ = ("build", "dist", "node_modules")
SHORTEST = 3  # words
KINDS = {"pages": [".md"], "python": [".py"], "vhdl": [".vhd"], "c++": [".hpp", ".cpp", ".h"]}  # their files

FENCE = re.compile(r"^\s*(```|~~~)")
ITEM = re.compile(r"^\s*(?:[-*+]|\d+[.)])\s+")
NOT_PROSE = re.compile(r"^\s*(?:\||#{1,6} |={3,}$|-{3,}$|>>> |\.\.\. |\[[^\]]+\]:\s)")
VERBATIM = re.compile(r"^\s*(?:>>> |\x08$)")  # begins an example, or a block that click leaves unwrapped
CODE = re.compile(r"(`+)(.+?)\1", re.S)
LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\([^)]*\)")
HIDDEN = "\ue000"  # stands for a piece of code, so that a full stop in the code ends no sentence
DOT = "\u2024"  # the full stop of an abbreviation
ABBREVIATION = re.compile(r"\b(e\.g|i\.e|etc|vs|cf|Fig|No|approx)\.")
END = re.compile(r"(?<=[.!?])[)\"”*_]*\s+(?:(?![a-z])|(?=\w+(?:, \w+)*: ))")  # or before a name with a colon
WORD = re.compile(rf"[\w{HIDDEN}]")
DIRECTIVE = re.compile(r"(?:#|--|//)\s*(?:SPDX|type:|noqa|ruff:|mypy:|pragma|clang|NOLINT|!)")
# Matches everything that may hold the mark of a comment. Only the group is a comment.
COMMENT = {
    ".py": re.compile(r"""(?s:\"\"\".*?\"\"\"|'''.*?''')|\"(?:[^\"\\\n]|\\.)*\"|'(?:[^'\\\n]|\\.)*'|(#.*)"""),
    ".vhd": re.compile(r"""\"[^\"\n]*\"|'.'|(--.*)"""),
    ".cpp": re.compile(r"""\"(?:[^\"\\\n]|\\.)*\"|'\\?.'|(//.*|(?s:/\*.*?\*/))"""),
}
COMMENT[".hpp"] = COMMENT[".h"] = COMMENT[".cpp"]
MARK = re.compile(r"^[ \t]*(?:#[#:]*|--|///?<?|/?\*+/?) ?|\s*\*/$", re.M)


class Sentence(NamedTuple):
    """One sentence and where it begins."""

    file: Path
    line: int
    text: str
    words: int


class Figures(NamedTuple):
    """The figures of some sentences. `mean` is in words, `semicolons` is a share from 0 to 1."""

    sentences: int
    mean: float
    semicolons: float
    longest: int


def figures(sentences: Iterable[Sentence]) -> Figures:
    """Return the figures of `sentences`."""
    found = list(sentences)
    if not found:
        return Figures(0, 0.0, 0.0, 0)
    words = [sentence.words for sentence in found]
    with_semicolon = sum(";" in CODE.sub("", sentence.text) for sentence in found)
    return Figures(len(found), sum(words) / len(found), with_semicolon / len(found), max(words))


def files(paths: Sequence[Path], kind: str = "pages") -> list[Path]:
    """Return the files in `paths` that have sentences of this kind. A file in `paths` always counts."""
    found = {path.resolve() for path in paths if not path.is_dir()}
    for path in paths:
        for folder, folders, names in os.walk(path.resolve()):
            folders[:] = [name for name in folders if not name.startswith(".") and name not in NOT_READ]
            found |= {Path(folder, name) for name in names if Path(name).suffix in KINDS[kind]}
    return sorted(found)


def sentences(file: Path) -> list[Sentence]:
    """Return the sentences of a Markdown file, or of the docstrings and comments of a source file."""
    text, code_indent = file.read_text("utf-8"), 4
    if file.suffix == ".py":
        parts = list(_python(text))
    elif file.suffix in COMMENT:
        parts, code_indent = list(_comments(text, COMMENT[file.suffix])), 2
    else:
        parts = [(0, text)]
    return [
        Sentence(file, line + offset, sentence, words)
        for offset, part in parts
        for begin, block in _blocks(part, code_indent)
        for line, sentence, words in _split(begin, block)
    ]


def _blocks(text: str, code_indent: int) -> Iterator[tuple[int, str]]:
    """Yield (line, text) of each paragraph and each list item. The text keeps the line ends of the page."""
    text = re.sub(r"\A---\n.*?^---$", _blank, text, flags=re.M | re.S)  # front matter
    text = re.sub(r"<!--.*?-->", _blank, text, flags=re.S)
    begin, block, fenced, verbatim, margin = 0, [], False, False, 0
    for number, line in enumerate([*text.splitlines(), ""], 1):
        fence, item = bool(FENCE.match(line)), ITEM.match(line)
        indent = len(line) - len(line.lstrip())
        verbatim = bool(line.strip()) and (verbatim or bool(VERBATIM.match(line)))
        code = fenced or fence or verbatim or (indent >= margin + code_indent and not block and not item)
        prose = bool(line.strip()) and not code and not NOT_PROSE.match(line)
        fenced ^= fence
        if block and (not prose or item):
            yield begin, "\n".join(block)
            block = []
        if prose:
            if not block:
                begin, margin = number, len(item.group()) if item else min(margin, indent)
            block.append(ITEM.sub("", line).strip().removeprefix("> "))


def _blank(found: re.Match[str]) -> str:
    return "\n" * found.group().count("\n")


def _split(line: int, block: str) -> Iterator[tuple[int, str, int]]:
    """Yield (line, text, words) of each sentence of a block that begins at `line`."""
    block = LINK.sub(lambda found: "" if found[1] else found[2], block)
    code = (found.group() for found in CODE.finditer(block))
    hidden = ABBREVIATION.sub(lambda found: found[1].replace(".", DOT) + DOT, CODE.sub(HIDDEN, block))
    begin = 0
    for end in [*(found.end() for found in END.finditer(hidden)), len(hidden)]:
        words = sum(bool(WORD.search(word)) for word in hidden[begin:end].split())
        text = re.sub(HIDDEN, lambda _: next(code), hidden[begin:end]).replace(DOT, ".")
        if words >= SHORTEST:
            yield line + hidden.count("\n", 0, begin), " ".join(text.split()), words
        begin = end


def _python(source: str) -> Iterator[tuple[int, str]]:
    """Yield (lines before it, text) of each docstring and each run of comments."""
    # No syntax tree: to make it takes far longer than all the rest.
    for found in COMMENT[".py"].finditer(source):
        text = found.group()
        if text.startswith(('"""', "'''")):
            begin = source.rfind("\n", 0, found.start()) + 1
            prefix = source[begin : found.start()].strip()
            if prefix in ("", "r") and _opens_block(source, begin):
                yield source.count("\n", 0, begin), inspect.cleandoc(ast.literal_eval(prefix + text))
    yield from _comments(source, COMMENT[".py"])


def _opens_block(source: str, end: int) -> bool:
    """Is what stands before `end` the head of a block, or nothing but comments?"""
    while end > 0:
        begin = source.rfind("\n", 0, end - 1) + 1
        line = source[begin:end].strip()
        if line and not line.startswith("#"):
            return line.partition("  #")[0].endswith(":")
        end = begin
    return True


def _comments(source: str, pattern: re.Pattern[str]) -> Iterator[tuple[int, str]]:
    """Yield (lines before it, text) of each run of comments. A comment beside code is a run of its own."""
    begin, last, comment = 0, -1, ""  # a comment in the line after `last` continues the run
    for found in pattern.finditer(source):
        if not found[1] or DIRECTIVE.match(found[1]):
            continue
        line = source.count("\n", 0, found.start())
        alone = not source[source.rfind("\n", 0, found.start()) + 1 : found.start()].strip()
        text = MARK.sub("", found[1])
        if comment and not (alone and line == last + 1):
            yield begin, comment
            comment = ""
        begin = begin if comment else line
        comment, last = f"{comment}\n{text}" if comment else text, line if alone else -1
    if comment:
        yield begin, comment


def _name(file: Path) -> str:
    return str(file.relative_to(ROOT) if file.is_relative_to(ROOT) else file)


def main() -> None:
    """Print the figures, or draw sentences."""
    parser = argparse.ArgumentParser(description="Measure how plain texts are.")
    parser.add_argument(
        "path", nargs="*", type=Path, default=[ROOT], help="files or folders; the checkout without"
    )
    parser.add_argument("--of", choices=KINDS, default="pages", help="which texts are read")
    parser.add_argument("--draw", type=int, metavar="N", help="print N sentences drawn at random")
    parser.add_argument("--seed", type=int, default=1, help="which sentences --draw draws")
    arguments = parser.parse_args()
    read = {file: sentences(file) for file in files(arguments.path, arguments.of)}
    every = [sentence for found in read.values() for sentence in found]
    if arguments.draw is not None:
        for one in random.Random(arguments.seed).sample(every, min(arguments.draw, len(every))):
            print(f"{_name(one.file)}:{one.line}: {one.text}")
        return
    print(f"{'sentences':>9} {'mean':>5} {'semicolons':>10} {'longest':>7}  file")
    for name, found in [*((_name(file), found) for file, found in read.items()), ("all", every)]:
        one = figures(found)
        print(f"{one.sentences:9} {one.mean:5.1f} {one.semicolons:10.0%} {one.longest:7}  {name}")


if __name__ == "__main__":
    main()
