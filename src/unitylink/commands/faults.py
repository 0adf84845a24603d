# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink faults`: the real engine, a bad wire and the virtual device, on a clock of their own."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import click

from .checkout import need_checkout
from .output import json_option, print_json, print_table

RUN_MESSAGES = 20_000  # for one history; more messages make more histories, so that all of them begin and end
_COUNTED = ("messages", "faults", "good", "failed", "unknown", "retries", "resets", "undetected")


@dataclass(frozen=True)
class History:
    """One run of the simulation: the same fields give the same history."""

    seed: int
    messages: int
    profile: str
    protocol: str
    clients: int
    window: int

    def command(self) -> str:
        """Return the command line that repeats it."""
        return (
            f"unitylink faults --seed {self.seed} --messages {self.messages} --profile {self.profile} "
            f"--protocol {self.protocol} --clients {self.clients} --window {self.window}"
        )

    def run(self) -> dict[str, Any]:
        from unitylink import _native

        framed = self.protocol == "framed"
        return _native.run_faults(self.seed, self.messages, self.profile, framed, self.clients, self.window)


@dataclass
class Result:
    """The settings that all histories of a profile share."""

    counts: Counter[str] = field(default_factory=Counter)
    failures: list[tuple[History, list[str]]] = field(default_factory=list)

    def add(self, history: History, report: dict[str, Any]) -> None:
        for name in _COUNTED:
            self.counts[name] += report[name]
        if report["violations"]:
            self.failures.append((history, report["violations"]))

    @property
    def violations(self) -> int:
        return sum(len(texts) for _, texts in self.failures)


def histories(whole: History) -> Iterator[History]:
    """Cut a history that is too long into several, with consecutive seeds."""
    for index, begun in enumerate(range(0, whole.messages, RUN_MESSAGES)):
        size = min(RUN_MESSAGES, whole.messages - begun)
        yield replace(whole, seed=whole.seed + index, messages=size)


def _profiles(_: click.Context, __: click.Parameter, value: str) -> tuple[str, ...]:
    from unitylink import _native

    known = [name for name, _ in _native.fault_profiles()]
    if value == "all":
        return tuple(known)
    if value not in known:
        raise click.BadParameter(f"there is no {value!r}; there are: all, {', '.join(known)}")
    return (value,)


def _beside_litex(as_json: bool) -> int:
    """Run both. Fail if our link did worse than allowed."""
    need_checkout("--beside")
    from unitylink_lab.bench.figure import Run
    from unitylink_lab.bench.programs import find_checkout
    from unitylink_lab.experiments import markdown
    from unitylink_lab.experiments.peer_faults import beside, section

    results = beside(Run(False, find_checkout(), lambda text: click.echo(text, err=True)))
    if as_json:
        print_json(results)
    else:
        click.echo(markdown(section(results)), nl=False)
    return int(any(row["ours"]["bad"] for row in results["rows"]))


@click.command()
@click.option(
    "--seed",
    default=1,
    show_default=True,
    help="Seed of the histories. The same seed gives the same histories.",
)
@click.option(
    "--messages", default=100_000, show_default=True, type=click.IntRange(1), help="Messages in all."
)
@click.option(
    "--profile", "chosen", default="all", show_default=True, callback=_profiles, help="Which faults."
)
@click.option("--protocol", default="framed", show_default=True, type=click.Choice(("framed", "classic")))
@click.option(
    "--clients", default=16, show_default=True, type=click.IntRange(1, 200), help="Users of the link."
)
@click.option(
    "--window", default="32", show_default=True, type=click.Choice(("1", "8", "32", "64", "128")),
    help="Requests in flight.",
)  # fmt: skip
@click.option(
    "--jobs",
    default=1,
    show_default=True,
    type=click.IntRange(1, 64),
    help="Histories that run at the same time.",
)
@click.option(
    "--beside", type=click.Choice(("litex",)),
    help="Try the released package of another system and ours on the same faults instead (90 s).",
)  # fmt: skip
@json_option("the counts")
def command(
    chosen: tuple[str, ...], messages: int, jobs: int, beside: str | None, as_json: bool, **options: Any
) -> int:
    """Try the engine on a wire that does everything wrong.

    Each value is written once. The device's own record shows what it has executed. Nothing may be executed
    twice. Nothing may be reported as done that is not, or come in another order. No request may get the reply
    to another one. Each operation must end in its time. After the faults, everything must work again. A
    history that fails is printed with the command that repeats it.

    \b
    Profiles: quiet flips bursts bytes loss messages late datagrams pauses resets relapses restarts dead
    half-dead closing renewing refusing mixed; all of them in turn.

    \b
    Examples:
      unitylink faults
      unitylink faults --profile resets --messages 1000000 --jobs 2
      unitylink faults --protocol classic --profile bursts
      unitylink faults --beside litex
    """
    if beside:
        return _beside_litex(as_json)
    share = -(-messages // len(chosen))
    options["window"] = int(options["window"])
    whole = (History(profile=profile, messages=share, **options) for profile in chosen)
    wanted = [history for each in whole for history in histories(each)]
    results = {profile: Result() for profile in chosen}
    bar = click.progressbar(length=len(wanted), label="histories", file=sys.stderr)
    with ThreadPoolExecutor(jobs) as pool, bar:
        for history, report in zip(wanted, pool.map(History.run, wanted), strict=True):
            results[history.profile].add(history, report)
            bar.update(1)
    total: Counter[str] = sum((result.counts for result in results.values()), Counter())
    violations = sum(result.violations for result in results.values())
    if as_json:
        print_json(
            {
                "profiles": {name: dict(result.counts) for name, result in results.items()},
                "failures": [
                    {"history": asdict(history), "violations": texts}
                    for result in results.values()
                    for history, texts in result.failures
                ],
            }
        )
        return int(violations > 0)
    rows = [
        [name, *(f"{result.counts[column]:,}" for column in _COUNTED), f"{result.violations:,}"]
        for name, result in results.items()
    ]
    print_table(["profile", *_COUNTED, "violations"], rows, right=range(1, len(_COUNTED) + 2))
    for result in results.values():
        for history, texts in result.failures:
            click.echo(f"\n{history.command()}")
            for text in texts[:5]:
                click.echo(f"  {text}")
    click.echo(f"{total['messages']:,} messages, {total['faults']:,} faults, {violations:,} violations")
    return int(violations > 0)
