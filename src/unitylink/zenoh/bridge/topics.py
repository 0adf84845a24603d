# SPDX-License-Identifier: BSD-3-Clause
"""The publishes of the spec as publications, while somebody subscribes to them."""

from __future__ import annotations

import logging
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from unitylink.errors import UnityLinkError

from ..schema import Field, Layout
from .groups import Output

if TYPE_CHECKING:
    import zenoh

    from unitylink.layer2_message.native_link import Words
    from unitylink.spec.model import Spec, SubscriptionGroup

    from .groups import Groups

_OTHER = re.compile(r"[^A-Za-z0-9]+")
_DTYPES = {"f64": "<f8", "bool": "u1"}
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


class TypedRows:
    """Makes the bytes of typed values from rows of words, a column at a time."""

    def __init__(self, fields: Sequence[Field]) -> None:
        self._fields = tuple(fields)
        self._dtype = np.dtype([(one.path, _DTYPES.get(one.type, _integer(one.type))) for one in fields])
        self.row_bytes = self._dtype.itemsize

    def __call__(self, words: Words) -> bytes:
        """Return the bytes of all rows, one after the other."""
        rows = np.zeros(len(words), dtype=self._dtype)
        column = 0
        for field in self._fields:
            raw = words[:, column].astype(np.uint64)
            for more in range(1, field.codec.words):
                raw |= words[:, column + more].astype(np.uint64) << np.uint64(field.codec.data_bits * more)
            column += field.codec.words
            raw &= np.uint64(field.codec.mask)
            rows[field.path] = raw if field.packed else field.codec.decode_array(raw)
        return rows.tobytes()


def _integer(kind: str) -> str:
    return f"<{kind[0]}{int(kind[1:]) // 8}" if kind[0] in "iu" else ""


class Topics:
    """Joins the groups of the spec for as long as their publications have subscribers."""

    def __init__(
        self, spec: Spec, fields: dict[str, Field], publishers: dict[str, zenoh.Publisher], groups: Groups
    ) -> None:
        self._groups, self._publishers = groups, publishers
        self._named = topic_names(spec)
        self._rows = {
            name: TypedRows([fields[element.path] for element in group.elements])
            for name, group in self._named.items()
        }
        self._joined: dict[str, int] = {}
        self.failed: dict[str, str] = {}

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
                topic=Output(publisher.put, self._rows[name], self._rows[name].row_bytes),
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
