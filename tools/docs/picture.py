# SPDX-License-Identifier: BSD-3-Clause
"""An SVG picture that is made of shapes, and its colours on a light and on a dark page."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

INK, FAINT, BACK = "#1f2430", "#6b7280", "#ffffff"
PC, DEVICE, PUBLISH, CHECK = "#00897b", "#3f51b5", "#d9822b", "#8e44ad"
GRID = "#d7dae0"
BOLD, SMALL, MONO = 'font-weight="600"', 'font-size="11"', 'font-family="monospace" font-size="15"'
_DARK = {
    INK: "#e6e8ee",
    FAINT: "#9aa3b2",
    BACK: "#14171f",
    GRID: "#333a47",
    PC: "#4db6ac",
    DEVICE: "#8c9eff",
    PUBLISH: "#ffb74d",
    CHECK: "#ce93d8",
}


def _dark_style() -> str:
    """Return the rules that give each colour its other one where the reader's system is dark."""
    rules = "".join(
        f'[fill="{light}"]{{fill:{dark}}}[stroke="{light}"]{{stroke:{dark}}}' for light, dark in _DARK.items()
    )
    return f"<style>@media (prefers-color-scheme:dark){{{rules}}}</style>"


class Picture:
    """An SVG picture to which shapes are added. Lengths are in pixels."""

    def __init__(self, width: int, height: int, title: str) -> None:
        self.parts = [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" '
            f'height="{height}" font-family="system-ui, sans-serif" font-size="13" fill="{INK}">',
            f"<title>{escape(title)}</title>",
            _dark_style(),
            f'<rect width="{width}" height="{height}" fill="{BACK}"/>',
        ]

    def box(
        self, x: float, y: float, width: float, height: float, colour: str, *, fill: float = 0.12
    ) -> None:
        """Draw a rectangle with a border of `colour`. `fill` is the strength of the same colour inside."""
        self.parts.append(
            f'<rect x="{x:.1f}" y="{y:.1f}" width="{width:.1f}" height="{height:.1f}" rx="3" fill="{colour}" '
            f'fill-opacity="{fill}" stroke="{colour}"/>'
        )

    def text(
        self, x: float, y: float, text: str, *, anchor: str = "start", colour: str = INK, style: str = ""
    ) -> None:
        """Write `text` with its base line at `y`."""
        self.parts.append(
            f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="{colour}" {style}>'
            f"{escape(text)}</text>"
        )

    def line(
        self, x1: float, y1: float, x2: float, y2: float, colour: str = FAINT, *, dash: str = ""
    ) -> None:
        """Draw a line."""
        dashed = f' stroke-dasharray="{dash}"' if dash else ""
        self.parts.append(
            f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" stroke="{colour}"{dashed}/>'
        )

    def path(self, points: Sequence[tuple[float, float]], colour: str) -> None:
        """Draw a line through `points`."""
        through = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        self.parts.append(f'<polyline points="{through}" fill="none" stroke="{colour}" stroke-width="1.4"/>')

    def svg(self) -> str:
        """Return the whole picture."""
        return "\n".join([*self.parts, "</svg>", ""])
