# SPDX-License-Identifier: BSD-3-Clause
"""The language server: how long an editor waits for the diagnostics of an edit."""

from __future__ import annotations

from statistics import median

from .figure import Figure, Run
from .language_client import LanguageClient
from .start_up import flat_spec
from .timing import times

LINES = 500


def measure(run: Run) -> Figure:
    """Measure the time from sending a changed text of 500 lines to getting its diagnostics, through pipes."""
    uri = "file:///flat.ul"
    right = flat_spec(LINES - 3)
    middle = right.index(";", len(right) // 2)
    texts = [right[:middle] + right[middle + 1 :], right]  # a `;` is removed and put back in turns
    with LanguageClient() as client:
        client.open(uri, right)
        version = iter(range(1, 1 << 30))

        def edit() -> None:
            number = next(version)
            client.change(uri, number, texts[(number - 1) % 2])

        edit()  # the first answer is slower, because the server imports modules late
        samples = times(edit, run.rounds(60, 4))
    details = {"slowest ms": max(samples) / 1e6}
    title = f"language server, an edit in {LINES} lines"
    return Figure("language-server", title, 50, True, median(samples) / 1e6, "ms", details)
