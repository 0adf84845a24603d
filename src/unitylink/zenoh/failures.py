# SPDX-License-Identifier: BSD-3-Clause
"""Errors on the wire: the name of the error, the text, and the address. No I/O."""

from __future__ import annotations

import json

from unitylink import errors
from unitylink.errors import LinkError, UnityLinkError

_NAMES = (
    *("LinkTimeout", "OutcomeUnknown", "LinkClosed", "LinkDown", "LinkBusy", "BusError", "ProtocolError"),
    *("AccessRefused", "LeaseHeld", "DeadManTripped", "DeviceMismatch", "NetworkError", "UnexpectedValue"),
    *("ValueRangeError", "UnknownName"),
)
_KINDS: dict[str, type[UnityLinkError]] = {name: getattr(errors, name) for name in _NAMES}
_TEXT_MAX = 500


def encode_failure(error: UnityLinkError) -> bytes:
    """Return the bytes that tell an error.

    >>> encode_failure(errors.ValueRangeError("j1.goal: NaN"))
    b'{"error":"ValueRangeError","text":"j1.goal: NaN"}'
    """
    names = [one.__name__ for one in type(error).__mro__]
    kind = next((name for name in names if name in _KINDS), "UnityLinkError")
    told: dict[str, object] = {"error": kind, "text": str(error)[:_TEXT_MAX]}
    address = getattr(error, "address", None)
    if address is not None:
        told["address"] = address
    return json.dumps(told, separators=(",", ":")).encode()


def decode_failure(data: bytes) -> UnityLinkError:
    """Return the error that these bytes tell. Bytes that are no error are one, too.

    >>> decode_failure(b'{"error":"LeaseHeld","text":"ana holds j1"}')
    LeaseHeld('ana holds j1')
    >>> decode_failure(b"Timeout")
    ProtocolError('an answer that is no error: Timeout')
    """
    try:
        told = json.loads(data[:4096])
        kind, text, address = str(told["error"]), str(told["text"])[:_TEXT_MAX], told.get("address")
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
        shown = data[:80].decode("utf-8", "replace")
        return errors.ProtocolError(f"an answer that is no error: {shown}")
    named = _KINDS.get(kind, LinkError)
    if issubclass(named, LinkError):  # the others have no address
        return named(text, address=address if isinstance(address, int) else None)
    return named(text)
