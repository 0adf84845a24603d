# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink plot`: items over time, as a picture or live in the terminal."""

from __future__ import annotations

import shutil
import sys
import time
from collections.abc import Iterable, Mapping
from contextlib import suppress
from fnmatch import fnmatchcase
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from unitylink.errors import LinkError

from .ended_by_signals import ended_by_signals
from .failure import Failure
from .link_option import is_link, open_target, spec_option
from .output import colours, terminal
from .sampled import duration_option, rate_option, sampled_items

if TYPE_CHECKING:
    from .sampler import Sampler

Series = dict[str, tuple[list[float], list[float]]]  # path -> times in s, values
_PICTURES = (".png", ".svg", ".pdf")
_REDRAW_S = 0.2
_WINDOW_S = 10.0  # what a live plot shows
_LINES_MOST = 8  # in one panel; more would hide each other
_COLOURS = ("cyan+", "orange+", "green+", "magenta+", "red+", "blue+", "white", "gray")  # of plotext


@click.command()
@click.argument("source", metavar="LINK|RECORDING")
@click.argument("names", metavar="[NAME...]", nargs=-1)
@spec_option
@click.option(
    "--out",
    metavar="FILE",
    help=f"A picture ({', '.join(_PICTURES)}); without it a terminal shows the plot live.",
)
@rate_option
@duration_option
def command(
    source: str,
    *,
    names: tuple[str, ...],
    spec_file: str | None,
    out: str | None,
    rate_hz: float,
    duration_s: float | None,
) -> None:
    """Draw items over time: from a LINK as they come, or from a recording.

    Values with the same unit share a panel.

    \b
    Examples:
      unitylink plot sim:arm.ul '*.position'
      unitylink plot sim:arm.ul '*.position' --duration 5 --out arm.png
      unitylink plot arm.mcap x.position --out x.svg
    """
    if out is not None and Path(out).suffix.lower() not in _PICTURES:
        raise click.UsageError(f"--out {out}: a picture ends in {', '.join(_PICTURES)}")
    if out is None and not terminal():
        raise Failure("the output is no terminal to draw on", "add --out FILE.png")
    if not is_link(source):
        series = _recorded(source, names)
        _draw(series, {}, Path(source).name, out)
        return
    with ended_by_signals(), open_target(source, spec_file, quiet=out is None) as target:
        found = sampled_items(target, names, "plot")
        from .sampler import Sampler

        series = {item.name: ([], []) for item in found}
        units = {item.name: item.unit for item in found}
        failed: LinkError | None = None
        try:
            with Sampler(target.link, found, rate_hz) as sampler, suppress(KeyboardInterrupt):
                _follow(sampler, series, source, out, duration_s)
        except LinkError as error:
            failed = error  # after what came until then has been drawn
        if out is not None and (failed is None or any(times for times, _ in series.values())):
            _draw(series, units, source, out)
        if failed is not None:
            raise failed


def _follow(sampler: Sampler, series: Series, source: str, out: str | None, duration_s: float | None) -> None:
    """Fill `series` with what comes; without `out` a terminal shows it meanwhile."""
    drawn_s = start_s = time.monotonic()
    for sample in sampler.samples(None, duration_s if duration_s or out is None else _WINDOW_S):
        if sample is not None:
            time_s, values, numbers = sample
            _take(series, time_s - start_s, {v.path: n for v, n in zip(values, numbers, strict=True)})
        if out is None and time.monotonic() - drawn_s > _REDRAW_S:
            drawn_s = time.monotonic()
            _forget(series, drawn_s - start_s - _WINDOW_S)
            _draw_terminal(series, source, clear=True)
    if out is None:
        _draw_terminal(series, source, clear=True)  # with what came since


def _take(series: Series, time_s: float, values: Mapping[str, Any]) -> None:
    for path, value in values.items():
        if path in series and isinstance(value, (int, float)):  # members of enumerations are ints
            times, numbers = series[path]
            times.append(time_s)
            numbers.append(float(value))


def _forget(series: Series, before_s: float) -> None:
    for times, numbers in series.values():
        old = sum(1 for time_s in times if time_s < before_s)
        del times[:old], numbers[:old]


def _recorded(path: str, patterns: Iterable[str]) -> Series:
    from unitylink.recording import RecordingTruncated, samples

    series: Series = {}
    wanted = tuple(patterns)
    first_s: float | None = None
    found = iter(samples(path))
    try:
        for sample in found:
            first_s = sample.time_s if first_s is None else first_s
            for name in sample.values:
                if name not in series and (not wanted or any(fnmatchcase(name, p) for p in wanted)):
                    series[name] = ([], [])
            _take(series, sample.time_s - first_s, sample.values)
    except RecordingTruncated as error:
        click.echo(f"note: {error}", err=True)
    if not any(times for times, _ in series.values()):
        raise Failure(
            f"{path} holds nothing that is called {', '.join(wanted)}" if wanted else f"{path} is empty"
        )
    return series


def _draw(series: Series, units: Mapping[str, str], title: str, out: str | None) -> None:
    if out is None:
        _draw_terminal(series, title, clear=False)
        return
    try:
        import matplotlib as mpl
    except ImportError:
        raise Failure("pictures need matplotlib", "pip install 'unitylink[plot]'") from None
    mpl.use("Agg")
    from matplotlib import pyplot

    panels: dict[tuple[str, int], list[str]] = {}
    counts: dict[str, int] = {}
    for name in series:
        unit = units.get(name, "")
        counts[unit] = counts.get(unit, 0) + 1
        panels.setdefault((unit, (counts[unit] - 1) // _LINES_MOST), []).append(name)
    figure, axes = pyplot.subplots(
        len(panels),
        1,
        sharex=True,
        squeeze=False,
        figsize=(10, 2.8 * len(panels) + 0.6),
        layout="constrained",
    )
    for axis, ((unit, _), names) in zip(axes[:, 0], panels.items(), strict=True):
        for name in names:
            axis.step(*series[name], where="post", label=name, linewidth=1.2)
        axis.set_ylabel(unit)
        axis.grid(alpha=0.3)
        axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize="small", frameon=False)
    axes[-1, 0].set_xlabel("s")
    figure.suptitle(title)
    try:
        figure.savefig(out, dpi=130)
    except OSError as error:
        raise Failure(f"{out}: {error.strerror or error}") from error
    finally:
        pyplot.close(figure)
    click.echo(f"{out}: {sum(len(times) for times, _ in series.values()):,} values of {len(series)} items")


def _draw_terminal(series: Series, title: str, *, clear: bool) -> None:
    try:
        import plotext  # type: ignore[import-untyped]
    except ImportError:
        raise Failure("plots in the terminal need plotext", "pip install 'unitylink[plot]'") from None
    plotext.clear_figure()
    plotext.theme("clear")
    width, height = shutil.get_terminal_size()
    plotext.plot_size(width, height - 1)  # the last line is the cursor's
    coloured = colours(sys.stdout)
    shown = list(series.items())[:_LINES_MOST]
    for (name, (times, numbers)), colour in zip(shown, _COLOURS, strict=False):
        if times:
            plotext.plot(
                times, numbers, label=name, marker="braille", color=colour if coloured else "default"
            )
    plotext.title(title)
    plotext.xlabel("s")
    picture = plotext.build().rstrip("\n")
    if clear:  # over the last one, and in one piece: Ctrl-C leaves a whole picture
        picture = "\x1b[H" + picture.replace("\n", "\x1b[K\n") + "\x1b[J"
    click.echo(picture)
