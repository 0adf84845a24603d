# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink plot`: items over time, as a picture or live in the terminal."""

from __future__ import annotations

import shutil
import sys
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from importlib.util import find_spec
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

import click

from unitylink.errors import LinkError
from unitylink.optional import absent
from unitylink.output_file import check_output, write_output
from unitylink.program import ended_by_signals
from unitylink.values import Quantity, plain

from .failure import Failure
from .link_option import is_link, open_target, spec_option
from .names import matches
from .output import colours, force_option, terminal
from .sampling_options import duration_option, rate_option, sampled_items
from .series import AllSeries, parts_of

if TYPE_CHECKING:
    from unitylink.recording import Origin
    from unitylink.spec.model import Spec

    from .sampler import Sampler

_PICTURES = (".png", ".svg", ".pdf")
_REDRAW_S = 0.2
_PANELS_MOST = 64
_WINDOW_S = 10.0  # the time that a live plot shows
_LINES_MOST = 8  # the most lines in one panel; more would hide each other
_COLOURS = ("cyan+", "orange+", "green+", "magenta+", "red+", "blue+", "white", "gray")  # of plotext


@click.command()
@click.argument("source", metavar="LINK|RECORDING")
@click.argument("names", metavar="[NAME...]", nargs=-1)
@spec_option
@click.option(
    "--out",
    metavar="FILE",
    help=f"A picture ({', '.join(_PICTURES)}). Without it a terminal shows the plot live.",
)
@force_option
@rate_option
@duration_option
def command(
    source: str,
    *,
    names: tuple[str, ...],
    spec_file: str | None,
    out: str | None,
    force: bool,
    rate_hz: float,
    duration_s: float | None,
) -> None:
    """Draw items over time: live from a LINK, or from a recording.

    Values with the same unit share a panel. Members of enumerations are drawn by name. An MCAP recording
    knows its units. For a CSV file add --spec.

    \b
    Examples:
      unitylink plot sim:arm.ul '*.position'
      unitylink plot sim:arm.ul '*.position' --duration 5 --out arm.png
      unitylink plot arm.mcap x.position --out x.svg
    """
    if out is not None and Path(out).suffix.lower() not in _PICTURES:
        raise click.UsageError(f"--out {out}: the name of a picture ends in {', '.join(_PICTURES)}")
    if out is None and not terminal():
        raise Failure("the output is not a terminal, so nothing can be drawn on it", "add --out FILE.png")
    if out is not None:
        check_output(out, force=force)
    _need("matplotlib" if out is not None else "plotext")  # checked before anything is measured
    if not is_link(source):
        _draw(_recorded(source, names, spec_file), Path(source).name, out, force=force)
        return
    with ended_by_signals(), open_target(source, spec_file, quiet=out is None) as target:
        found = sampled_items(target, names, "plot")
        from .sampler import Sampler

        quantities = {item.name: item.quantity for item in found}
        series = AllSeries()
        for path, quantity in quantities.items():
            series.declare(parts_of(path, quantity.type, quantity.unit))
        failed: LinkError | None = None
        try:
            with Sampler(target.link, found, rate_hz) as sampler, suppress(KeyboardInterrupt):
                _follow(sampler, series, quantities, source=source, out=out, duration_s=duration_s)
        except LinkError as error:
            failed = error  # raised after everything that came before it has been drawn
        if out is not None and (failed is None or series.count):
            _draw(series, source, out, force=force)
        if failed is not None:
            raise failed


def _need(package: str) -> None:
    if find_spec(package) is None:
        raise absent(package, "a picture" if package == "matplotlib" else "a plot in the terminal")


def _follow(
    sampler: Sampler,
    series: AllSeries,
    quantities: Mapping[str, Quantity],
    *,
    source: str,
    out: str | None,
    duration_s: float | None,
) -> None:
    """Fill `series` with the samples. Without `out`, a terminal shows them meanwhile."""
    drawn_s = time.monotonic()
    for sample in sampler.samples(None, duration_s if duration_s or out is None else _WINDOW_S):
        if sample is not None:
            time_s, values, numbers = sample
            named = {v.path: plain(n, quantities[v.path]) for v, n in zip(values, numbers, strict=True)}
            series.take(sampler.since_start_s(time_s), named)
        if out is None and time.monotonic() - drawn_s > _REDRAW_S:
            drawn_s = time.monotonic()
            newest_s = max((one.times_s[-1] for one in series.values() if one.times_s), default=0.0)
            for one in series.values():
                one.forget(newest_s - _WINDOW_S)
            _draw_terminal(series, source, clear=True)
    if out is None:
        _draw_terminal(series, source, clear=True)  # with the samples that came since


