# SPDX-License-Identifier: BSD-3-Clause
"""The settings that can be lowered to make a design smaller, and how much each saves."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import MISSING, dataclass, fields
from typing import Union

from unitylink.errors import BoardError
from unitylink.interface.board_configuration import BoardConfiguration
from unitylink.spec.report.suggest import nearest

from .manifest import Board

Setting = Union[int, str, bool]


@dataclass(frozen=True)
class Remedy:
    """`option` of `unitylink build` saves so many cells and block RAMs of an iCE40."""

    option: str
    what: str
    cells: int
    memories: int
    helps: Callable[[BoardConfiguration], bool]  # tells whether this can still be changed


def _above(name: str, value: int) -> Callable[[BoardConfiguration], bool]:
    """Return a test: does a configuration have this setting, and more than `value` of it?"""
    return lambda configuration: int(getattr(configuration, name, 0)) > value


def _framed(name: str, value: int) -> Callable[[BoardConfiguration], bool]:
    """Return the same test for a setting that counts only if frames are spoken."""
    above = _above(name, value)
    return lambda configuration: configuration.protocol != "classic" and above(configuration)


# The figures follow from the rows of gateware/area.json (tests/unit/boards/test_fit.py).
REMEDIES = (
    Remedy("--protocol classic", "text alone, without frames", 1300, 14, lambda c: c.protocol == "both"),
    Remedy("--protocol framed", "frames alone, without text", 550, 7, lambda c: c.protocol == "both"),
    Remedy(
        "--set engine=small",
        "the small engine: frames alone, without lists",
        790,
        9,
        lambda c: c.protocol != "classic" and c.engine == "fast",
    ),
    Remedy(
        "--set groups=2",
        "2 publish groups instead of 4",
        55,
        0,
        lambda c: c.publish_mode > 0 and c.groups > 2,
    ),
    Remedy("--set publish_mode=0", "no publishing", 260, 4, _above("publish_mode", 0)),
    Remedy("--set lists=false", "no lists and post lists", 150, 0, _framed("lists", 0)),
    Remedy("--set window=16", "fewer requests in flight", 0, 1, _framed("window", 16)),
)


def remedies(configuration: BoardConfiguration) -> Iterator[str]:
    """Yield changes that make the design smaller, the most helpful first."""
    for one in REMEDIES:
        if one.helps(configuration):
            parts = [f"{one.cells} cells"] if one.cells else []
            parts += [f"{one.memories} block RAM{'s'[: one.memories > 1]}"] if one.memories else []
            yield f"{one.option}: {one.what}, about {' and '.join(parts)} less"
    yield "fewer words in the spec, or a narrower DATA of its link: each bit of a word takes a flip-flop"


def too_large(board: Board, configuration: BoardConfiguration, why: str) -> BoardError:
    """Return the error for a design that does not fit on `board`, with what would help."""
    helps = "".join(f"\n  {remedy}" for remedy in remedies(configuration))
    return BoardError(
        f"the design does not fit on {board.title}: {why}\n"
        f"What would help, and by how much on an iCE40:{helps}"
    )


def settings_of(texts: Sequence[str]) -> dict[str, Setting]:
    """Return settings that are written NAME=VALUE. Raises BoardError for an unknown setting.

    >>> settings_of(["groups=2", "configuration_command=false"])
    {'groups': 2, 'configuration_command': False}
    """
    known = {
        one.name: type(one.default)
        for one in fields(BoardConfiguration)
        if one.default is not MISSING and isinstance(one.default, (int, str))
    }
    found: dict[str, Setting] = {}
    for text in texts:
        name, _, value = text.partition("=")
        if name not in known:
            near = nearest(name, known)
            raise BoardError(
                f"--set {text}: there is no setting {name!r}; "
                + (f"did you mean {near}?" if near else f"there are: {', '.join(known)}")
            )
        found[name] = _read(text, value, known[name])
    return found


def _read(text: str, value: str, kind: type) -> Setting:
    if kind is str:
        return value
    if kind is bool:
        if value in ("true", "false"):
            return value == "true"
        raise BoardError(f"--set {text}: write true or false")
    try:
        return int(value, 0)
    except ValueError:
        raise BoardError(f"--set {text}: {value!r} is not a whole number") from None
