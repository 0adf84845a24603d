# SPDX-License-Identifier: BSD-3-Clause
"""A reference device that publishes as the gateware does: by strobes, events and a line that may be busy.

`ReferenceDevice.tick` publishes every group that is due at once. This device also says in which order groups
publish, and what is left out while the line has no room.
"""

from __future__ import annotations

from reference.bus import Bus
from reference.device import ReferenceDevice
from reference.requests import Request
from reference.settings import Settings
from reference.state import Group
from unitylink import protocol as p


class PublishingDevice(ReferenceDevice):
    """A device whose strobes, events and free line its user plays."""

    def __init__(self, settings: Settings, bus: Bus | None = None, nonce: int = 0) -> None:
        self.served = 0
        super().__init__(settings, bus, nonce)

    def _begin_session(self, epoch: int, flags: int) -> None:
        super()._begin_session(epoch, flags)
        count = self.settings.groups
        self.strobes = [0] * count  # of each group, towards its divisor
        self.due = [False] * count
        self.tripped_events = [False] * count

    def _execute(self, request: Request, *, repeated: bool) -> tuple[int, bytes]:
        number = request.address
        defines = request.operation == p.REQUEST_KIND_DEFINE_GROUP and not repeated
        before = self.groups[number] if defines else Group()
        was_on = self.publishing
        answer = super()._execute(request, repeated=repeated)
        if defines:
            runs = before.addresses and before.divisor
            if not runs or self.strobes[number] >= request.value:
                self.strobes[number] = 0
            self.due[number] = self.tripped_events[number] = False
        self.began = self.publishing and not was_on
        return answer

    def _refusal(self, request: Request, *, repeated: bool) -> int:
        defines = request.operation == p.REQUEST_KIND_DEFINE_GROUP and request.address < self.settings.groups
        if defines and request.value >= 1 << 8 * p.SMALL_ENGINE_RATE_BYTES:
            return p.REPLY_STATUS_INVALID  # the gateware does not count so far
        return super()._refusal(request, repeated=repeated)

    def take(self, piece: bytes) -> bytes:
        """Take a piece. When publishing begins, the first strobe comes at once."""
        self.began = False
        answer = super().take(piece)
        return answer + (self.strobe() + self.serve() if self.began else b"")

    def strobe(self) -> bytes:
        """Count a base strobe. Groups become due; nothing is sent."""
        for number, group in enumerate(self.groups if self.publishing else ()):
            if group.addresses and group.divisor:
                self.strobes[number] += 1
                if self.strobes[number] == group.divisor:
                    self.strobes[number] = 0
                    if self.due[number]:
                        self._count(p.CONTROL_PUBLISH_OVERRUNS)
                    self.due[number] = True
        return b""

    def event(self, groups: int) -> None:
        """Take an edge of the event inputs of `groups`, as bits."""
        for number, group in enumerate(self.groups):
            if groups >> number & 1 and group.addresses and group.flags & p.FRAME_EVENT_FLAG:
                self.tripped_events[number] = True

    def serve(self) -> bytes:
        """Publish all that is due: downwards and around, from the group that was served last."""
        sent = b""
        while self.publishing and (wanting := [*map(max, self.due, self.tripped_events)]).count(True):
            below = [number for number in range(self.served) if wanting[number]]
            number = max(below or [n for n, wants in enumerate(wanting) if wants])
            self.served = number
            (self.due if self.due[number] else self.tripped_events)[number] = False
            sent += self.publish(number)
        return sent
