# SPDX-License-Identifier: BSD-3-Clause
"""The known faults of LiteX's bridges, tried with LiteX's released package and with ours.

In each row, both sides meet the same fault of the same wire (`wire.py`) and are judged by the same rule.
`bad` means that a program can neither see the wrong result nor recover from it. `unitylink faults --beside
litex` runs it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from statistics import median
from typing import Any

from unitylink_lab.bench import litex
from unitylink_lab.bench.board import ADDRESS, FIRST_VALUE
from unitylink_lab.bench.figure import BenchError, Run
from unitylink_lab.bench.programs import Process
from unitylink_lab.bench.report import machine

from .document import Block, Code, Paragraph, Table
from .peers import Peer, Theirs, attempt, peer

SERIAL, UDP = "Unity-Link, framed", "Unity-Link, framed, UDP"
COMMAND = "unitylink faults --beside litex"
VALUE = 0x11223344
LATE_S = 5.0  # longer than the four seconds after which RemoteClient gives up
RETRY_S = 1.5  # longer than the second after which CommUDP repeats its request
SLOW_S = 0.02

NOT_RUN = {
    "two packets close together lock the board up (#1268, liteeth #86 #94)": "in the gateware",
    "a burst longer than the gateware's buffer (#683), 100 ms until it drops half a request": "in the "
    "gateware",
    "a write done twice when it is repeated (#1436)": "this release repeats no write; see the lost write",
    "reads are slow (#683)": "a figure, in [experiments](experiments.md)",
    "time-outs until the network is configured (#972), Etherbone with litex_sim (#924 #2031)": "no faults of "
    "a wire",
    "concurrent clients (wishbone-utils #38)": "another package",
}


@dataclass(frozen=True)
class Told:
    """The result of a fault on one side."""

    bad: bool
    text: str


Play = Callable[[Peer, Process], Told]


def _said(told: dict[str, Any]) -> str:
    """Describe the result of a read in a few words."""
    if told["outcome"] == "hangs":
        return f"hangs, {told['detail']}"
    what = {
        "right": "the right value",
        "wrong, unnoticed": f"{told['detail']}, no error",
        "error": told["detail"].partition(":")[0],
    }[told["outcome"]]
    return f"{what} ({told['time_s']:.1g} s)"


def _judged(*reads: tuple[str, dict[str, Any]]) -> Told:
    """Judge reads. A wrong value and an endless wait are bad, an error is not."""
    bad = any(told["outcome"] in ("wrong, unnoticed", "hangs") for _, told in reads)
    return Told(bad, "; ".join(f"{when}{_said(told)}" for when, told in reads))


def _other(one: Peer) -> None:
    """Continue as a second client if there is a server for it."""
    if isinstance(one, Theirs):
        one.obey("another")


def _settle(wire: Process, patience_s: float = 2.0) -> None:
    """Wait until the fault has hit its message."""
    if wire.ask(f"settle {patience_s}") != "ok":
        raise BenchError("the fault has met nothing")


def spoiled_read(fault: str) -> Play:
    """Return a scenario: a read whose answer meets `fault`."""

    def play(one: Peer, wire: Process) -> Told:
        wire.ask(fault)
        return _judged(("", attempt(one)))

    return play


def spoiled_write(fault: str) -> Play:
    """Return a scenario: a write meets `fault`, and then the word is read."""

    def play(one: Peer, wire: Process) -> Told:
        wire.ask(f"{fault} device")
        told = one.attempt(f"write {ADDRESS} {VALUE}")
        _settle(wire)
        there = one.attempt(f"read {ADDRESS}")
        if told != "done":
            return Told(False, told.partition(":")[0])
        if there == str(VALUE):
            return Told(False, "repeated until the word holds it")
        held = f"{int(there):#x}" if there.isdecimal() else there
        return Told(True, f"no error; the word holds {held} instead of {VALUE:#x}")

    return play


def frozen(one: Peer, wire: Process) -> Told:
    """Scenario: the device is silent for a while."""
    wire.ask("freeze")
    first = attempt(one)
    _other(one)
    second = attempt(one)
    wire.ask("thaw")
    return _judged(("", first), ("another: ", second), ("thawed: ", attempt(one)))


def late_answer(late_s: float) -> Play:
    """Return a scenario: an answer comes late, and reads of other words follow."""

    def play(one: Peer, wire: Process) -> Told:
        wire.ask(f"late {late_s}")
        first = attempt(one)
        second = attempt(one, ADDRESS + 1, FIRST_VALUE + ADDRESS + 1)
        _settle(wire, 2 * late_s)
        third = attempt(one, ADDRESS + 2, FIRST_VALUE + ADDRESS + 2)
        return _judged(("", first), ("the next word: ", second), ("the one after: ", third))

    return play


def long_loss(one: Peer, wire: Process) -> Told:
    """Scenario: during three reads everything is lost, and then nothing is."""
    wire.ask("freeze")
    for _ in range(3):
        attempt(one)
    wire.ask("thaw")
    _other(one)
    return _judged(("afterwards: ", attempt(one)))


def gone(one: Peer, wire: Process) -> Told:
    """Scenario: the other end of a client goes away. It is LiteX's server, or our port."""
    if isinstance(one, Theirs):
        one.obey("stop")
    else:
        wire.close()
    return _judged(("", attempt(one)), ("again: ", attempt(one)))


