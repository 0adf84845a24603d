# SPDX-License-Identifier: BSD-3-Clause
"""Replay recorded exchanges of the 2012 gateware against the twin or gateware, on the device's clock."""

from __future__ import annotations

import json
from dataclasses import dataclass
from importlib.resources import files
from itertools import groupby
from pathlib import Path
from typing import Any

from .bench import CLOCKS_MOST, RULES, STEPS, Player, RecordingError, bench, play_on_twin, same

_STATUSES = ("required", "defect", "optional")


@dataclass(frozen=True)
class Exchange:
    """One exchange and its result.

    `expected` is the right response. `recorded` is what the 2012 gateware sent.
    """

    run: int
    name: str
    status: str
    compare: str
    request: str
    recorded: str
    expected: str
    reason: str
    got: str
    passed: bool


@dataclass(frozen=True)
class Report:
    """The outcome of a replay. `passed` and `failed` count required exchanges only."""

    path: str
    exchanges: tuple[Exchange, ...]

    def count(self, status: str, passed: bool) -> int:
        return sum(e.status == status and e.passed == passed for e in self.exchanges)

    @property
    def passed(self) -> int:
        return self.count("required", True)

    @property
    def failed(self) -> int:
        return self.count("required", False)

    @property
    def ok(self) -> bool:
        """Whether all required exchanges are equal and all defects are answered correctly."""
        return self.failed == 0 and self.count("defect", False) == 0


def replay(path: str | Path, player: Player = play_on_twin) -> Report:
    """Let `player` replay every run of the recordings in `path` from reset, and return the results.

    Raises RecordingError if the file cannot be read or does not hold recordings.
    """
    document = _load(Path(path))
    right = json.loads((files(__package__) / "right.json").read_text(encoding="utf-8"))
    exchanges: list[Exchange] = []
    for position, run in enumerate(document):
        exchanges += _replay_run(run, f"runs[{position}]", right, player)
    if not any(exchange.status == "required" for exchange in exchanges):
        raise RecordingError(f"{path}: no required exchange in it; a replay would prove nothing")
    return Report(str(path), tuple(exchanges))


def _load(path: Path) -> list[Any]:
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise RecordingError(f"{path}: {error.strerror}") from error
    except (ValueError, RecursionError) as error:
        raise RecordingError(f"{path}: not JSON: {error}") from error
    if not isinstance(document, dict) or not isinstance(document.get("runs"), list):
        raise RecordingError(f'{path}: not a set of recordings: an object with a list "runs" is expected')
    runs: list[Any] = document["runs"]
    return runs


def _replay_run(run: Any, place: str, right: dict[str, dict[str, str]], player: Player) -> list[Exchange]:
    if (
        not isinstance(run, dict)
        or type(run.get("run")) is not int
        or not isinstance(run.get("exchanges"), list)
    ):
        raise RecordingError(f'{place}: a run has a number "run" and a list "exchanges"')
    for position, exchange in enumerate(run["exchanges"]):
        _check(exchange, f"{place}.exchanges[{position}]")
    configuration = bench(run.get("config", {}), place)
    answers = player(configuration, [exchange["steps"] for exchange in run["exchanges"]])
    results = []
    for position, (exchange, answer) in enumerate(zip(run["exchanges"], answers, strict=True)):
        where = f"{place}.exchanges[{position}]"
        request = [
            repr(argument) if kind == "send" else f"{kind} {argument}" for kind, argument in exchange["steps"]
        ]
        got = answer.decode("latin-1")
        recorded, status = exchange["response"], exchange["status"]
        expected, reason = recorded, ""
        if status == "defect":
            known = right.get(f"{run['run']}/{exchange['name']}")
            if known is None:
                raise RecordingError(
                    f"{where}: the right answer instead of the defect {exchange['name']!r} is not known"
                )
            expected, reason = known["right"], known["reason"]
        passed = same(exchange["compare"], expected, got)
        results.append(
            Exchange(
                run["run"],
                exchange["name"],
                status,
                exchange["compare"],
                ", ".join(request),
                recorded,
                expected,
                reason,
                got,
                passed,
            )
        )
    return results


