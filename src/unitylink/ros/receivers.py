# SPDX-License-Identifier: BSD-3-Clause
"""From one message to the values that are written. There is a function for each topic."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from itertools import pairwise
from math import isnan
from typing import Any

from unitylink.errors import ValueRangeError

from .interface import JOINTS, RECORD, SCALAR, Interface, Topic

Read = Callable[[Any], dict[str, Any]]  # message -> value by path


def receiver(interface: Interface, topic: Topic) -> Read:
    """Return a function that reads a topic's messages.

    It raises ValueRangeError for a message that makes no sense.
    """
    if topic.form == SCALAR:
        path = topic.paths[0]
        return lambda message: {path: message.data}
    if topic.form == RECORD:
        return _record(interface, topic)
    if topic.form == JOINTS:
        return _joints(topic)
    axes = [axis.split("_") for axis in topic.axes]

    def twist(message: Any) -> dict[str, Any]:
        numbers = [getattr(getattr(message, kind), axis) for kind, axis in axes]
        return dict(zip(topic.paths, numbers, strict=True))

    return twist


def _record(interface: Interface, topic: Topic) -> Read:
    fields = interface.message(topic).fields
    inner = {message.name: message for message in interface.messages}
    starts = [0]
    for field in fields:
        starts.append(starts[-1] + max(1, field.count))

    def read(message: Any) -> dict[str, Any]:
        numbers: dict[str, Any] = {}
        for field, (start, end) in zip(fields, pairwise(starts), strict=True):
            given = getattr(message, field.name)
            values: Sequence[Any] = given if field.count else (given,)
            if len(values) != end - start:
                raise ValueRangeError(
                    f"{topic.name}: {field.name} has {len(values)} values, not {end - start}"
                )
            if field.members:
                names = [one.name for one in inner[field.type].fields]
                values = [
                    {own: getattr(value, name) for own, name in zip(field.members, names, strict=True)}
                    for value in values
                ]
            numbers.update(zip(topic.paths[start:end], values, strict=True))
        return numbers

    return read


def _joints(topic: Topic) -> Read:
    joints = {joint.name: joint for joint in topic.joints}
    known = ", ".join(joints)

    def read(message: Any) -> dict[str, Any]:
        numbers: dict[str, Any] = {}
        names = list(message.name)
        if len(set(names)) < len(names):
            twice = Counter(names).most_common(1)[0][0]
            raise ValueRangeError(f"{topic.name}: the joint {twice!r} is named twice; name each once")
        for part in ("position", "velocity", "effort"):
            values = getattr(message, part)
            if len(values) not in (0, len(names)):
                raise ValueRangeError(f"{topic.name}: {len(values)} values of {part} for {len(names)} names")
            for name, value in zip(names, values, strict=False):
                joint = joints.get(name)
                if joint is None:
                    raise ValueRangeError(f"{topic.name}: no joint is called {name!r}; there are {known}")
                at = getattr(joint, part)
                if isnan(value):  # a NaN is kept
                    continue
                if at < 0:
                    raise ValueRangeError(f"{topic.name}: the {part} of {name} cannot be set; leave it out")
                numbers[topic.paths[at]] = value / getattr(joint, f"{part}_factor")
        if not numbers:
            raise ValueRangeError(f"{topic.name}: the message sets no joint; name one of {known}")
        return numbers

    return read