def slow_write(one: Peer, _: Process) -> Told:
    """Scenario: a write must be known to be done. With LiteX it has to be read back."""
    taken_s = median(one.series("write", 5)) * 1e-9
    return Told(taken_s > SLOW_S, f"{taken_s * 1e3:.2g} ms")


@dataclass(frozen=True)
class Fault:
    """One fault, LiteX's client that is known for it, and our link beside it."""

    name: str
    theirs: str
    ours: str
    play: Play

    def __str__(self) -> str:
        return self.name


_UART, _SERVER = "LiteX CommUART", "LiteX RemoteClient, litex_server"
_COMM_UDP, _SERVER_UDP = "LiteX CommUDP", "LiteX RemoteClient, litex_server, UDP"
FAULTS = (
    Fault("a bit of a write flips", _UART, SERIAL, spoiled_write("flip")),
    Fault("a bit of an answer flips", _UART, SERIAL, spoiled_read("flip")),
    Fault("a byte of an answer is lost", _UART, SERIAL, spoiled_read("cut")),
    Fault("a byte of an answer is lost, with a server", _SERVER, SERIAL, spoiled_read("cut")),
    Fault("a write is lost", _UART, SERIAL, spoiled_write("lose")),
    Fault("the device is frozen", _SERVER, SERIAL, frozen),
    Fault(f"an answer is {LATE_S:g} s late", _SERVER, SERIAL, late_answer(LATE_S)),
    Fault("the server, or the port, is gone (#1239)", _SERVER, SERIAL, gone),
    Fault("a write and its proof", _SERVER, SERIAL, slow_write),
    Fault("a write's datagram is lost", _COMM_UDP, UDP, spoiled_write("lose")),
    Fault("an answer's datagram is lost", _COMM_UDP, UDP, spoiled_read("lose")),
    Fault("an answer comes after it was asked for again (#1504)", _COMM_UDP, UDP, late_answer(RETRY_S)),
    Fault("everything is lost for a while (#1436 #1458)", _SERVER_UDP, UDP, long_loss),
)


def met(run: Run, client: str, fault: Fault) -> Told:
    """Let one client meet a fault."""
    with peer(run, client, spoiled=True) as (one, wire):
        assert wire is not None
        return fault.play(one, wire)


def beside(run: Run) -> dict[str, Any]:
    """Let both sides meet all faults."""
    rows = []
    for fault in FAULTS:
        run.say(f"faults: {fault.name}")
        sides = {}
        for side, client in (("theirs", fault.theirs), ("ours", fault.ours)):
            told = met(run, client, fault)
            sides[side] = {"client": client, "bad": told.bad, "text": told.text}
        rows.append({"fault": fault.name, **sides})
    return {"litex": litex.RELEASE, "machine": machine(), "rows": rows}


def section(results: dict[str, Any]) -> list[Block]:
    """Return this part of docs/faults.md, from the results alone."""
    shown = [row for row in results["rows"] if row["theirs"]["bad"]]
    absent = [row for row in results["rows"] if not row["theirs"]["bad"]]

    def cells(row: dict[str, Any]) -> list[str]:
        ours = ("**bad** " if row["ours"]["bad"] else "") + row["ours"]["text"]
        name = row["theirs"]["client"].removeprefix("LiteX ")
        return [row["fault"], name, row["theirs"]["text"], ours]

    headers = ["fault", "client of LiteX", "LiteX", "ours, framed"]
    return [
        Paragraph(
            f"LiteX's package {results['litex']} and ours met the same faults in one run. A process between "
            "client and device makes the faults: on a pty for UARTBone, in datagrams for Etherbone. Each "
            "side talks to a model of its own device that answers at once. Numbers with # are LiteX issues. "
            "`another` is a second client of litex_server. Ours has no server, so there it is a second read. "
            "The proof of a write is a read of the word with LiteX, and the device's reply with ours."
        ),
        Code(f"{COMMAND} --json > docs/faults-beside-litex.json && make docs"),
        Table(
            "Faults that the package does not handle, and what ours did.",
            headers,
            [cells(row) for row in shown],
        ),
        Table("Faults that the package handles.", headers, [cells(row) for row in absent]),
        Table(
            "Faults that LiteX's users have reported, and that no run of its package can show here.",
            ["fault", "why"],
            [[name, why] for name, why in NOT_RUN.items()],
        ),
    ]
