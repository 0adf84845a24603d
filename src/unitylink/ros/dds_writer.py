# SPDX-License-Identifier: BSD-3-Clause
"""A writer of cyclonedds which puts several messages into one packet, which costs more than they do."""

from __future__ import annotations

import ctypes
from functools import cache
from typing import Any


@cache
def gathering_writer() -> Any:
    """Return a class like cyclonedds' DataWriter: what `write` takes goes out at `flush()`, or when a packet
    is full. cyclonedds has both in C, not yet in Python."""
    from cyclonedds.core import DDSException
    from cyclonedds.pub import DataWriter

    library = DataWriter._dll_handle
    batch = library.dds_qset_writer_batching
    batch.argtypes, batch.restype = (ctypes.c_void_p, ctypes.c_bool), None
    send = library.dds_write_flush
    send.argtypes, send.restype = (ctypes.c_int32,), ctypes.c_int32

    class GatheringWriter(DataWriter):  # type: ignore[type-arg]
        def _create_writer(self, publisher: Any, topic: Any, qos: Any, listener: Any) -> Any:
            batch(qos, True)
            return super()._create_writer(publisher, topic, qos, listener)

        def flush(self) -> None:
            """Send what was written; raise DDSException where DDS does not take it."""
            result = send(self._ref)
            if result < 0:
                raise DDSException(result, f"while sending what {self!r} has written")

    return GatheringWriter