def _recorded(path: str, patterns: Sequence[str], spec_file: str | None) -> AllSeries:
    from unitylink.recording import RecordingTruncated, origin, samples
    from unitylink.spec import load

    series = AllSeries(lambda name: not patterns or any(_matches(name, pattern) for pattern in patterns))
    made_with = origin(path)
    if (spec := load(spec_file) if spec_file is not None else _spec_of(made_with)) is not None:
        known = [part for name, one in spec.walk() for part in parts_of(name, one.type, one.unit)]
    else:
        known = [(name, unit, ()) for name, unit in made_with.units.items()]
    series.declare(known)
    try:
        for sample in samples(path):
            series.take(sample.time_s, sample.values)
    except RecordingTruncated as error:
        click.echo(f"note: {error}", err=True)
    if not series.count:
        wanted = ", ".join(patterns)
        raise Failure(f"{path} has no item that is called {wanted}" if wanted else f"{path} is empty")
    for name in [name for name, one in series.items() if not one.times_s]:
        del series[name]
    series.begin_at_zero()
    return series


def _spec_of(made_with: Origin) -> Spec | None:
    """Return the spec that is stored in a recording.

    Return None if it has none, or one that is incomplete.
    """
    from unitylink.spec import compile_text

    return compile_text(made_with.text.encode(), made_with.name).spec if made_with.text else None


def _matches(name: str, pattern: str) -> bool:
    """Return whether a pattern or a name means this item. The name of an instance means all of its items."""
    return matches(name, pattern) or name.startswith(f"{pattern}.")


def _draw(series: AllSeries, title: str, out: str | None, *, force: bool) -> None:
    if out is None:
        _draw_terminal(series, title, clear=False)
        return
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot

    panels: dict[tuple[str, tuple[str, ...], int], list[str]] = {}
    counts: dict[tuple[str, tuple[str, ...]], int] = {}
    for name, one in series.items():
        kind = one.unit, tuple(one.members)
        counts[kind] = counts.get(kind, 0) + 1
        panels.setdefault((*kind, (counts[kind] - 1) // _LINES_MOST), []).append(name)
    if len(panels) > _PANELS_MOST:
        raise Failure(f"{len(panels)} panels do not fit into a picture", "name what to draw, such as 'x.*'")
    figure, axes = pyplot.subplots(
        len(panels),
        1,
        sharex=True,
        squeeze=False,
        figsize=(10, 2.8 * len(panels) + 0.6),
        layout="constrained",
    )
    for axis, ((unit, members, _), names) in zip(axes[:, 0], panels.items(), strict=True):
        for name in names:
            one = series[name]
            axis.step(one.times_s, one.numbers, where="post", label=_text(name), linewidth=1.2)
        if members:
            axis.set_yticks(range(len(members)), map(_text, members))
        axis.set_ylabel(_text(unit))
        axis.grid(alpha=0.3)
        axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize="small", frameon=False)
    axes[-1, 0].set_xlabel("s")
    figure.suptitle(_text(title))
    picture = BytesIO()
    try:
        figure.savefig(picture, format=Path(out).suffix[1:].lower(), dpi=130)
    finally:
        pyplot.close(figure)
    write_output(out, picture.getvalue(), force=force)
    click.echo(f"{out}: {series.count:,} values of {len(series)} items")


def _text(text: str) -> str:
    """Return a text for matplotlib, which would read text between dollars as a formula."""
    return text.replace("$", r"\$")


def _draw_terminal(series: AllSeries, title: str, *, clear: bool) -> None:
    import plotext  # type: ignore[import-untyped]

    plotext.clear_figure()
    plotext.theme("clear")
    width, height = shutil.get_terminal_size()
    plotext.plot_size(width, height - 1)  # the cursor needs the last line
    coloured = colours(sys.stdout)
    shown = list(series.items())[:_LINES_MOST]
    for (name, one), colour in zip(shown, _COLOURS, strict=False):
        if one.times_s:
            label = f"{name} [{one.unit}]" if one.unit else name
            seen = colour if coloured else "default"
            plotext.plot(one.times_s, one.numbers, label=label, marker="braille", color=seen)
    scales = {tuple(one.members) for _, one in shown}
    if len(scales) == 1 and (members := scales.pop()):
        plotext.yticks(range(len(members)), members)
    plotext.title(title)
    plotext.xlabel("s")
    picture = plotext.build().rstrip("\n")
    if clear:  # replaces the last picture in one step, so that a whole one is left after Ctrl-C
        picture = "\x1b[H" + picture.replace("\n", "\x1b[K\n") + "\x1b[J"
    click.echo(picture)
