# SPDX-License-Identifier: BSD-3-Clause
"""Whatever stalls, and for however long: replies and publishes are whole, equal, and in the same order."""

from __future__ import annotations

import random
import re
from dataclasses import replace
from typing import Any

import pytest

from unitylink_lab.conformance.bench import bench, play_on_twin

# Two groups have rates, two have edge events. A lone head ends a message for which a lite datalink still
# waits.
CONFIGURATION = bench({"SG": 2, "SW": 3, "FREQ": 5000, "IRQEDGE": 0b1100})
SETTINGS = (
    "#WSA:0003101112\n#WSR:000001\n#WSA:010120\n#WSR:010002\n"
    "#WSA:02084041424344454647\n#WSA:030130\n#WIC:000c\n"
)
WHOLE = re.compile(
    rb"#[A-Z_]+(:[0-9a-f,]*)?\n|\$[A-Z_]+(:[0-9a-f,]*)?\*[0-9a-f]{2}\n|[#$]\?E_[A-Z]{3}\n|\?f[0-9a-c]\n"
    rb"|%PUB:00034[0-9a-f]{23}\n|%PUB:01014[0-9a-f]{7}\n|%PUB:02084[0-9a-f]{63}\n|%PUB:03014[0-9a-f]{7}\n"
)


def burst(r: random.Random) -> str:
    requests = [
        f"#R:{r.randrange(0x60):02x}\n",
        f"#W:5{r.randrange(16):x}{r.randrange(1 << 32):08x}\n",
        f"#RM:04{r.randbytes(4).hex()}\n".replace("e", "4").replace("f", "5"),
        "$R:12*58\n",
        "$R:12*59\n",
        "#R:zz\n",
        "#R:E0\n",
        "#RSI:02\n",
        "#RLC\n",
    ]
    return "".join(r.choice(requests) for _ in range(12))


def exchanges(seed: int) -> list[list[tuple[str, Any]]]:
    r = random.Random(seed)
    made: list[list[tuple[str, Any]]] = [
        [("send", SETTINGS), ("quiet", 500)],
        [("send", "#EPS\n"), ("quiet", 900)],
    ]
    for _ in range(12):
        steps: list[tuple[str, Any]] = [("events", r.choice((0b0100, 0b1000, 0b1100)))]
        made.append([*steps, ("send", burst(r) + "#\n"), ("events", 0), ("quiet", 900)])
    return made


def parted(answer: bytes) -> tuple[list[bytes], list[bytes], list[bytes]]:
    """Return the replies, the errors reported by the datalink, and the publishes by event."""
    lines = answer.splitlines(keepends=True)
    assert all(WHOLE.fullmatch(line) for line in lines), lines
    replies = [line for line in lines if line[:1] in b"#$"]
    events = sorted(line for line in lines if line[:7] in (b"%PUB:02", b"%PUB:03"))
    return replies, [line for line in lines if line[:1] == b"?"], events


@pytest.mark.parametrize(
    ("stalls", "seed", "datalink"),
    [
        ({"stall_percent": 75}, 1, "full"),
        ({"bus_stall_percent": 85}, 2, "full"),
        ({"stall_percent": 50, "bus_stall_percent": 50}, 3, "full"),
        ({"stall_percent": 30, "bus_stall_percent": 80}, 4, "lite"),
        ({"stall_percent": 80, "bus_stall_percent": 30}, 5, "lite"),
        ({"physical": "ft245_async", "stall_percent": 30}, 6, "full"),
        ({"physical": "ft245_sync", "stall_percent": 30}, 7, "full"),
    ],
    ids=["streams", "bus", "both", "lite bus", "lite streams", "ft245_async", "ft245_sync"],
)
def test_replies_and_publishes(rtl: Any, stalls: dict[str, int | str], seed: int, datalink: str) -> None:
    steps, configuration = exchanges(seed), replace(CONFIGURATION, datalink=datalink)
    expected = [parted(answer) for answer in play_on_twin(configuration, steps)]
    unstalled = rtl(configuration, steps)
    stalled = rtl(configuration, steps, seed=seed, **stalls)
    assert [parted(answer) for answer in unstalled] == expected
    assert [parted(answer) for answer in stalled] == expected
    assert sum(len(events) for _, _, events in expected) > 12
    for answers in (unstalled, stalled):
        rates = {
            line for answer in answers for line in answer.splitlines() if line[:7] in (b"%PUB:00", b"%PUB:01")
        }
        assert rates == {b"%PUB:000340de101040de111140de1212", b"%PUB:010140de2020"}
