# SPDX-License-Identifier: BSD-3-Clause
"""A dashboard from a link and a spec: puts together what the other files have."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from typing import TYPE_CHECKING

from unitylink.errors import BindingError
from unitylink.layer4_data import load_spec_objects
from unitylink.optional import absent
from unitylink.server.audit import Audit
from unitylink.server.gate import Gate

if TYPE_CHECKING:
    from unitylink.layer2_message import Link
    from unitylink.server.stop_switch import StopSwitch
    from unitylink.server.tokens import Tokens
    from unitylink.spec.model import Instance, Spec

    from .extras import Extras
    from .place import Place
    from .server import Dashboard


@contextmanager
def open_dashboard(
    link: Link,
    spec: Spec,
    tokens: Tokens,
    put: Callable[[str], object],
    *,
    place: Place | None = None,
    root: str | None = None,
    read_hz: float = 5.0,
    extras: Extras | None = None,
) -> Iterator[Dashboard]:
    """Serve the page of a robot within a `with` block. `put` gets the lines of the audit log.

    A thread of its own calls `put`, so that a log on a disk that hangs holds up no stop. Raises BindingError
    if the spec has several boards and `root` chooses none, and ToolError if a package is absent.

        with open_dashboard(link, spec, tokens, print) as page:
            print(page.url)
    """
    chosen = board_of(spec, root)
    with closing(Audit(put, apart=True)) as audit:
        gate = Gate(chosen.name, chosen, tokens, audit)
        with page_of(link, spec, gate, place=place, root=root, read_hz=read_hz, extras=extras) as page:
            yield page


@contextmanager
def page_of(
    link: Link,
    spec: Spec,
    gate: Gate,
    switch: StopSwitch | None = None,
    *,
    reader: Link | None = None,
    place: Place | None = None,
    root: str | None = None,
    read_hz: float = 5.0,
    extras: Extras | None = None,
) -> Iterator[Dashboard]:
    """Do the same with a gate that is there. `switch` is that of the server, if one keeps the gate.

    Values come by `reader`, for example the `serve:` link of that server, or else by `link`, which writes.
    """
    for package in ("starlette", "uvicorn", "websockets"):
        try:
            __import__(package)
        except ImportError:
            raise absent(package, "the dashboard") from None
    from .desk import Desk
    from .extras import Extras
    from .feed import Feed
    from .server import Dashboard
    from .station import Station

    chosen = board_of(spec, root)
    robot = load_spec_objects(spec, link, root=root)
    reader = reader if reader is not None else link
    values = {value.path: value for value in load_spec_objects(spec, reader, root=root)}
    with Feed(reader, [values[element.path] for element in chosen.walk()], read_hz) as feed:
        desk, extras = Desk(robot, gate, switch), extras if extras is not None else Extras()
        station = Station(reader, chosen, robot, desk, feed, spec=spec, extras=extras)
        with Dashboard(station, place) as page:
            yield page


def board_of(spec: Spec, root: str | None) -> Instance:
    """Return the board of the page."""
    if root is None and len(spec.roots) > 1:
        boards = ", ".join(one.name for one in spec.roots)
        raise BindingError(f"{spec.source} has several boards ({boards}); choose one with --root")
    return spec.root(root) if root is not None else spec.roots[0]
