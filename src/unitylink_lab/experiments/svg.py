# SPDX-License-Identifier: BSD-3-Clause
"""Two kinds of chart as SVG text: bars on a logarithmic scale, and lines with two logarithmic axes."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from html import escape
from types import MappingProxyType

COLOURS = ("#4e79a7", "#f28e2b", "#59a14f", "#b07aa1", "#e15759", "#76b7b2", "#9c755f", "#222222")
WIDTH, HEIGHT = 900, 400
LEFT, RIGHT, TOP, BOTTOM = 80, 20, 20, 90
_NAMES = 4  # how many names stand in a row of the legend
_NUMBER = 24  # width; over a narrower bar the number stands upright


def log_bars(
    groups: Sequence[str],
    series: Mapping[str, Sequence[float | None]],
    label: str,
    deviations: Mapping[str, Sequence[float | None]] = MappingProxyType({}),
) -> str:
    """Draw bars in groups. A value of None leaves a bar out. All values are positive.

    The `deviations` of a series are drawn as a line, by so much below and above the end of the bar.

    >>> log_bars(["a"], {"x": [1.0]}, "us").startswith("<svg")
    True
    """
    values = [value for row in series.values() for value in row if value is not None]
    low, high = _decades(values)
    parts = _frame(label, low, high)
    slot = (WIDTH - LEFT - RIGHT) / len(groups)
    bar = slot * 0.8 / len(series)
    for index, (colour, (name, row)) in enumerate(zip(_cycle(len(series)), series.items(), strict=True)):
        spread = deviations.get(name, [None] * len(row))
        for group, (value, deviation) in enumerate(zip(row, spread, strict=True)):
            if value is None:
                continue
            x, top = LEFT + group * slot + slot * 0.1 + index * bar, _height(value, low, high)
            size = f'width="{bar - 2:.1f}" height="{HEIGHT - BOTTOM - top:.1f}"'
            parts.append(f'<rect x="{x:.1f}" y="{top:.1f}" {size} fill="{colour}"/>')
            middle = x + bar / 2 - 1
            if deviation is not None:
                y = [_height(value + sign * deviation, low, high) for sign in (-1, 1)]
                parts.append(f'<path d="M{middle:.1f} {y[0]:.1f}V{y[1]:.1f}" stroke="black"/>')
                parts += [f'<path d="M{middle - 3:.1f} {end:.1f}h6" stroke="black"/>' for end in y]
                top = y[1]
            if bar < _NUMBER:
                turn = f' transform="rotate(-90 {middle + 3:.1f} {top - 4:.1f})"'
                parts.append(_text(middle + 3, top - 4, _short(value), size=9, anchor="start", turn=turn))
            else:
                parts.append(_text(middle, top - 4, _short(value), size=9))
    for group, name in enumerate(groups):
        parts.append(_text(LEFT + (group + 0.5) * slot, HEIGHT - BOTTOM + 18, name, size=10))
    return _whole(parts, list(series))


def log_lines(
    xs: Sequence[float], series: Mapping[str, Sequence[float | None]], x_label: str, label: str
) -> str:
    """Draw a line for each series over the positive `xs`. A value of None leaves a point out."""
    low, high = _decades([value for row in series.values() for value in row if value is not None])
    parts = _frame(label, low, high)
    span = math.log10(xs[-1] / xs[0])

    def across(x: float) -> float:
        return LEFT + (WIDTH - LEFT - RIGHT) * math.log10(x / xs[0]) / span

    for colour, row in zip(_cycle(len(series)), series.values(), strict=True):
        points = [
            (across(x), _height(value, low, high))
            for x, value in zip(xs, row, strict=True)
            if value is not None
        ]
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        parts.append(f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="2"/>')
        parts += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{colour}"/>' for x, y in points]
    for x in (x for x in xs if x == 1 or x % 2 == 0 or x in {xs[0], xs[-1]}):
        parts.append(_text(across(x), HEIGHT - BOTTOM + 18, f"{x:g}"))
    parts.append(_text((LEFT + WIDTH - RIGHT) / 2, HEIGHT - BOTTOM + 36, x_label))
    return _whole(parts, list(series))


def _short(value: float) -> str:
    return f"{value:.0f}" if value >= 100 else f"{value:.3g}"


def _decades(values: Sequence[float]) -> tuple[int, int]:
    low = math.floor(math.log10(min(values)))
    return low, max(low + 1, math.ceil(math.log10(max(values))))


def _height(value: float, low: int, high: int) -> float:
    return HEIGHT - BOTTOM - (HEIGHT - BOTTOM - TOP) * (math.log10(value) - low) / (high - low)


def _cycle(count: int) -> list[str]:
    return [COLOURS[index % len(COLOURS)] for index in range(count)]


def _text(x: float, y: float, text: str, *, size: int = 12, anchor: str = "middle", turn: str = "") -> str:
    return (
        f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" text-anchor="{anchor}"{turn}>{escape(text)}</text>'
    )


def _frame(label: str, low: int, high: int) -> list[str]:
    parts = [f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>']
    for decade in range(low, high + 1):
        y = _height(10.0**decade, low, high)
        parts.append(f'<line x1="{LEFT}" y1="{y:.1f}" x2="{WIDTH - RIGHT}" y2="{y:.1f}" stroke="#ccc"/>')
        parts.append(_text(LEFT - 6, y + 4, f"{10.0**decade:g}", anchor="end"))
    middle = (TOP + HEIGHT - BOTTOM) / 2
    parts.append(_text(20, middle, label, turn=f' transform="rotate(-90 20 {middle:.0f})"'))
    return parts


def _whole(parts: list[str], names: list[str]) -> str:
    slot = (WIDTH - LEFT) / min(_NAMES, len(names))
    for index, (colour, name) in enumerate(zip(_cycle(len(names)), names, strict=True)):
        row, column = divmod(index, _NAMES)
        x, y = LEFT + column * slot, HEIGHT - 36 + 18 * row
        parts.append(f'<rect x="{x:.1f}" y="{y}" width="12" height="12" fill="{colour}"/>')
        parts.append(_text(x + 17, y + 10, name, anchor="start", size=11))
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif">'
    return "\n".join([head, *parts, "</svg>"]) + "\n"
