# SPDX-License-Identifier: BSD-3-Clause
import json

import pytest

from unitylink.server.audit import Audit
from unitylink.server.rate_limit import RateLimit


def test_a_text_from_outside_stays_in_its_line():
    lines = []
    Audit(lines.append).line("refused", 0.25, where='x\n{"event": "login"}\x1b[31m', part=None)
    assert len(lines[0].splitlines()) == 1
    assert "\x1b" not in lines[0]
    assert json.loads(lines[0])["where"].startswith("x\n")
    assert "part" not in json.loads(lines[0])


def test_an_unknown_event_is_a_mistake_of_the_program():
    with pytest.raises(ValueError, match="no event of the audit log"):
        Audit(print).line("lgoin", 0.0)


def test_a_rate_is_kept_over_any_pattern():
    limit = RateLimit(rate_hz=100.0, burst=10)
    allowed = sum(limit.allow(now_s=number / 1000) for number in range(5000))
    assert allowed == 10 + 499
    assert limit.refused == 5000 - allowed


def test_a_clock_that_goes_back_gives_nothing():
    limit = RateLimit(rate_hz=1.0, burst=1)
    assert limit.allow(5.0)
    assert not limit.allow(1.0)
    assert limit.wait_s() == 1.0
