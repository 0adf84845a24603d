# SPDX-License-Identifier: BSD-3-Clause
"""From the values of one publish to one message. The function of a topic has nothing left to look up."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

from .interface import JOINTS, ODOMETRY, SCALAR, SENSOR, Field, Interface, Topic
from .message_parts import Part, message_maker
from .odometry import Odometry
from .plane import Plane, Port
from .sensors import SENSORS

# takes time_s of time.monotonic(), and values in the order of the paths
Send = Callable[[float, Sequence[Any]], None]
JOINT_STATE = ("header", "name", "position", "velocity", "effort")


def sender(interface: Interface, topic: Topic, plane: Plane) -> Send:
    """Advertise a topic and return the function that publishes on it."""
    port = plane.advertise(topic)
    if topic.form == SCALAR:
        return _scalar(topic, plane, port)
    if topic.form == JOINTS:
        return _joints(topic, plane, port)
    if topic.form == SENSOR:
        return _sensor(topic, plane, port)
    if topic.form == ODOMETRY:
        return _odometry(topic, plane, port)
    return _record(interface, topic, plane, port)


def _scalar(topic: Topic, plane: Plane, port: Port) -> Send:
    make, put, wanted = plane.maker(topic.type, ("data",)), port.send, port.wanted

    def send(time_s: float, numbers: Sequence[Any]) -> None:
        if wanted():
            put(make(numbers[0]))

    return send


def _record(interface: Interface, topic: Topic, plane: Plane, port: Port) -> Send:
    message = interface.message(topic)
    make = plane.maker(topic.type, ("header", "sequence", *(field.name for field in message.fields)))
    put, wanted, header, frame = port.send, port.wanted, plane.header, topic.frame
    pack = (
        None if all(_plain(field) for field in message.fields) else packer(interface, message.fields, plane)
    )
    sequence = 0

    def send(time_s: float, numbers: Sequence[Any]) -> None:
        nonlocal sequence
        sequence = sequence + 1 & 0xFFFFFFFF  # counts all publishes, with or without a reader
        if wanted():
            put(make(header(time_s, frame), sequence, *(numbers if pack is None else pack(numbers))))

    return send


def _plain(field: Field) -> bool:
    return not field.count and not field.members


def packer(
    interface: Interface, fields: Sequence[Field], plane: Plane
) -> Callable[[Sequence[Any]], list[Any]]:
    """Return a function that turns values into a message's fields, including arrays and packed values."""
    inner = {message.name: message for message in interface.messages}
    makers = [
        plane.maker(f"{interface.package}/{field.type}", [one.name for one in inner[field.type].fields])
        if field.members
        else None
        for field in fields
    ]

    def pack(numbers: Sequence[Any]) -> list[Any]:
        packed: list[Any] = []
        at = 0
        for field, make in zip(fields, makers, strict=True):
            part = list(numbers[at : at + max(1, field.count)])
            at += len(part)
            if make is not None:
                part = [make(*(getattr(record, name) for name in field.members)) for record in part]
            packed.append(part if field.count else part[0])
        return packed

    return pack


def _joints(topic: Topic, plane: Plane, port: Port) -> Send:
    make = plane.maker(topic.type, JOINT_STATE)
    put, wanted, header, frame = port.send, port.wanted, plane.header, topic.frame
    names = [joint.name for joint in topic.joints]
    columns = []
    for part in ("position", "velocity", "effort"):
        column = [(getattr(joint, part), getattr(joint, f"{part}_factor")) for joint in topic.joints]
        # if other joints have a part that this one lacks, it gets a NaN
        whole = all(at >= 0 for at, _ in column)
        some = any(at >= 0 for at, _ in column)
        columns.append((column if some else [], whole))
    nan = float("nan")

    def send(time_s: float, numbers: Sequence[Any]) -> None:
        if not wanted():
            return
        parts = [
            [numbers[at] * factor for at, factor in column]
            if whole
            else [numbers[at] * factor if at >= 0 else nan for at, factor in column]
            for column, whole in columns
        ]
        put(make(header(time_s, frame), names, *parts))

    return send


def _sensor(topic: Topic, plane: Plane, port: Port) -> Send:
    def value(index: int, by: float) -> Part:
        return lambda _, numbers: numbers[index] * by

    parts = {field: value(i, by) for i, (field, by) in enumerate(zip(topic.axes, topic.factors, strict=True))}
    constants = SENSORS[topic.type.partition("/")[2]].constants
    make = message_maker(plane, topic.type, parts, constants)
    put, wanted, header, frame = port.send, port.wanted, plane.header, topic.frame

    def send(time_s: float, numbers: Sequence[Any]) -> None:
        if wanted():
            put(make(header(time_s, frame), numbers))

    return send


def _odometry(topic: Topic, plane: Plane, port: Port) -> Send:
    left_by, right_by, radius_m, track_m = topic.factors
    place = Odometry(radius_m, track_m)
    parts: dict[str, Part] = {
        "child_frame_id": lambda *_: "base_link",
        "pose.pose.position.x": lambda *_: place.x_m,
        "pose.pose.position.y": lambda *_: place.y_m,
        "pose.pose.orientation.z": lambda *_: math.sin(place.heading / 2),
        "pose.pose.orientation.w": lambda *_: math.cos(place.heading / 2),
        "twist.twist.linear.x": lambda *_: place.speed,
        "twist.twist.angular.z": lambda *_: place.turn,
    }
    make = message_maker(plane, topic.type, parts, {})
    put, wanted, header, frame = port.send, port.wanted, plane.header, topic.frame

    def send(time_s: float, numbers: Sequence[Any]) -> None:
        place.turned(time_s, numbers[0] * left_by, numbers[1] * right_by)  # with or without a reader
        if wanted():
            put(make(header(time_s, frame), ()))

    return send
