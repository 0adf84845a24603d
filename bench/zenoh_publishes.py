# SPDX-License-Identifier: BSD-3-Clause
"""What a publish costs on its way from a board to Zenoh, beside a bare publisher, through the same router.

    python bench/zenoh_publishes.py [--seconds 4] [--pairs 21]

The bare publisher has its messages ready: different ones of the same size, with the same settings and the
same reader. Ours takes the publishes of a virtual board out of the link's ring, makes the messages, and puts
them. A pair is a round of the one and a round of the other right after it. They take turns in being first.
The board stands still while the clocks of a round run, and advances between its bursts, for both. What wakes
the thread that looks for publishes is not in it.
"""

from __future__ import annotations

import argparse
import os
import statistics
import struct
import tempfile
import time
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

import zenoh
from processes import Processes, free_port, router_program

from unitylink import connect
from unitylink.spec import load
from unitylink.zenoh.bridge.groups import Group
from unitylink.zenoh.bridge.topics import typed_output
from unitylink.zenoh.schema import fields_of
from unitylink.zenoh.session import Network

VALUES = 18
FLOOD = 4000  # nearly what the ring of a link keeps
TICK_NS = 1_000_000
HEAD = struct.Struct("<Iq")
SPEC = (
    "public fast() {\n"
    + "\n".join(
        f'   @v{n} = {0x10 + n:#x}: i32 READ(UNIT="rad", SCALE=0.001, PUBLISH(1000 Hz));'
        for n in range(VALUES)
    )
    + "\n}\n"
)
READER = """
import sys, time
from unitylink.zenoh.session import Network
with Network(connect=sys.argv[1]).opened() as session:
    taken = session.declare_subscriber("bench/*", lambda sample: None)
    print("there", flush=True)
    time.sleep(3600)
"""
Act = Callable[[], object]


@dataclass
class Cost:
    """What a round took, in ns for each publish: the clock, the thread that puts, the process."""

    wall: float
    thread: float
    process: float


def cost(prepare: Act, act: Act, burst: int, seconds: float) -> Cost:
    """Return what the bursts of a round took, with no time of `prepare` and of the clocks."""
    spent, count, end = [0, 0, 0], 0, time.perf_counter() + seconds
    while time.perf_counter() < end or not count:
        prepare()
        process, thread, wall = time.process_time_ns(), time.thread_time_ns(), time.perf_counter_ns()
        act()
        wall, thread = time.perf_counter_ns() - wall, time.thread_time_ns() - thread
        for place, ns in enumerate((wall, thread, time.process_time_ns() - process)):
            spent[place] += ns
        count += burst
    return Cost(*(ns / count for ns in spent))


def nothing() -> None:
    """What takes as long as the clocks alone."""


class Board:
    """A virtual board whose time goes in steps, and its publishes in the ring of a link."""

    def __init__(self, stack: ExitStack, spec: Path) -> None:
        self.link = stack.enter_context(connect(f"sim:{spec}", time="lockstep"))
        self.fields = list(fields_of(load(spec), self.link.configuration.data_bits).values())
        self.addresses = tuple(element.address for _, element in load(spec).walk())

    def advance(self, ticks: int) -> None:
        """Let so many publishes come."""
        native = self.link._native
        native.pass_until(native.now_ns + ticks * TICK_NS)


def compare(
    board: Board, session: zenoh.Session, key: str, *, typed: bool, burst: int, pairs: int, seconds: float
) -> str:
    """Return a row: bare and ours, in pairs of rounds that take turns in being first.

    `burst` is how many publishes have come when somebody looks.
    """
    blocks = zenoh.CongestionControl.BLOCK  # so that all messages go their whole way, and none is dropped
    bare, publisher = (
        session.declare_publisher(f"{key}/{name}", congestion_control=blocks) for name in ("bare", "ours")
    )
    group = Group((board.addresses, 1, False, None), publisher)
    output = typed_output(publisher.put, board.fields) if typed else None
    group.add(0 if typed else 1, output)
    group.start(board.link, verify=True)
    subscription = group.subscription
    assert subscription is not None
    size = output.row_bytes if output else 4 * VALUES
    messages = [HEAD.pack(number, time.monotonic_ns()) + os.urandom(size) for number in range(FLOOD)]
    put, place, ready = bare.put, 0, messages[:burst]

    def fresh() -> None:
        board.advance(burst)

    def discarded() -> None:
        nonlocal place, ready
        board.advance(burst)
        subscription.drain()
        place = (place + burst) % FLOOD
        ready = messages[place : place + burst]

    def puts() -> None:  # as a program would
        for message in ready:
            put(message)

    sides: dict[str, tuple[Act, Act]] = {
        "bare": (discarded, puts),
        "ours": (fresh, subscription.deliver),
    }
    clocks = cost(nothing, nothing, burst, min(seconds / pairs, 0.1))
    rounds: dict[str, list[Cost]] = {"bare": [], "ours": []}
    discarded()
    puts()
    fresh()
    subscription.deliver()
    for pair in range(pairs):
        for name in ("bare", "ours") if pair % 2 else ("ours", "bare"):
            before = group.published
            one = cost(*sides[name], burst, seconds / pairs / 2)
            rounds[name].append(
                Cost(one.wall - clocks.wall, one.thread - clocks.thread, one.process - clocks.process)
            )
            if (group.published > before) != (name == "ours"):
                raise SystemExit("the board did not publish")
    group.stop()
    bare.undeclare()
    told = []
    # for a single publish, what the clocks of the processor take is more than what they measure
    for name in ("wall", "thread", "process") if burst > 1 else ("wall",):
        both = [[getattr(one, name) for one in rounds[side]] for side in ("bare", "ours")]
        ratios = [plain / mine for plain, mine in zip(*both, strict=True)]
        low, middle, high = statistics.quantiles(ratios, n=4)
        plain, mine = (statistics.median(some) for some in both)
        told.append(f"{name} {plain:7,.0f} {mine:7,.0f} ns {middle:.2f} ({low:.2f}-{high:.2f})")
    return f"{'topic' if typed else 'words'} by {burst:>4}: " + ", ".join(told)


def publishes(router: str, programs: Processes, seconds: float, pairs: int) -> None:
    """Print what publishes cost without a reader, and with one."""
    print(f"publishes of {VALUES} values: bare, ours, bare / ours (quartiles of {pairs} pairs)")
    programs.start("-c", READER, router)
    with tempfile.TemporaryDirectory() as folder, ExitStack() as stack:
        file = Path(folder) / "fast.ul"
        file.write_text(SPEC)
        session = stack.enter_context(Network(connect=router).opened())
        board = Board(stack, file)
        for key, name in (("alone", "nobody reads"), ("bench", "one reads")):
            for typed, burst in ((False, 1), (False, 20), (False, FLOOD), (True, 1), (True, 20)):
                row = compare(board, session, key, typed=typed, burst=burst, pairs=pairs, seconds=seconds)
                print(f"{name}, {row}", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--seconds", type=float, default=4.0, help="of each row")
    parser.add_argument("--pairs", type=int, default=21)
    options = parser.parse_args()
    router = f"tcp/127.0.0.1:{free_port()}"
    with ExitStack() as stack:
        programs = Processes(stack)
        programs.start(*router_program(router))
        publishes(router, programs, options.seconds, options.pairs)
    print(f"load of the machine {os.getloadavg()[0]:.1f}")


if __name__ == "__main__":
    main()
