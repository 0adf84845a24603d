# SPDX-License-Identifier: BSD-3-Clause
"""A writer of cyclonedds that puts several messages into one packet.

A packet costs more than the messages in it.
"""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Callable
from functools import cache
from typing import Any

_PADDING = (b"", b"\0\0\0", b"\0\0", b"\0")  # DDS takes whole words


class Here(threading.local):
    """Messages that a thread has written, but not yet sent. None while each one is sent by itself."""

    held: set[Callable[[], None]] | None = None


@cache
def gathering_writer() -> Any:
    """Return a class like cyclonedds' DataWriter. Its `write` sends at `flush()`, or when a packet is full.

    cyclonedds has both functions in C, but not yet in Python."""
    from cyclonedds import pub
    from cyclonedds.core import DDSException

    library = pub.DataWriter._dll_handle
    batch = library.dds_qset_writer_batching
    batch.argtypes, batch.restype = (ctypes.c_void_p, ctypes.c_bool), None
    send = library.dds_write_flush
    send.argtypes, send.restype = (ctypes.c_int32,), ctypes.c_int32

    class GatheringWriter(pub.DataWriter):  # type: ignore[type-arg]
        def _create_writer(self, publisher: Any, topic: Any, qos: Any, listener: Any) -> Any:
            batch(qos, True)
            return super()._create_writer(publisher, topic, qos, listener)

        def flush(self) -> None:
            """Send what has been written. Raises DDSException if DDS does not take it."""
            result = send(self._ref)
            if result < 0:
                self._refused(result)

        def sender(self, here: Here) -> Callable[[Any], None]:
            """Return a function that writes a message of the right type.

            It flushes unless `here` holds the message back.
            """
            reference, version_2, flush = self._ref, self._use_version_2, self.flush
            write = pub.ddspy_write  # type: ignore[attr-defined]

            # all in one function, because for a single message each call costs time
            def put(sample: Any) -> None:
                data = sample.serialize(use_version_2=version_2)
                result = write(reference, data + _PADDING[len(data) & 3])
                if result >= 0:
                    held = here.held
                    if held is None:
                        result = send(reference)
                    else:
                        held.add(flush)
                if result < 0:
                    self._refused(result)

            return put

        def _refused(self, result: int) -> None:
            raise DDSException(result, f"while sending what {self!r} has written")

    return GatheringWriter
