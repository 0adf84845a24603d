# SPDX-License-Identifier: BSD-3-Clause
"""A plant that plays a recording."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

from unitylink.errors import UnityLinkError
from unitylink.recording import RecordingTruncated, Sample, samples
from unitylink.spec.model import Element, Spec
from unitylink.values import Codec, Quantity

from ..registers import Registers


class RecordingPlant:
    """Sets every recorded READ to its value, at its time since the first sample.

    At the end, the last values stay. With `loop`, it begins again. `speed` 2.0 plays twice as fast. Writes of
    the PC have no effect.

    A recording that was cut off is played as far as it goes. `notice` then says so.
    """

    period_s: float = 0.001

    def __init__(self, path: str | Path, *, speed: float = 1.0, loop: bool = False) -> None:
        self.path = path
        self.speed = speed
        self.loop = loop
        self.notice = ""
        self.ended = False

    def attach(self, spec: Spec | None, registers: Registers) -> None:
        """Raise UnityLinkError if the recording has no value of the spec."""
        self._registers = registers
        bits = registers.data_bits
        elements = dict(spec.walk()) if spec else {}
        self._targets: dict[str, tuple[Element, Codec]] = {
            path: (element, Codec(path, Quantity.of(element), bits))
            for path, element in elements.items()
            if element.access in ("READ", "READCLEAR")
        }
        self._start()
        paths: dict[str, None] = {}  # the first samples may have only set-points
        for sample in self._whole(samples(self.path)):
            if sample.values.keys() & self._targets.keys():
                break
            paths.update(dict.fromkeys(sample.values))
        else:
            known = ", ".join(list(paths)[:3])
            raise UnityLinkError(
                f"{self.path}: has {known}, but no item that the spec reads; "
                "give the spec of the recording with --spec"
            )

    def _start(self) -> None:
        self._samples = iter(self._whole(samples(self.path)))
        self._next = next(self._samples, None)
        if self._next is None:
            raise UnityLinkError(
                f"{self.path}: there is no sample in it{': ' + self.notice if self.notice else ''}"
            )
        self._begin_s = self._next.time_s

    def _whole(self, found: Iterable[Sample]) -> Iterator[Sample]:
        try:
            yield from found
        except RecordingTruncated as error:
            self.notice = str(error)

    def step(self, time_s: float) -> None:
        """Set the values of `time_s` after the beginning."""
        if not hasattr(self, "_origin_s"):
            self._origin_s = time_s
        now_s = (time_s - self._origin_s) * self.speed
        while self._next is not None and self._next.time_s - self._begin_s <= now_s:
            self._set(self._next)
            self._next = next(self._samples, None)
            if self._next is None and self.loop:
                self._start()
                self._origin_s = time_s
                return
        self.ended = self._next is None

    def _set(self, sample: Sample) -> None:
        for path, value in sample.values.items():
            target = self._targets.get(path)
            if target is None or value is None:  # a word that the PC writes, or a value that is not a number
                continue
            element, codec = target
            for address, word in zip(element.addresses, codec.split(codec.encode(value)), strict=True):
                self._registers[address] = word
