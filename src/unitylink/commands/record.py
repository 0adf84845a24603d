# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink record`: items to a file."""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import click

from unitylink.errors import LinkError
from unitylink.output_file import check_output
from unitylink.program import ended_by_signals

from .lerobot_recording import record_episode
from .link_option import link_argument, open_target, spec_option
from .output import force_option, json_option, print_json
from .sampling_options import count_option, duration_option, rate_option, sampled_items
from .series import parts_of

if TYPE_CHECKING:
    from unitylink.recording import Origin, Writer

    from .names import Item, Names
    from .sampler import Sample as Sampled

_GATHER_S = 0.02  # samples within this time are written together, which halves the cost
_HOLD_S = 1.0  # samples are held back for so long, so that the file has them in the order of their times
NOT_PLAIN = ("enum", "bits", "float")  # kinds of types
_SHOW_S = 0.5  # s between two updates of the line
_FLUSH_S = 0.5  # s between two writes; a program that is killed loses at most so much


@click.command()
@link_argument
@click.argument("names", metavar="[NAME...]", nargs=-1)
@spec_option
@click.option("--out", metavar="FILE", help="FILE.mcap or FILE.csv. By default the spec's name and the time.")
@click.option(
    "--lerobot", metavar="DIR", help="Add an episode to a data set of LeRobot, --rate frames a second."
)
@click.option(
    "--camera",
    "cameras",
    metavar="NAME",
    multiple=True,
    help="A camera of a model of MuJoCo to record, too (--lerobot): NAME, or NAME:640x480. Repeatable.",
)
@click.option("--task", default="", metavar="TEXT", help="What the robot does in the episode (--lerobot).")
@force_option
@rate_option
@count_option
@duration_option
@json_option("the result at the end")
def command(
    link: str,
    *,
    names: tuple[str, ...],
    spec_file: str | None,
    out: str | None,
    lerobot: str | None,
    cameras: tuple[str, ...],
    task: str,
    force: bool,
    rate_hz: float,
    count: int | None,
    duration_s: float | None,
    as_json: bool,
) -> None:
    """Record items until Ctrl-C: MCAP for Foxglove and PlotJuggler, CSV for pandas and spreadsheets.

    Items with PUBLISH come at their own rate. The others are read at --rate. NAME is as for `read`. Without a
    NAME all READ items of the spec are recorded, and the set-points of the WRITE items. A sample has the time
    at which it came. Lost samples are counted. If there are any, the exit code is 1. The file is complete
    however the recording ends, except that kill -9 loses the last two seconds. An existing file is kept.

    \b
    Examples:
      unitylink record sim:arm.ul --out arm.mcap --duration 10
      unitylink record tcp://127.0.0.1:5555 '*.position' --spec arm.ul --out arm.csv
      unitylink replay arm.mcap --tcp 5555
      unitylink record tcp://127.0.0.1:5555 --spec arm.ul --lerobot data/arm --rate 50 --task "reach"
    """
    from unitylink.recording import Sample, check_name, create

    if lerobot is not None:
        if out is not None or force:
            raise click.UsageError("--lerobot has a folder of its own; leave out --out and --force")
        import unitylink.recording.lerobot_dataset  # noqa: F401  if pyarrow is absent, it says so here

        with ended_by_signals(), open_target(link, spec_file) as target:
            code = record_episode(
                target,
                names,
                lerobot,
                rate_hz=rate_hz,
                task=task or "recorded",
                count=count,
                duration_s=duration_s,
                as_json=as_json,
                cameras=cameras,
            )
        click.get_current_context().exit(code)
    if task or cameras:
        raise click.UsageError(f"--{'task' if task else 'camera'} is for --lerobot")
    # checked before the device is asked for anything
    check_name(out if out is not None else "recording.mcap")
    if out is not None:
        check_output(out, force=force)
    with ended_by_signals(), open_target(link, spec_file) as target:
        known = target.names
        items = sampled_items(target, names, "record", set_points=True)

        from unitylink.layer4_data.topics import topics_of
        from unitylink.values import plain

        from .sampler import Sampler

        robot = known.spec.name if known.spec else "recording"
        path = out or f"{robot}-{time.strftime('%Y%m%d-%H%M%S')}.mcap"
        since_1970_s = time.time() - target.link.now_s()
        began = time.monotonic()
        failed: LinkError | None = None
        sampler = Sampler(target.link, items, rate_hz, gather_s=_GATHER_S, hold_s=_HOLD_S)
        # Other types are written as their numbers.
        texts = {item.name: item.quantity for item in items if item.quantity.type.kind in NOT_PLAIN}
        publishes = {item.name: item.element.publish for item in items if item.element is not None}
        topics: dict[tuple[str, ...], str] = {}  # filled in when the sets of samples are known
        names_of = tuple(i.name for i in items)
        with create(path, _origin(known, items), names_of, topics=topics, force=force) as writer:

            def take(sampled: Sampled) -> None:
                time_s, values, numbers = sampled
                named = {value.path: number for value, number in zip(values, numbers, strict=True)}
                if texts:
                    named |= {path: plain(named[path], texts[path]) for path in texts.keys() & named.keys()}
                writer.add(Sample(since_1970_s + time_s, named))

            flushed_s = began
            progress = _Progress(writer, path, quiet=as_json)
            try:
                with sampler, suppress(KeyboardInterrupt):
                    topics |= topics_of(robot, publishes, sampler.publisher.reports())
                    for sample in sampler.samples(count, duration_s):
                        if sample is not None:
                            take(sample)
                        progress.show()
                        if time.monotonic() - flushed_s > _FLUSH_S:
                            flushed_s = time.monotonic()
                            writer.flush()
            except LinkError as error:
                failed = error  # raised after the contents of the file have been printed
            for sample in sampler.rest():
                take(sample)
            progress.end()
        took_s = time.monotonic() - began
    size = writer.size_bytes
    if as_json:
        result = {
            "file": path,
            "samples": writer.count,
            "lost": sampler.lost,
            "bytes": size,
            "duration_s": took_s,
        }
        print_json(result)
    else:
        click.echo(f"{path}: {writer.count:,} samples in {took_s:.1f} s, {size:,} bytes, {sampler.lost} lost")
    if failed is not None:
        raise failed
    click.get_current_context().exit(1 if sampler.lost else 0)


