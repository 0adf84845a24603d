# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink fleet record`: all robots of a fleet into one recording."""

from __future__ import annotations

import queue
import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import click

from unitylink.errors import UnityLinkError

from .fleet_run import as_option, fleet_argument
from .output import force_option, json_option, print_json
from .sampling_options import duration_option, rate_option

if TYPE_CHECKING:
    from unitylink.fleet.description import Fleet, FleetRobot
    from unitylink.recording import Sample, Writer

    from .link_option import Target
    from .sampler import Sampler

_GATHER_S = 0.02  # samples within this time are written together, which halves the cost
_HOLD_S = 1.0  # samples of one robot wait for so long, for the order of their times
_HOLD_ALL_S = 1.5  # those of all robots, which have waited for their own order before
_PAUSE_S = 1.0  # between two attempts to reach a robot
_FLUSH_S = 0.5
_TICK_S = 0.1


@dataclass
class Heard:
    """What the threads of the robots hand to the one that writes.

    The clock of the machine is looked at once. So if it is set meanwhile, no sample loses its place.
    """

    stop: threading.Event
    since_1970_s: float = field(default_factory=lambda: time.time() - time.monotonic())
    samples: queue.SimpleQueue[Sample] = field(default_factory=queue.SimpleQueue)
    topics: dict[tuple[str, ...], str] = field(default_factory=dict)

    def now_s(self) -> float:
        """Return the time of the recording, in s since 1970."""
        return self.since_1970_s + time.monotonic()


class RobotTaker(threading.Thread):
    """Takes the samples of one robot until `stop`. It waits for a robot that is away, and says so."""

    def __init__(self, fleet: Fleet, robot: FleetRobot, rate_hz: float, heard: Heard, who: str) -> None:
        super().__init__(name=f"record {robot.name}", daemon=True)
        self.robot, self.taken, self.lost = robot, 0, 0
        self._rate_hz, self._heard, self._fleet = rate_hz, heard, fleet.name
        self._url = fleet.url(robot, who=who, name="record")
        self._said = ""

    def run(self) -> None:
        """Take samples, again after each end of the link."""
        from .link_option import open_target
        from .sampler import Sampler
        from .sampling_options import sampled_items

        while not self._heard.stop.is_set():
            try:
                with open_target(self._url, None) as target:
                    items = sampled_items(target, (), "record")
                    sampler = Sampler(target.link, items, self._rate_hz, gather_s=_GATHER_S, hold_s=_HOLD_S)
                    self._take(target, sampler)
            except (UnityLinkError, click.ClickException) as error:
                self._say(error.format_message() if isinstance(error, click.ClickException) else str(error))
                self._heard.stop.wait(_PAUSE_S)

    def _take(self, target: Target, sampler: Sampler) -> None:
        from unitylink.layer4_data.topics import topics_of
        from unitylink.recording import Sample
        from unitylink.values import plain

        from .record import NOT_PLAIN

        items = target.names.all()
        texts = {item.name: item.quantity for item in items if item.quantity.type.kind in NOT_PLAIN}
        publishes = {item.name: item.element.publish for item in items if item.element is not None}
        since_1970_s = self._heard.now_s() - target.link.now_s()
        name = self.robot.name
        try:
            with sampler:
                named = topics_of(f"{self._fleet}/{name}", publishes, sampler.publisher.reports())
                self._heard.topics |= {
                    tuple(f"{name}.{path}" for path in paths): topic for paths, topic in named.items()
                }
                self._said = ""
                for sampled in sampler.samples():
                    if sampled is not None:
                        time_s, values, numbers = sampled
                        row = {
                            f"{name}.{value.path}": plain(number, texts[value.path])
                            if value.path in texts
                            else number
                            for value, number in zip(values, numbers, strict=True)
                        }
                        self._heard.samples.put(Sample(since_1970_s + time_s, row))
                        self.taken += 1
                    if self._heard.stop.is_set():
                        return
        finally:
            self.lost += sampler.lost

    def _say(self, text: str) -> None:
        if text != self._said and not self._heard.stop.is_set():
            self._said = text
            click.echo(f"{self.robot.name}: {text}; it is tried again", err=True)


@click.command(short_help="Record all robots into one file.")
@fleet_argument
@click.option("--out", metavar="FILE.mcap", help="By default the fleet's name and the time.")
@force_option
@rate_option
@duration_option
@as_option
@json_option("the result at the end")
def record(
    file: str,
    *,
    out: str | None,
    force: bool,
    rate_hz: float,
    duration_s: float | None,
    who: str,
    as_json: bool,
) -> None:
    """Record all robots of a fleet into one MCAP file, until Ctrl-C.

    What is published comes at its own rate, other READ items at --rate. Items have the name of the robot
    before their own: arm1.j1.cpos. All times are by the clock of this machine. A robot that is away is waited
    for. If samples were lost, or a robot never came, the exit code is 1.

    \b
    Examples:
      unitylink fleet record fleet.toml --duration 60
      unitylink plot lab.mcap arm1.x.position arm2.x.position
    """
    from unitylink.fleet.reader import read_fleet
    from unitylink.output_file import check_output
    from unitylink.program import stopped_by_signals
    from unitylink.recording import Origin, check_name, create

    fleet = read_fleet(file)
    path = out or f"{fleet.name.replace('/', '-')}-{time.strftime('%Y%m%d-%H%M%S')}.mcap"
    if not path.endswith(".mcap"):
        raise click.UsageError(f"--out {path}: several robots need a file that ends in .mcap")
    check_name(path)
    check_output(path, force=force)
    with stopped_by_signals() as stop:
        heard = Heard(stop)
        takers = [RobotTaker(fleet, robot, rate_hz, heard, who) for robot in fleet.robots]
        with create(path, Origin(), topics=heard.topics, force=force) as writer:
            for taker in takers:
                taker.start()
            late = _write(heard, writer, duration_s, takers)
    lost = late + sum(taker.lost for taker in takers)
    counts = {taker.robot.name: taker.taken for taker in takers}
    result = {
        "file": path,
        "samples": writer.count,
        "lost": lost,
        "bytes": writer.size_bytes,
        "robots": counts,
    }
    if as_json:
        print_json(result)
    else:
        click.echo(f"{path}: {writer.count:,} samples, {writer.size_bytes:,} bytes, {lost} lost")
        for name in (name for name, count in counts.items() if not count):
            click.echo(f"{name}: nothing came")
    click.get_current_context().exit(1 if lost or not all(counts.values()) else 0)


def _write(heard: Heard, writer: Writer, duration_s: float | None, takers: Sequence[RobotTaker]) -> int:
    """Write what comes, in the order of the times, until it is over. Return how many came too late."""
    from unitylink.recording.reorder_buffer import ReorderBuffer

    held: ReorderBuffer[Sample] = ReorderBuffer(_HOLD_ALL_S)
    late, flushed_s = 0, time.monotonic()
    end_s = time.monotonic() + duration_s if duration_s is not None else float("inf")
    while True:
        now_s = time.monotonic()
        if now_s >= end_s:
            heard.stop.set()
        over = heard.stop.is_set() and not any(taker.is_alive() for taker in takers)
        try:
            sample = heard.samples.get(block=not over, timeout=_TICK_S)
            late += not held.put(sample.time_s, sample)
        except queue.Empty:
            if over:
                break
        while (sample_due := held.take(heard.now_s())) is not None:
            writer.add(sample_due)
        if now_s - flushed_s > _FLUSH_S:
            flushed_s = now_s
            writer.flush()
    while (last := held.take_last()) is not None:
        writer.add(last)
    return late