def _check(exchange: Any, where: str) -> None:
    if not isinstance(exchange, dict):
        raise RecordingError(f"{where}: an exchange is an object")
    for key, allowed in (("status", _STATUSES), ("compare", RULES)):
        if exchange.get(key) not in allowed:
            raise RecordingError(
                f"{where}: {key} is {exchange.get(key)!r}; one of {', '.join(allowed)} is expected"
            )
    for key in ("name", "response"):
        if not isinstance(exchange.get(key), str):
            raise RecordingError(f"{where}: {key} is missing or not a text")
    if not isinstance(exchange.get("steps"), list) or not exchange["steps"]:
        raise RecordingError(f"{where}: steps are missing")
    for step in exchange["steps"]:
        if not isinstance(step, list) or len(step) != 2 or step[0] not in STEPS:
            raise RecordingError(f"{where}: step {step!r}; [{'|'.join(STEPS)}, argument] is expected")
        kind, argument = step
        if kind == "send" and isinstance(argument, str) and all(ord(c) < 256 for c in argument):
            continue
        if kind != "send" and type(argument) is int and 0 <= argument <= CLOCKS_MOST:
            continue
        raise RecordingError(f"{where}: step {step!r} has an argument that {kind!r} cannot have")


def render(report: Report) -> None:
    """Print a table of the runs, then the differences. The last line is the result."""
    from rich.console import Console

    from unitylink.commands.output import print_table

    rows = []
    for run, group in groupby(report.exchanges, key=lambda exchange: exchange.run):
        exchanges = list(group)
        cells = [str(run)]
        for status in _STATUSES:
            of = [exchange for exchange in exchanges if exchange.status == status]
            cells.append(f"{sum(exchange.passed for exchange in of)}/{len(of)}" if of else "-")
        rows.append(cells)
    print_table(("run", "required equal", "defects right", "optional equal"), rows, right=(0, 1, 2, 3))
    console = Console(highlight=False, soft_wrap=True)
    for exchange in report.exchanges:
        if not exchange.passed and exchange.status != "optional":
            console.print(
                f"\nrun {exchange.run}, {exchange.name} ({exchange.status}, {exchange.compare})",
                style="bold red",
                markup=False,
            )
            for line in difference(exchange):
                console.print(f"  {line}", markup=False)
    absent = [f"{e.run}/{e.name}" for e in report.exchanges if e.status == "optional" and not e.passed]
    console.print()
    defects = report.count("defect", True)
    console.print(
        f"defects of the 2012 gateware answered correctly: "
        f"{defects}/{defects + report.count('defect', False)}"
    )
    optional = report.count("optional", True)
    missing = f" (different: {', '.join(absent)})" if absent else ""
    console.print(f"optional: {optional}/{optional + len(absent)} equal{missing}", markup=False)
    console.print(f"{report.passed} passed, {report.failed} failed")


def difference(exchange: Exchange) -> list[str]:
    """Return lines with the request, the right reply, the received reply, and their first difference."""
    part = next(
        (i for i, (a, b) in enumerate(zip(exchange.expected, exchange.got, strict=False)) if a != b), None
    )
    at = min(len(exchange.expected), len(exchange.got)) if part is None else part
    lines = [f"sent   {exchange.request}", f"right  {exchange.expected!r}", f"came   {exchange.got!r}"]
    if exchange.compare == "exact":
        indent = len(repr(exchange.expected[:at])) - 1
        lines.insert(2, " " * (7 + indent) + f"^ differs from byte {at}")
    if exchange.reason:
        lines.append(f"why    {exchange.reason}")
    return lines


def as_dict(report: Report) -> dict[str, Any]:
    """Return the report as plain data for JSON."""
    return {
        "path": report.path,
        "passed": report.passed,
        "failed": report.failed,
        "defects_right": report.count("defect", True),
        "defects_wrong": report.count("defect", False),
        "optional_equal": report.count("optional", True),
        "optional_different": report.count("optional", False),
        "exchanges": [vars(exchange) for exchange in report.exchanges],
    }
