# SPDX-License-Identifier: BSD-3-Clause
"""The publishes of the spec as publications, while somebody subscribes to them."""

from __future__ import annotations

import logging
import re
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from unitylink._native import SampleOutput
from unitylink.errors import UnityLinkError

from ..schema import Field, Layout

if TYPE_CHECKING:
    import zenoh

    from unitylink.spec.model import Spec, SubscriptionGroup

    from .groups import Groups, Put

_OTHER = re.compile(r"[^A-Za-z0-9]+")
_log = logging.getLogger("unitylink.zenoh")


def topic_names(spec: Spec) -> dict[str, SubscriptionGroup]:
    """Return the groups of a spec by the names of their topics: `100_hz`, `on_limit`."""
    named: dict[str, SubscriptionGroup] = {}
    for device in spec.devices:
        for group in device.groups:
            name = base = _OTHER.sub("_", group.name).strip("_").lower() or "group"
            count = 1
            while name in named:
                count += 1
                name = f"{base}_{count}"
            named[name] = group
    return named


def typed_output(put: Put, fields: Sequence[Field]) -> SampleOutput:
    """Return what puts the values of these fields, which are one after the other in the words of a group."""
    pieces = [field.piece for field in fields]
    return SampleOutput(put, sum(field.codec.words for field in fields), pieces)


class Topics:
    """Joins the groups of the spec for as long as their publications have subscribers.

    `news` is called when subscribers come or go: then it is time to look.
    """

    def __init__(
        self,
        spec: Spec,
        fields: dict[str, Field],
        publishers: dict[str, zenoh.Publisher],
        groups: Groups,
        news: Callable[[], None],
    ) -> None:
        self._groups, self._publishers = groups, publishers
        self._named = topic_names(spec)
        self._fields = {
            name: [fields[element.path] for element in group.elements] for name, group in self._named.items()
        }
        self._joined: dict[str, int] = {}
        self.failed: dict[str, str] = {}
        self._listeners = [one.declare_matching_listener(lambda _: news()) for one in publishers.values()]

    def look(self) -> None:
        """Join and leave, as subscribers come and go. Call it often."""
        for name, publisher in self._publishers.items():
            wanted = bool(getattr(publisher.matching_status, "matching", False))
            if wanted and name not in self._joined:
                self._join(name, publisher)
            elif not wanted and name in self._joined:
                self._groups.leave(self._joined.pop(name), 0)

    def forget(self) -> None:
        """The board was lost, and with it all groups."""
        self._joined.clear()

    def _join(self, name: str, publisher: zenoh.Publisher) -> None:
        group = self._named[name]
        try:
            self._joined[name] = self._groups.join(
                0,
                group.addresses,
                divisor=group.divisor,
                on_event=not group.divisor,
                verify=all(element.pollable for element in group.elements),
                group=None if group.divisor else group.number,
                topic=typed_output(publisher.put, self._fields[name]),
            )
            self.failed.pop(name, None)
        except UnityLinkError as error:
            if self.failed.get(name) != str(error):
                self.failed[name] = str(error)
                _log.warning("the publish %s: %s", name, error)


def layouts_of(spec: Spec, fields: dict[str, Field]) -> dict[str, Layout]:
    """Return the layout of each topic."""
    return {
        name: Layout(fields[element.path] for element in group.elements)
        for name, group in topic_names(spec).items()
    }
