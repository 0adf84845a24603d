# SPDX-License-Identifier: BSD-3-Clause
"""The measurement of publishes distinguishes a stack that takes all from one that does not."""

from __future__ import annotations

import time
from typing import Any

import pytest
from reference.framing import Frame

from unitylink import protocol as p
from unitylink.layer4_data import Recording
from unitylink.layer4_data.publication import Publication
from unitylink_lab.experiments import sustained
from unitylink_lab.experiments.publish_limits import frame_bytes


@pytest.mark.parametrize("protocol", ["classic", "framed"])
@pytest.mark.parametrize("words", [1, 255])
def test_a_slow_stream_comes_whole(protocol: str, words: int) -> None:
    trial = sustained.offer(protocol, words, 500, window_s=0.1)
    assert trial.limit != "stack"  # a busy machine may hold up the source
    assert trial.rate_hz > 0


def test_a_stack_that_loses_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("unitylink.layer4_data.publishing.RING_MOST", 8)
    deliver = Publication.deliver_arrays

    def late(self: Publication, times: Any, words: Any) -> bool:
        time.sleep(0.02)
        return deliver(self, times, words)

    monkeypatch.setattr(Publication, "deliver_arrays", late)
    trial = sustained.offer("framed", 1, 20_000, window_s=0.1)
    assert not trial.complete and trial.limit == "stack"


def test_a_recording_that_keeps_less_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        Recording, "_take_arrays", lambda self, times, values, raws: self._take(0, values, [], raws[0])
    )
    assert sustained.offer("classic", 1, 20_000, window_s=0.1).limit == "stack"


@pytest.mark.parametrize("words", [1, 60, 61, 62, 128, 255])
def test_the_bytes_of_a_publish_are_those_of_the_reference(words: int) -> None:
    whole = Frame(p.DEVICE_KIND_PUBLISH, bytes([1] * (7 + 4 * words))).encode(0x1234)
    assert frame_bytes(words) == len(whole)
