# SPDX-License-Identifier: BSD-3-Clause
"""What the budget promises stands beside what comes."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from unitylink.dashboard.feed import Portion
from unitylink.dashboard.promise import WINDOW_S, Promise
from unitylink.layer4_data.publication import PublishReport
from unitylink.spec import compile_text
from unitylink.spec.isochrony.budget import budget

TEXT = """
public arm() {
   @a = 0x1: u32 READ(PUBLISH(100 Hz));
   @b = 0x2: u32 READ(PUBLISH(100 Hz));
   @c = 0x3: READ();
}
"""
PATHS = ("a", "b")


def made(url: str) -> Promise:
    spec = compile_text(TEXT, "arm.ul").spec
    assert spec is not None
    link: Any = SimpleNamespace(url=url, protocol="framed")
    promise = Promise(spec, spec.root(), link)
    promise.begin(
        [PublishReport(url, True, 100.0, PATHS, 0, 0), PublishReport(url, False, 5.0, ("c",), 0, 0)]
    )
    return promise


def portion(*times_s: float) -> Portion:
    values: Any = tuple(SimpleNamespace(path=path) for path in PATHS)
    return Portion(values, np.array(times_s), [], [])


def test_the_bounds_are_those_of_the_budget() -> None:
    spec = compile_text(TEXT, "arm.ul").spec
    assert spec is not None
    (device,) = spec.devices
    (group,) = budget(device, baud_hz=3_000_000).groups
    promise = made("serial:/dev/null?baud=3000000&x=1")
    told = promise.told(PATHS)
    assert (told["sampled_s"], told["sent_s"]) == (group.sampled_s, group.latency_s) and group.sampled_s
    line = promise.line()
    assert (
        line is not None
        and line["baud_hz"] == 3_000_000
        and line["load"] == pytest.approx(line["bytes_per_s"] * 10 / 3_000_000)
    )
    assert promise.told(("c",)) == {"sampled_s": None, "sent_s": None, "off_s": None}


@pytest.mark.parametrize("url", ["sim:arm.ul", "serial:/dev/null?baud=fast", "serial:/dev/null?baud=0"])
def test_without_a_baud_rate_no_time_is_promised(url: str) -> None:
    promise = made(url)
    assert promise.told(PATHS)["sampled_s"] is None
    line = promise.line()
    assert line is not None and line["load"] is None and line["bytes_per_s"] > 0


def test_how_far_samples_were_from_their_distance() -> None:
    promise = made("sim:arm.ul")
    promise.take(portion(1.0))
    assert promise.told(PATHS)["off_s"] == 0.0
    promise.take(portion(1.01, 1.02))
    promise.take(portion(1.05, 1.0602))  # two were lost, which is no lateness
    assert promise.told(PATHS)["off_s"] == pytest.approx(0.0002)
    promise.take(portion(1.07 + WINDOW_S))
    assert promise.told(PATHS)["off_s"] == pytest.approx(0.0002), "the window before counts, too"
    promise.take(portion(1.08 + 3 * WINDOW_S, 1.09 + 3 * WINDOW_S))
    assert promise.told(PATHS)["off_s"] == pytest.approx(0.0, abs=1e-9)
