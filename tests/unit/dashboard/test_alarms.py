# SPDX-License-Identifier: BSD-3-Clause
"""Alarms: no excursion is missed, however short, and each is in the list until somebody has seen it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from unit.dashboard.robot import Robot, compiled, robot

from unitylink.dashboard.alarms import Alarms
from unitylink.dashboard.feed import Portion
from unitylink.errors import UnknownName
from unitylink.server.rate_limit import RateLimit


class Item:
    def __init__(self, path: str) -> None:
        from unitylink.values import Quantity

        elements = dict(compiled().walk())
        self.path, self.quantity, self.unit = path, Quantity.of(elements[path]), elements[path].unit


def portion(item: Any, *numbers: float) -> Portion:
    return Portion((item,), np.arange(len(numbers), dtype=float), [], [np.array(numbers)])


def test_an_alarm_from_its_begin_to_its_end() -> None:
    said: list[str] = []
    item: Any = Item("j1.angle")  # from -90 to 90
    alarms = Alarms([item], lambda kind, text: said.append(f"{kind}: {text}"))
    alarms.take(portion(item, 90.0, -90.0, np.nan))
    assert alarms.all() == [] and said == []
    alarms.take(portion(item, 0.0, 91.0, 95.5, 3.0))  # over before anybody has looked
    (one,) = alarms.all()
    assert (one.above, one.limit, one.worst, one.count) == (True, 90.0, 95.5, 1) and one.ended_s is not None
    assert said == ["alarm: j1.angle is above 90 deg: 95.5 deg"]
    alarms.take(portion(item, 92.0))
    alarms.take(portion(item, 93.0, 92.5))
    assert (one.count, one.worst, one.ended_s, one.seen_by) == (2, 93.0, None, "")
    alarms.acknowledge("j1.angle", "ana")
    assert alarms.all() == [one] and one.seen_by == "ana", "it lasts"
    alarms.take(portion(item, 5.0))
    assert alarms.all() == [], "it is over, and has been seen"
    alarms.take(portion(item, -91.0, -99.0, -95.0))
    (low,) = alarms.all()
    assert (low.above, low.limit, low.worst) == (False, -90.0, -99.0)
    alarms.take(portion(item, 0.0))
    alarms.acknowledge("j1.angle", "ben")
    assert alarms.all() == []
    with pytest.raises(UnknownName, match="has no alarm"):
        alarms.acknowledge("j1.angle", "ben")


@pytest.fixture(scope="module")
def arm() -> Iterator[Robot]:
    with robot() as served:
        served.page.app.logins = RateLimit(1000, 1000)
        yield served


def test_viewers_see_alarms_of_what_they_may_read(arm: Robot) -> None:
    with arm.viewer("cem") as cem, arm.viewer("ben") as ben, arm.viewer("ana") as ana:
        arm.board.registers[0x11] = 901  # j1.angle, in tenths
        cem.until(lambda: cem.state("alarms"))
        (one,) = cem.state("alarms")
        assert one["item"] == cem.item("j1.angle") and one["worst"] == 90.1
        cem.until(lambda: any(event["kind"] == "alarm" for event in cem.events))
        ben.until(lambda: "alarms" in ben.told.get("state", {}))
        assert ben.state("alarms") == [], "ben reads j2 alone"
        assert "ben may not read it" in ben.ask("acknowledge", path="j1.angle")
        assert ana.ask("acknowledge", path="j1.angle") == ""
        cem.until(lambda: [alarm["seen_by"] for alarm in cem.state("alarms")] == ["ana"])
        arm.board.registers[0x11] = 0
        cem.until(lambda: cem.state("alarms") == [])
        assert "has no alarm" in ana.ask("acknowledge", path="j1.angle")
    seen = arm.log.until("acknowledge")
    assert [(line["user"], line["path"]) for line in seen] == [("ana", "j1.angle")]
