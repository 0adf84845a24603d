# SPDX-License-Identifier: BSD-3-Clause
"""A dashboard from a link and a spec: puts together what the other files have."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from unitylink.errors import BindingError
from unitylink.layer4_data import load_spec_objects
from unitylink.optional import absent
from unitylink.server.audit import Audit
from unitylink.server.gate import Gate

if TYPE_CHECKING:
    from unitylink.layer2_message import Link
    from unitylink.server.tokens import Tokens
    from unitylink.spec.model import Spec

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
) -> Iterator[Dashboard]:
    """Serve the page of a robot within a `with` block. `put` gets the lines of the audit log.

    Raises BindingError if the spec has several boards and `root` chooses none, and ToolError if a package is
    absent.

        with open_dashboard(link, spec, tokens, print) as page:
            print(page.url)
    """
    for package in ("starlette", "uvicorn", "websockets"):
        try:
            __import__(package)
        except ImportError:
            raise absent(package, "the dashboard") from None
    from .desk import Desk
    from .feed import Feed
    from .server import Dashboard
    from .station import Station

    if root is None and len(spec.roots) > 1:
        boards = ", ".join(one.name for one in spec.roots)
        raise BindingError(f"{spec.source} has several boards ({boards}); choose one with --root")
    chosen = spec.root(root) if root is not None else spec.roots[0]
    robot = load_spec_objects(spec, link, root=root)
    gate = Gate(chosen.name, chosen, tokens, Audit(put))
    values = {value.path: value for value in robot}
    with Feed(link, [values[element.path] for element in chosen.walk()], read_hz) as feed:
        station = Station(link, chosen, robot, Desk(robot, gate), feed)
        with Dashboard(station, place) as page:
            yield page
