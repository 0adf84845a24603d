# SPDX-License-Identifier: BSD-3-Clause
"""The twin in a process of its own: `python -m unitylink_lab.bench.board ENDPOINT CONFIGURATION`.

CONFIGURATION is a JSON object of `BoardConfiguration` fields. The program prints the URL and serves until
standard input ends. Word n of its memory holds FIRST_VALUE + n, so that a reader can check each word.
"""

from __future__ import annotations

import json
import sys
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from unitylink.layer2_message import Link
    from unitylink.layer4_data import ReadValue

FIRST_VALUE = 0x40DE0000
WORDS = 0x400
ADDRESS = 0x88
WRITTEN = 0x200
SPEC = f"""link bench;
public bench() {{
   @word    = {ADDRESS:#x}: READ(ID="word");
   @written = {WRITTEN:#x}: WRITE(ID="written");
}}
"""


def layer4_word(link: Link) -> ReadValue[Any]:
    """Return the word at ADDRESS as an object of layer 4, already read once."""
    from unitylink.layer4_data import ReadValue, load_spec_objects
    from unitylink.spec import compile_text

    from .figure import BenchError

    spec = compile_text(SPEC.encode(), "bench.ul").spec
    assert spec is not None
    word = load_spec_objects(spec, link)["word"]
    assert isinstance(word, ReadValue)
    if (value := word.read()) != FIRST_VALUE + ADDRESS:
        raise BenchError(f"the twin answered {value:#x} for address {ADDRESS:#x}")
    return word


def reads_of(url: str, count: int) -> list[int]:
    """Connect, read `count` times through layer 4, and return the times in ns."""
    from unitylink import connect

    from .timing import times

    with connect(url) as link:
        word = layer4_word(link)
        times(word.read, 50)
        return times(word.read, count)


def main() -> None:
    """Serve."""
    from unitylink.simulate import Board, BoardConfiguration

    endpoint, configuration = sys.argv[1], json.loads(sys.argv[2])
    with Board(configuration=BoardConfiguration(**configuration), endpoint=endpoint) as board:
        for address in range(WORDS):
            board.registers[address] = FIRST_VALUE + address
        print(board.url, flush=True)
        sys.stdin.read()


if __name__ == "__main__":
    main()