class _Progress:
    """A line on the terminal that shows how far the recording is."""

    def __init__(self, writer: Writer, path: str, *, quiet: bool) -> None:
        self.writer = writer
        self.path = path
        self.active = sys.stderr.isatty() and not quiet
        self.shown_s = self.began_s = time.monotonic()
        self.shown = False

    def show(self) -> None:
        now_s = time.monotonic()
        if self.active and now_s - self.shown_s > _SHOW_S:
            self.shown_s, self.shown = now_s, True
            count, size_kb = self.writer.count, self.writer.size_bytes / 1000
            elapsed_s = now_s - self.began_s
            rate_hz = count / elapsed_s
            line = f"{self.path}: {elapsed_s:.0f} s, {count:,} samples, {rate_hz:.0f}/s, {size_kb:,.0f} kB"
            click.echo(f"\r{line}  (Ctrl-C ends it)\x1b[K", nl=False, err=True)

    def end(self) -> None:
        """Clear the line, because the result follows."""
        if self.shown:
            click.echo("\r\x1b[K", nl=False, err=True)


def _origin(names: Names, items: Sequence[Item]) -> Origin:
    from unitylink.recording import Origin

    if names.spec is None:
        return Origin()
    text = Path(names.source).read_text(encoding="utf-8")
    parts = (part for item in items for part in parts_of(item.name, item.quantity.type, item.unit))
    units = {path: unit for path, unit, _ in parts if unit}
    return Origin(Path(names.source).name, text, names.spec.hash, units)
