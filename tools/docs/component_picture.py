# SPDX-License-Identifier: BSD-3-Clause
"""The picture of a component: its pins around a box, and what its lines do in its scenes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from picture import BOLD, DEVICE, FAINT, GRID, INK, PC, PUBLISH, SMALL, Picture
from scene import Played, Track, configuration

from unitylink.values import format_value

WIDTH, ROW, HIGH = 860, 26, 15
VALUE_ROW = 64
BOX_LEFT, BOX_RIGHT = 44, 236
NAMES, LEFT, RIGHT = 300, 400, 830
COLOURS = {"in": PC, "out": DEVICE, "event": PUBLISH, "value": INK}
TICKS = 5
LETTERS = 58  # of a line with writes
Place = Callable[[float], float]  # from a time in us to a place in pixels


def component_picture(folder: Path, played: Sequence[Played]) -> str:
    """Return the SVG of a component."""
    one = configuration(folder)
    ports = [*one.pins, *((port, way, 0) for port, way in one.wires)]  # a wire is one value
    inputs = [(port, bits) for port, way, bits in ports if way == "in"]
    outputs = [(port, bits) for port, way, bits in ports if way == "out"]
    rows = max(len(inputs), len(outputs) + len(one.events))
    box = 64 + rows * 22
    heights = [_height(scene) for scene in played]
    height = max(box + 40, sum(heights) + 10)
    picture = Picture(WIDTH if played else BOX_RIGHT + 60, height, f"{one.entity}: pins and signals")
    top = 20
    picture.box(BOX_LEFT, top, BOX_RIGHT - BOX_LEFT, box, DEVICE, fill=0.06)
    picture.text((BOX_LEFT + BOX_RIGHT) / 2, top + 22, one.entity, anchor="middle", style=BOLD)
    words = f"{one.words} words on the bus"
    picture.text((BOX_LEFT + BOX_RIGHT) / 2, top + 38, words, anchor="middle", colour=FAINT, style=SMALL)
    for row, (port, bits) in enumerate(inputs):
        _pin(picture, top + 62 + row * 22, port, bits, "in")
    for row, (port, bits) in enumerate(outputs):
        _pin(picture, top + 62 + row * 22, port, bits, "out")
    for row, event in enumerate(one.events, len(outputs)):
        _pin(picture, top + 62 + row * 22, event, 0, "event")
    y = 10.0
    for scene, needed in zip(played, heights, strict=True):
        _scene(picture, y, scene)
        y += needed
    return picture.svg()


def _pin(picture: Picture, y: float, port: str, bits: int, kind: str) -> None:
    text = f"{port} × {bits}" if bits > 1 else port
    colour = COLOURS[kind]
    if kind == "in":
        picture.line(12, y, BOX_LEFT, y, colour)
        picture.path([(BOX_LEFT - 7, y - 4), (BOX_LEFT, y), (BOX_LEFT - 7, y + 4)], colour)
        picture.text(BOX_LEFT + 8, y + 4, text, colour=colour, style=SMALL)
    else:
        picture.line(BOX_RIGHT, y, BOX_RIGHT + 32, y, colour, dash="3 3" if kind == "event" else "")
        picture.path([(BOX_RIGHT + 25, y - 4), (BOX_RIGHT + 32, y), (BOX_RIGHT + 25, y + 4)], colour)
        picture.text(BOX_RIGHT - 8, y + 4, text, anchor="end", colour=colour, style=SMALL)


def _height(scene: Played) -> int:
    return 34 + len(_captions(scene)) * 15 + sum(_row(track) for track in scene.tracks) + 34


def _row(track: Track) -> int:
    return VALUE_ROW if track.kind == "value" else ROW


def _captions(scene: Played) -> list[tuple[float, str]]:
    """Return the writes, those of one moment in one text that fits into a line."""
    found: list[tuple[float, str]] = []
    for at, text in scene.written:
        same = found and at - found[-1][0] < (scene.to_us - scene.from_us) / 100
        longer = f"{found[-1][1]}, {text}" if same else text
        if same and len(longer) <= LETTERS:
            found[-1] = (found[-1][0], longer)
        else:
            found.append((found[-1][0] if same else at, text))
    return found


def _scene(picture: Picture, top: float, scene: Played) -> None:
    scale = (RIGHT - LEFT) / (scene.to_us - scene.from_us)

    def x(us: float) -> float:
        return LEFT + (min(max(us, scene.from_us), scene.to_us) - scene.from_us) * scale

    picture.text(NAMES, top + 18, scene.title, style=BOLD)
    captions = _captions(scene)
    first = top + 28 + len(captions) * 15
    bottom = first + sum(_row(track) for track in scene.tracks) + 6
    for tick in range(TICKS + 1):
        at = scene.from_us + (scene.to_us - scene.from_us) * tick / TICKS
        picture.line(x(at), first, x(at), bottom, GRID, dash="2 3")
        picture.text(x(at), bottom + 14, _time(at, scene.to_us), anchor="middle", colour=FAINT, style=SMALL)
    for row, (at, text) in enumerate(captions):
        y = top + 36 + row * 15
        picture.line(x(at), y - 4, x(at), bottom, PUBLISH, dash="1 3")
        end = x(at) > (LEFT + RIGHT) / 2
        begin = x(at) + (-5 if end else 5)
        picture.text(begin, y, text, anchor="end" if end else "start", colour=PUBLISH, style=SMALL)
    y = first
    for track in scene.tracks:
        y += _row(track)
        if track.kind == "value":
            _value(picture, y - 6, track, x)
        elif track.kind == "event":
            _event(picture, y - 6, track, x)
        else:
            _levels(picture, y - 6, track, x, scene.to_us)


def _levels(picture: Picture, y: float, track: Track, x: Place, end_us: float) -> None:
    picture.text(NAMES, y, track.name, colour=COLOURS[track.kind], style=SMALL)
    points, level = [], 0.0
    for at, new in track.points:
        points += [(x(at), y - level * HIGH), (x(at), y - new * HIGH)]
        level = new
    picture.path([*points, (x(end_us), y - level * HIGH)], COLOURS[track.kind])


def _event(picture: Picture, y: float, track: Track, x: Place) -> None:
    picture.text(NAMES, y, track.name, colour=COLOURS["event"], style=SMALL)
    picture.line(LEFT, y, RIGHT, y, GRID)
    for at, high in track.points:
        if high:
            picture.path([(x(at), y), (x(at), y - HIGH)], COLOURS["event"])
            picture.path([(x(at) - 3, y - 9), (x(at), y - HIGH), (x(at) + 3, y - 9)], COLOURS["event"])


def _value(picture: Picture, y: float, track: Track, x: Place) -> None:
    """Draw a number as a line from its least to its largest value, which are written at its left."""
    known = [value for _, value in track.points if value is not None]
    least, most = min(known, default=0.0), max(known, default=0.0)
    picture.text(NAMES, y - VALUE_ROW / 2 + 10, track.name, style=SMALL)
    reach = VALUE_ROW - 14
    run: list[tuple[float, float]] = []
    for at, value in track.points:
        if value is None:
            picture.path([*run, *((x(at), height) for _, height in run[-1:])], INK)
            run = []
            continue
        height = y - (value - least) / ((most - least) or 1) * reach
        run += [(x(at), run[-1][1] if run else height), (x(at), height)]
    picture.path(run, INK)
    unit = f" {track.unit}" if track.unit else ""
    for height, value in ((0, least), (reach - 4, most)) if most > least else ((0, least),):
        text = f"{format_value(round(value, 4))}{unit}"
        picture.text(LEFT - 6, y - height, text, anchor="end", colour=FAINT, style=SMALL)


def _time(us: float, longest_us: float) -> str:
    return f"{us / 1000:g} ms" if longest_us >= 1000 else f"{us:g} µs"
