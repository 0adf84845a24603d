# SPDX-License-Identifier: BSD-3-Clause
"""FLEET.toml: the text that describes a fleet, and its mistakes, each with its remedy. Opens no link.

[fleet]
name = "lab"
spec = "arm.ul"
may = ["read", "write j1.*"]

[[robot]]
name = "arm1"
link = "serial:/dev/ttyUSB0"
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any, TypeVar
from urllib.parse import parse_qsl, urlencode

from unitylink.connection import check_link
from unitylink.connection.schemes import SCHEMES, scheme_of
from unitylink.errors import FleetError, UnityLinkError, UrlError
from unitylink.server.scopes import Rights
from unitylink.spec.report.suggest import nearest
from unitylink.zenoh.keys import Keys
from unitylink.zenoh.session import ROUTER

from .description import NAME, RIGHTS, Fleet, FleetRobot

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

T = TypeVar("T")
ROBOTS_MOST = 10_000
_WHICH_PORT = ("channel", "node", "offset")  # options of a link that choose a board
# word: its type, and what that is called
_COMMON: dict[str, tuple[type, str]] = {
    "spec": (str, "the file of a spec"),
    "root": (str, "the name of a public constructor"),
    "may": (list, 'a list of scopes, such as ["read", "write j1.*"]'),
    "writers": (list, "a list of names in certificates"),
    "readers": (list, "a list of names in certificates"),
}
_OF_FLEET: dict[str, tuple[type, str]] = {
    "name": (str, "a name, the first part of the keys"),
    "router": (str, f"the place of the fleet's own router, such as {ROUTER}"),
    "connect": (str, "the place of a router, such as tcp/10.0.0.7:7447"),
    "zenoh_config": (str, "a file of Zenoh"),
    "anyone": (bool, "true or false"),
    "audit": (str, "a folder"),
    "stops": (str, "a folder"),
    "security": (str, "a folder, which `unitylink fleet security` fills"),
    **_COMMON,
}
_OF_ROBOT: dict[str, tuple[type, str]] = {
    "name": (str, "a name"),
    "link": (str, "a LINK, such as serial:/dev/ttyUSB0"),
    "key": (str, "a key of Zenoh, such as lab/arm1"),
    **_COMMON,
}


def read_fleet(path: str | Path) -> Fleet:
    """Return the fleet that a file describes. Raises FleetError with the place and the remedy."""
    file = Path(path)
    try:
        text = file.read_text(encoding="utf-8-sig")  # editors of Windows put a mark in front
    except OSError as error:
        raise FleetError(
            f"{path}: {error.strerror or error}; a fleet is described in a file, see docs/fleet.md"
        ) from None
    except ValueError as error:
        raise FleetError(f"{path}: {error}") from None
    return parse_fleet(text, file)


def parse_fleet(text: str, file: Path) -> Fleet:
    """Return the fleet of the text of a file. The paths in it begin where `file` is."""
    try:
        data: dict[str, Any] = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise FleetError(f"{file}: {error}") from None
    _known(data, ("fleet", "robot"), f"{file}")
    head = data.get("fleet", {})
    if not isinstance(head, dict):
        raise FleetError(f"{file}: fleet is no table; begin it with [fleet]")
    _check(head, _OF_FLEET, f"{file}: [fleet]")
    entries = data.get("robot", [])
    if not isinstance(entries, list) or not all(isinstance(entry, dict) for entry in entries):
        raise FleetError(f"{file}: robot is no list; begin each robot with [[robot]]")
    if not 0 < len(entries) <= ROBOTS_MOST:
        raise FleetError(f"{file}: {len(entries)} robots; begin each with [[robot]], at most {ROBOTS_MOST}")
    ways = [word for word in ("router", "connect", "zenoh_config") if word in head]
    if len(ways) > 1:
        raise FleetError(f"{file}: [fleet]: {' and '.join(ways)}: one of them says where the router is")
    if "security" in head and set(ways) - {"router"}:
        raise FleetError(
            f"{file}: [fleet]: with security, the fleet has a router of its own: leave {ways[0]} out"
        )
    name = head.get("name", NAME)
    _key(name, f"{file}: [fleet]: name")
    robots = tuple(_robot(entry, head, name, number, file) for number, entry in enumerate(entries, 1))
    fleet = Fleet(
        file,
        name,
        robots,
        **{word: head[word] for word in (*ways, "anyone", "audit", "stops", "security") if word in head},
    )
    _check_together(fleet)
    return fleet


def _robot(entry: dict[str, Any], head: dict[str, Any], fleet: str, number: int, file: Path) -> FleetRobot:
    name = entry.get("name", "")
    place = (
        f"{file}: robot {number} ({name})" if name and isinstance(name, str) else f"{file}: robot {number}"
    )
    _check(entry, _OF_ROBOT, place)
    if not name:
        raise FleetError(f'{place}: it has no name; add name = "arm{number}"')
    if "/" in name:
        raise FleetError(f"{place}: the name has a `/`; give it a key of its own: key = {name!r}")
    _key(name, f"{place}: name")
    link = entry.get("link")
    if link is None:
        raise FleetError(f'{place}: it has no link; add for example link = "serial:/dev/ttyUSB0"')
    key = entry.get("key", f"{fleet}/{name}")
    _key(key, f"{place}: key")
    both = {**head, **entry}
    may = tuple(both.get("may", RIGHTS))
    if not may:
        raise FleetError(f'{place}: may = [] allows nothing, not even to look; say may = ["read"]')
    try:
        scheme = scheme_of(link)
        if scheme.name == "zenoh":
            raise UrlError(
                f"{link!r} is a robot that has a bridge; a fleet bridges boards, such as serial:/dev/ttyUSB0"
            )
        if not scheme.virtual:  # the spec of a virtual board is compiled when the fleet is run
            check_link(link)
        Rights.of(may)
    except UrlError as error:
        raise FleetError(f"{place}: {error}") from None
    except UnityLinkError as error:
        raise FleetError(f"{place}: may: {error}") from None
    spec = _spec(entry, head, link, place, file)
    in_url = dict(parse_qsl(link.partition("?")[2])).get("root", "") if scheme.virtual else ""
    return FleetRobot(
        name,
        link,
        spec,
        key,
        in_url or both.get("root", ""),
        may,
        tuple(both.get("writers", ())),
        tuple(both.get("readers", ())),
    )


def _spec(entry: dict[str, Any], head: dict[str, Any], link: str, place: str, file: Path) -> str:
    own = own_spec(link)
    kind = link.partition(":")[0]
    folder = file.resolve().parent
    if own and "spec" in entry and (folder / own).resolve() != (folder / entry["spec"]).resolve():
        raise FleetError(f"{place}: a {kind}: link brings its own spec; leave spec = {entry['spec']!r} out")
    spec: str = own or entry.get("spec", head.get("spec", ""))
    if not spec:
        raise FleetError(f'{place}: it has no spec; add spec = "arm.ul" here or below [fleet]')
    if not os.path.isfile(folder / spec):  # Path.is_file raises an error if the name is too long
        raise FleetError(
            f"{place}: there is no spec {spec} in {folder}; paths begin where the fleet's file is"
        )
    return spec


def own_spec(link: str) -> str:
    """Return the spec that the link to a virtual board brings, or an empty text.

    >>> own_spec("sim:arm.ul?plant=ramp"), own_spec("bit:arm.bin?spec=arm.ul"), own_spec("tcp://lab:5555")
    ('arm.ul', 'arm.ul', '')
    """
    kind, _, rest = link.partition(":")
    if not SCHEMES[kind].virtual:
        return ""
    path, _, query = rest.partition("?")
    return path if kind != "bit" or path.endswith(".ul") else dict(parse_qsl(query)).get("spec", "")


def _check_together(fleet: Fleet) -> None:
    """Raise FleetError for robots that could not be told apart."""
    for what, texts in (
        ("name", [one.name for one in fleet.robots]),
        ("key", [one.key for one in fleet.robots]),
        ("link", [_port(one.link) for one in fleet.robots if not scheme_of(one.link).virtual]),
    ):
        if twice := _twice(texts):
            first, second = [number for number, text in enumerate(texts, 1) if text == twice][:2]
            which = f"robots {first} and {second}" if what != "link" else "two robots"
            raise FleetError(f"{fleet.file}: {which} have the {what} {twice}; each needs its own")
    keys = {one.key for one in fleet.robots}
    for one in fleet.robots:
        steps = one.key.split("/")
        if above := next((up for n in range(1, len(steps)) if (up := "/".join(steps[:n])) in keys), None):
            raise FleetError(
                f"{fleet.file}: the key {one.key} is below the key {above} of another robot, whose own keys "
                f"are there; take {above}-{steps[-1]}"
            )


def _port(link: str) -> str:
    """Return the port of a link, without the options that leave it the same port."""
    kind, _, rest = link.partition(":")
    place, _, query = rest.partition("?")
    which = urlencode([(word, value) for word, value in parse_qsl(query) if word in _WHICH_PORT])
    return f"{kind}:{os.path.realpath(place) if place.startswith('/dev/') else place}{which and f'?{which}'}"


def _twice(texts: list[T]) -> T | None:
    seen: set[T] = set()
    return next((text for text in texts if text in seen or seen.add(text)), None)  # type: ignore[func-returns-value]


def _key(text: str, place: str) -> None:
    try:
        Keys(text)
    except UrlError as error:
        raise FleetError(f"{place}: {error}") from None


def _check(data: dict[str, Any], words: dict[str, tuple[type, str]], place: str) -> None:
    _known(data, words, place)
    for word, value in data.items():
        kind, what = words[word]
        inside = value if isinstance(value, list) else [value] if isinstance(value, str) else []
        texts = all(isinstance(one, str) and one and one.isprintable() for one in inside)
        if type(value) is not kind or not texts:
            raise FleetError(f"{place}: {word} = {value!r}; expected {what}")


def _known(data: Iterable[str], words: Iterable[str], place: str) -> None:
    for word in data:
        if word not in words:
            meant = nearest(word, words)
            hint = f"did you mean {meant}?" if meant else f"there are {', '.join(words)}"
            raise FleetError(f"{place}: {word} is unknown; {hint}")
