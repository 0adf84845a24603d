# SPDX-License-Identifier: BSD-3-Clause
"""Which words of some values are read at once."""

from __future__ import annotations

from collections.abc import Sequence

from .published import PublishedValue


def portions(values: Sequence[PublishedValue], consistent: bool) -> list[tuple[list[int], bool]]:
    """Return the portions that are read at once: (addresses, atomic).

    A value of several words is never divided.
    """
    whole = [address for value in values for address in value.addresses]
    if consistent or len(whole) == len(values):
        return [(whole, consistent and len(whole) > 1)]
    limit = max(1, values[0].hardware.link.configuration.read_many)
    parts: list[tuple[list[int], bool]] = [([], True)]
    for value in values:
        if parts[-1][0] and len(parts[-1][0]) + value.codec.words > limit:
            parts.append(([], True))
        parts[-1][0].extend(value.addresses)
    return parts
