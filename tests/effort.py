# SPDX-License-Identifier: BSD-3-Clause
"""How many examples of a property are tried.

Most properties are tried with random examples: by hypothesis, or in a loop over a seed. `make long` tries all
of them, any other run a quarter. A loop over a seed has the marker `many`, so that `make long` finds it.

The examples of hypothesis differ from run to run. So many runs try what one long run does.
"""

from __future__ import annotations

import os

ALL = os.environ.get("UNITYLINK_EXAMPLES") == "all"
PART = 4  # one of so many examples is tried without ALL, but so many at least:
LEAST = 10


def many(count: int) -> int:
    """Return how many of `count` examples to try: all of them, or a quarter, but ten at least."""
    return count if ALL else min(count, max(LEAST, count // PART))
