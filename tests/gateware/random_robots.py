# SPDX-License-Identifier: BSD-3-Clause
"""Robots out of components drawn at random, played on `sim:` and on `rtl:` with the same accesses.

A test of a component sees it alone. Here several share a bus, a clock and a link. This looks at more robots
than the test does:

    python tests/gateware/random_robots.py --seed 100 --count 20
"""

from __future__ import annotations

import argparse
import random
import re
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from unitylink import connect
from unitylink.errors import UnityLinkError
from unitylink.layer2_message import Link
from unitylink.simulate import BoardConfiguration
from unitylink.spec import Element, Spec, load

ROOT = Path(__file__).resolve().parents[2]
TURNS = 40
# So many clocks there are from a byte at the pins to the access on the bus, at most. `sim:` has none. So on
# `rtl:` a word may be that of a little earlier or later. A time may differ by so many clocks or microseconds.
WAY_CLOCKS = {"fast": 64, "small": 1200}
_TIMES = re.compile(r"(.*\.)?(index_)?(stamp|age)(\[\d+\])?")
_EXAMPLE = re.compile(r"^public \w+\(\) \{\n(.*?)^\}\n(.*)", re.DOTALL | re.MULTILINE)
LINKS = (
    "ADDRESS=16",
    "ADDRESS=24",
    "ADDRESS=16, ENGINE=small",
    "ADDRESS=16, ENGINE=fast",
    "ADDRESS=32, DATA=32",
)
Outcome = int | str  # a word, or what the error said


def robot_text(draw: random.Random) -> str:
    """Return a spec with the examples of two to four components, and some words beside them.

    >>> robot_text(random.Random(1)).startswith("link robot (ADDRESS=")
    True
    """
    folders = draw.sample(component_folders(), draw.randint(2, 4))
    kinds = ("u32", "i32", "u8", "i16")
    words = [
        f"   @w{at} = {0xF000 + at:#x}: {draw.choice(kinds)} READWRITE(INITIAL={draw.randint(0, 100)});\n"
        for at in range(draw.randint(1, 5))
    ]
    return f"link robot ({draw.choice(LINKS)});\n{robot_of(folders, words)}"


def component_folders() -> list[Path]:
    return sorted((ROOT / "components").glob("*/"))


def robot_of(folders: Sequence[Path], words: Sequence[str]) -> str:
    """Return a public object with the examples of these components and with `words`, without a link."""
    inside, beside = [], []
    for place, folder in enumerate(folders):
        found = _EXAMPLE.search((folder / "example.ul").read_text("utf-8"))
        assert found, f"{folder.name}: the example has no public object"
        inside.append(renamed(found[1], place))
        beside.append(found[2])  # components of its own
    return f"public robot() {{\n{''.join([*inside, *words])}}}\n{''.join(beside)}"


def renamed(body: str, place: int) -> str:
    """Return the lines with other names for their components, so that two examples may have the same.

    >>> renamed("  a: pwm();\\n  b: pid(input=a.level);\\n", 3)
    '  a_3: pwm();\\n  b_3: pid(input=a_3.level);\\n'
    """
    for name in re.findall(r"^\s*(\w+)\s*:", body, re.MULTILINE):
        body = re.sub(rf"(?<![\w.]){name}(?=\.|\s*:)", f"{name}_{place}", body)
    return body


def slack_of(element: Element, way: int) -> int:
    """Return how much a word may differ because `rtl:` is `way` clocks later, beside what changes meanwhile.

    A write begins or ends what counts. So times differ by the way, and failures by those in it.
    """
    names = [(element.path, 0), *((field.name, field.low) for field in element.type.fields)]
    slack = 0
    for name, low in names:
        if _TIMES.fullmatch(name):
            slack += way << low
        elif name.endswith("failures"):
            slack += 2 << low
    return slack


