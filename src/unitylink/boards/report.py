# SPDX-License-Identifier: BSD-3-Clause
"""The result of a build: area, clock, pins, the limits of the link. As JSON, and as text for people."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from unitylink.errors import BoardError
from unitylink.spec.isochrony.budget import DeviceBudget

NAME = "report"


@dataclass(frozen=True)
class Area:
    """The design takes `used` cells of one kind, and the chip has `available` of them."""

    what: str
    used: int
    available: int


@dataclass(frozen=True)
class Report:
    """`fmax_hz` is nextpnr's guarantee for the design's clock, `clock_hz` is its rate.

    `seed` and `placer` are the options with which nextpnr met it.

    `words` says for each bit of a port that is one of a word: (address, bit).
    """

    spec: str
    hash: str
    protocol: str
    board: str
    title: str
    top: str
    clock_hz: int
    fmax_hz: int
    seed: int
    placer: str
    area: tuple[Area, ...]
    baud_hz: int
    url: str
    pins: Mapping[str, str]
    words: Mapping[str, tuple[int, int]]
    notices: tuple[str, ...]
    bitstream: str
    budget: tuple[Mapping[str, Any], ...]
    tools: tuple[str, ...]
    seconds: float

    def write(self, folder: Path) -> None:
        """Write report.json and report.txt."""
        (folder / f"{NAME}.json").write_text(json.dumps(asdict(self), indent=1) + "\n", encoding="utf-8")
        (folder / f"{NAME}.txt").write_text(self.text() + "\n", encoding="utf-8")

    def text(self) -> str:
        """Return the report for people."""
        lines = [f"{self.spec} on {self.title}", f"  bitstream   {self.bitstream}"]
        slack = self.fmax_hz / self.clock_hz - 1
        lines.append(
            f"  clock       {_mhz(self.clock_hz)}; the design reaches {_mhz(self.fmax_hz)} "
            f"({slack:+.0%}), seed {self.seed}, placer {self.placer}"
        )
        for area in self.area:
            share = f"{area.used / area.available:.0%}" if area.available else "-"
            lines.append(f"  {area.what:<12}{area.used} of {area.available} ({share})")
        lines.append(f"  link        {self.url}")
        for device in self.budget:
            load = f", {device['load']:.1%} of the line" if device["load"] else ""
            spoken = f"{device['root']}, {device['protocol']}"
            lines.append(f"  publishes   {spoken}: {device['bytes_per_s']:,.0f} bytes a second{load}")
            for group in device["groups"]:
                late = group["latency_s"]
                when = f"sent within {late * 1e6:.0f} us" if late is not None else "no bound known"
                lines.append(f"              {group['name']}: {group['words']} words, {when}")
        lines.append("  pins")
        width = max((len(port) for port in self.pins), default=0)
        lines += [f"    {port:<{width}}  {pin}" for port, pin in self.pins.items()]
        lines += [f"  note: {notice}" for notice in self.notices]
        return "\n".join(lines)


def budget_of(one: DeviceBudget) -> dict[str, Any]:
    """Return the part of a budget that a report shows."""
    groups = [
        {
            "name": g.name,
            "words": g.words,
            "rate_hz": g.rate_hz,
            "sampled_s": g.sampled_s,
            "latency_s": g.latency_s,
        }
        for g in one.groups
    ]
    return {
        "root": one.root,
        "protocol": one.protocol,
        "clock_hz": one.clock_hz,
        "baud_hz": one.baud_hz,
        "bytes_per_s": one.bytes_per_s,
        "load": one.load,
        "highest_hz": next((baud.highest_hz for baud in one.bauds if baud.baud_hz == one.baud_hz), None),
        "groups": groups,
    }


def forget(folder: Path, bitstream: str) -> None:
    """Remove the results of an earlier build, so that after a failure nothing is there to flash."""
    for name in (f"{NAME}.json", f"{NAME}.txt", bitstream):
        (folder / name).unlink(missing_ok=True)


def read_report(folder: Path) -> dict[str, Any]:
    """Return report.json of a folder that `unitylink build` made. Raises BoardError."""
    path = folder / f"{NAME}.json"
    try:
        report = json.loads(path.read_text(encoding="utf-8"))
        if (
            isinstance(report, dict)
            and isinstance(report["board"], str)
            and isinstance(report["bitstream"], str)
        ):
            return report
    except (OSError, ValueError, KeyError, RecursionError):
        pass
    raise BoardError(
        f"{folder} has no finished build of `unitylink build SPEC --board NAME`: {path} is not its report"
    )


def _mhz(hz: int) -> str:
    return f"{hz / 1e6:.6g} MHz" if hz % 1000 == 0 else f"{hz / 1e6:.2f} MHz"
