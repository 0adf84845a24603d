# SPDX-License-Identifier: BSD-3-Clause
"""The screen of a robot from a link and a spec: puts together what the other files have."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from typing import TYPE_CHECKING

from unitylink.connection import connect
from unitylink.connection.schemes import scheme_of
from unitylink.dashboard.feed import READ_HZ, Feed
from unitylink.layer4_data import load_spec_objects

from .app import Screen
from .controls import Controls

if TYPE_CHECKING:
    from unitylink.layer2_message import Link
    from unitylink.spec.model import Spec


@contextmanager
def open_screen(
    link: Link, spec: Spec, *, root: str | None = None, read_hz: float = READ_HZ
) -> Iterator[tuple[Screen, Controls]]:
    """Prepare the screen of a robot within a `with` block. `run` of app.py shows it.

    Values come by `link`. At a server, writes go by a link of their own.
    """
    shared = scheme_of(link.url).name == "serve"
    chosen = spec.root(root) if root is not None else spec.roots[0]
    robot = load_spec_objects(spec, link, root=root)
    values = {value.path: value for value in robot}
    controls = Controls(
        lambda: connect(link.url) if shared else nullcontext(link), spec, chosen, shared=shared
    )
    handler = _Notes(controls)
    with Feed(link, [values[element.path] for element in chosen.walk()], read_hz) as feed, controls:
        logging.getLogger("unitylink").addHandler(handler)
        link.on_event(lambda event: controls.note(f"{event.kind}: {event.text}"))
        try:
            yield Screen(link, chosen, robot, feed, controls), controls
        finally:
            logging.getLogger("unitylink").removeHandler(handler)


class _Notes(logging.Handler):
    """Shows what the library logs, such as a failed poll."""

    def __init__(self, controls: Controls) -> None:
        super().__init__(logging.WARNING)
        self._controls = controls

    def emit(self, record: logging.LogRecord) -> None:
        self._controls.note(record.getMessage())