class Player:
    """Draws accesses for a spec, and makes them on a board."""

    def __init__(self, spec: Spec, seed: int) -> None:
        self.draw = random.Random(seed)
        self.elements: dict[int, Element] = {}
        self.read: list[int] = []
        self.written: list[int] = []
        for _, element in spec.walk():
            for address in element.addresses:
                self.elements[address] = element
                if element.readable and element.pollable:
                    self.read.append(address)
                if element.writable:
                    self.written.append(address)

    def accesses(self) -> Iterator[Access]:
        """Yield writes that most components take, and some refuse; then a pause, and a read of each word."""
        for _ in range(self.draw.randint(0, 4)):
            address = self.draw.choice(self.written)
            small, wide = self.draw.randint(0, 4000), self.draw.getrandbits(32)
            yield Access(address, self.draw.choice((0, 1, 3, small & 0xFF, small, wide)))
        pause_s = self.draw.choice((0.0005, 0.001, 0.003))
        for address in self.read:
            yield Access(address, None, pause_s)
            pause_s = 0.0


@dataclass
class Access:
    """A read, or a write of `value`, a while after the one before it; and what came of it on `rtl:`."""

    address: int
    value: int | None
    pause_s: float = 0.0
    time_s: float = 0.0
    outcome: Outcome = 0

    def on(self, link: Link) -> Outcome:
        """Return the word that was read, 0 for a write, or the error in words."""
        try:
            if self.value is None:
                return link.read(self.address)
            link.write(self.address, self.value)
        except UnityLinkError as error:
            return f"{type(error).__name__}: {error}"
        return 0


def play(file: Path, seed: int) -> tuple[list[Access], BoardConfiguration]:
    """Play on `rtl:`. Return what was done when, and the board it was done on."""
    player, done = Player(load(str(file)), seed), []
    with connect(f"rtl:{file}?timeout=60", time="lockstep") as link:
        for _ in range(TURNS):
            for access in player.accesses():
                if access.pause_s:
                    link.step(access.pause_s)
                access.time_s = link.board.time_s
                access.outcome = access.on(link)
                done.append(access)
        return done, link.board.configuration


def differences(file: Path, done: Sequence[Access], board: BoardConfiguration) -> list[str]:
    """Play what was done on `sim:`. Return each read and each error that is not the same, in words."""
    elements = Player(load(str(file)), 0).elements
    way = WAY_CLOCKS[board.engine]
    differ = []
    with connect(f"sim:{file}?timeout=60&clock_hz={board.clock_hz}", time="lockstep") as link:
        given: list[Outcome]
        for access in done:
            if access.value is None:
                given = around(link, access, way / board.clock_hz)
            else:
                to(link, access.time_s)
                given = [access.on(link)]
            element = elements[access.address]
            if not between(given, access.outcome, slack_of(element, way)):
                differ.append(
                    f"{element.path} at {access.time_s:.6f} s: {access.outcome} on rtl:, {given[0]} on sim:"
                )
    return differ


def around(link: Link, access: Access, way_s: float) -> list[Outcome]:
    """Return what a read gives a little before its time, then, and a little later."""
    given = []
    for later_s in (-way_s, 0.0, way_s):
        to(link, access.time_s + later_s)
        given.append(access.on(link))
    return given


def to(link: Link, time_s: float) -> None:
    """Step to a time, if it is not over."""
    if link.board.time_s < time_s:
        link.step(time_s - link.board.time_s)


def between(given: Sequence[Outcome], there: Outcome, slack: int = 0) -> bool:
    """Return whether a word is one of those given, counts between them, or misses them by `slack`.

    >>> between([7, 9], 8), between([7, 9], 6), between([7, 9], 6, 1), between(["BusError", 0], 0)
    (True, False, True, True)
    """
    if there in given or isinstance(there, str):
        return there in given
    words = [word for word in given if isinstance(word, int)]
    return len(words) == len(given) and min(words) - slack <= there <= max(words) + slack


def main() -> None:
    """Play robots until one is not the same on both boards."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seed", type=int, default=1, help="of the first robot")
    parser.add_argument("--count", type=int, default=10, help="how many robots")
    options = parser.parse_args()
    for seed in range(options.seed, options.seed + options.count):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "robot.ul"
            file.write_text(robot_text(random.Random(seed)), "utf-8")
            differ = differences(file, *play(file, seed))
            print(f"seed {seed}: {'equal' if not differ else f'{len(differ)} differences'}", flush=True)
            if differ:
                raise SystemExit("\n".join([file.read_text("utf-8"), *differ[:10]]))


if __name__ == "__main__":
    main()
