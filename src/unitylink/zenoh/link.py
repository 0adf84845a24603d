# SPDX-License-Identifier: BSD-3-Clause
"""A link to a robot on a Zenoh network, and what such a robot gives beside the words."""

from __future__ import annotations

import atexit
import json
import shutil
import tempfile
import time
from collections.abc import Mapping
from functools import cache, cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from unitylink.errors import LinkTimeout, ProtocolError, UnknownName, ValueRangeError
from unitylink.layer2_message import Link
from unitylink.layer4_data import load_spec_objects

from .far_line import FarLine
from .far_options import read_far_url
from .messages import TTL_MAX_NS, SetPoint
from .schema import fields_of, set_layouts
from .spec_files import unpack_spec

if TYPE_CHECKING:
    import zenoh

    from unitylink._native import NativeLink
    from unitylink.layer4_data import Node
    from unitylink.spec.model import Spec

_TEXT_S = 2.0


class ZenohLink(Link):
    """A link like any other. It also knows the robot's spec, and sends set-points with a time to live."""

    def _opened(self, url: str) -> NativeLink:
        self._far = FarLine(read_far_url(url))
        return cast("NativeLink", self._far)

    @cached_property
    def spec(self) -> Spec:
        """The spec of the robot, as its bridge tells it. Raises LinkTimeout, ProtocolError or SpecError."""
        with tempfile.TemporaryDirectory(prefix="unitylink-spec-") as folder:
            return unpack_spec(self.spec_text(), folder)[0]

    def spec_text(self) -> str:
        """Return the files of the spec, as `unitylink.zenoh.spec_files` packs them."""
        return self._text("spec")

    def robot(self) -> Node:
        """Return the objects of the robot: `link.robot()["j1.cpos"].read()`."""
        return load_spec_objects(self.spec, self)

    def state(self) -> dict[str, Any]:
        """Return the state of the bridge: who is there, what it has refused, how the board is."""
        text = self._text("state")
        try:
            told = json.loads(text)
        except (ValueError, RecursionError):
            told = None
        if not isinstance(told, dict):
            raise ProtocolError(f"{self.url}: the bridge tells a state that cannot be understood")
        return told

    def set_points(self, part: str = "", *, ttl_s: float) -> SetPoints:
        """Return what sends set-points of an item, or of all items below a part.

        The bridge writes the newest, and none that is older than `ttl_s`. Nothing tells whether one was
        written: read the item, or count in `state`. Raises UnknownName or ValueRangeError.
        """
        return SetPoints(self, self._far, part, ttl_s)

    def _text(self, what: str) -> str:
        within_s = _TEXT_S * self._far.bridge.options.attempts
        answer = self._far.bridge.questions.insist(what, each_s=_TEXT_S, within_s=within_s)
        if answer is None:
            raise LinkTimeout(f"{self.url}: the bridge does not tell its {what}", elapsed_s=within_s)
        return answer.decode("utf-8", "replace")


@cache
def spec_of(url: str) -> tuple[Spec, Path]:
    """Return the spec of a robot, as its bridge tells it, and a file with it until the program ends.

    Raises what `ZenohLink` raises.
    """
    with ZenohLink(url) as link:
        text = link.spec_text()
    folder = tempfile.mkdtemp(prefix="unitylink-spec-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return unpack_spec(text, folder)


class SetPoints:
    """Sends set-points of one part. Made by `ZenohLink.set_points`.

    >>> goals = link.set_points("j1", ttl_s=0.1)                      # doctest: +SKIP
    >>> goals.send({"j1.pos_sp": 100, "j1.spd_sp": 20})                # doctest: +SKIP
    """

    def __init__(self, link: ZenohLink, far: FarLine, part: str, ttl_s: float) -> None:
        self._ttl_ns = int(ttl_s * 1e9) if 0 < ttl_s * 1e9 <= TTL_MAX_NS else 0
        if not self._ttl_ns:
            raise ValueRangeError(f"a time to live of {ttl_s} s; it is up to {TTL_MAX_NS / 1e9:g} s")
        layouts = set_layouts(link.spec, fields_of(link.spec, link.configuration.data_bits))
        if part not in layouts:
            raise UnknownName(f"{link.url}: {part or 'the robot'} has no set-points")
        self._bridge, self._layout = far.bridge, layouts[part]
        self.paths = tuple(field.path for field in self._layout.fields)
        """The items in the order of `send`."""
        self._key = self._bridge.keys.set_point(part)
        self._publisher: zenoh.Publisher = _publisher(self._bridge.session, self._key)
        self._sequence = 0

    def send(self, values: Mapping[str, Any] | Any) -> None:
        """Send a value for each item, by path or in order; one alone for one item.

        Raises ValueRangeError, UnknownName, or LinkDown if the robot is away.
        """
        given = (
            [values] if len(self.paths) == 1 and not isinstance(values, (Mapping, list, tuple)) else values
        )
        if isinstance(given, Mapping):
            if set(given) != set(self.paths):
                raise UnknownName(f"set-points of {', '.join(given)}; expected {', '.join(self.paths)}")
            given = [given[path] for path in self.paths]
        if len(given) != len(self.paths):
            raise ValueRangeError(f"{len(given)} set-points for {', '.join(self.paths)}")
        body = self._layout.pack_values(list(given))
        self._bridge.check()
        self._sequence += 1
        deadline_ns = self._bridge.clock.deadline(time.monotonic_ns(), self._ttl_ns)
        point = SetPoint(self._key, self._bridge.visit, self._sequence, deadline_ns, body)
        self._publisher.put(point.encode())


def _publisher(session: zenoh.Session, key: str) -> zenoh.Publisher:
    import zenoh  # it is there, because there is a session

    return session.declare_publisher(
        key,
        congestion_control=zenoh.CongestionControl.DROP,
        priority=zenoh.Priority.INTERACTIVE_HIGH,
        express=True,
    )
