# SPDX-License-Identifier: BSD-3-Clause
"""A program always ends with one line and an exit code, whatever ends it."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import pytest

from unitylink.errors import UrlError
from unitylink.program import ended_by_signals, run_program, stopped_by_signals

EXAMPLES = Path(__file__).resolve().parents[3] / "examples"


@pytest.mark.parametrize(
    ("error", "code", "said"),
    [
        (UrlError("no such scheme"), 1, "arm: no such scheme\n"),
        (FileNotFoundError(2, "No such file", "arm.ul"), 1, "arm: arm.ul: No such file\n"),
        (OSError("out of luck"), 1, "arm: out of luck\n"),
        (KeyboardInterrupt(), 130, ""),
    ],
)
def test_errors_are_lines_and_codes(
    error: BaseException, code: int, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    def main() -> int:
        raise error

    with pytest.raises(SystemExit) as ended:
        run_program(main, name="arm")
    assert (ended.value.code, capsys.readouterr().err) == (code, said)


@pytest.mark.parametrize("code", [0, 3])
def test_the_code_is_that_of_main(code: int) -> None:
    with pytest.raises(SystemExit) as ended:
        run_program(lambda: code, name="arm")
    assert ended.value.code == code


def test_a_signal_stops_or_ends_the_program_and_handlers_are_restored() -> None:
    before = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)]
    for number in (signal.SIGINT, signal.SIGTERM):
        with stopped_by_signals() as stop:
            os.kill(os.getpid(), number)
            assert stop.wait(60)
        with pytest.raises(KeyboardInterrupt), ended_by_signals():
            os.kill(os.getpid(), number)
            stop.wait(60)
    assert [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)] == before
