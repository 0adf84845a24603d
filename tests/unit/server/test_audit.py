# SPDX-License-Identifier: BSD-3-Clause
import json
import threading

import pytest

from tests.unit.server.test_serving import until
from unitylink.server.audit import MOST, Audit
from unitylink.server.log_file import LogFile
from unitylink.server.rate_limit import RateLimit


def test_a_text_from_outside_stays_in_its_line():
    lines = []
    Audit(lines.append).line("refused", 0.25, where='x\n{"event": "login"}\x1b[31m', part=None)
    assert len(lines[0].splitlines()) == 1
    assert "\x1b" not in lines[0]
    assert json.loads(lines[0])["where"].startswith("x\n")
    assert "part" not in json.loads(lines[0])


def test_a_line_that_cannot_be_written_is_counted_and_ends_nothing(capsys):
    lines, full = [], [True]

    def put(line):
        if full[0]:
            raise OSError(28, "No space left on device")
        lines.append(line)

    audit = Audit(put)
    for number in range(3):
        audit.line("stop", float(number))
    full[0] = False
    audit.line("arm", 3.0)
    assert audit.unwritten == 3 and len(lines) == 1
    assert capsys.readouterr().err.count("No space left on device") == 1


def test_lines_are_added_to_a_file(tmp_path):
    file = tmp_path / "audit.jsonl"
    for line in ("one", "two"):
        log = LogFile(str(file), "--audit")
        log.put(line)
        log.close()
    assert file.read_text() == "one\ntwo\n"


def test_half_a_line_spoils_no_other(tmp_path):
    class Full:  # takes four bytes, and then all
        taken = b""

        def write(self, data):
            part = data[:4] if not self.taken else data
            self.taken += part
            return len(part)

    log = LogFile(str(tmp_path / "audit.jsonl"), "--audit")
    log.close()
    log._file = full = Full()
    with pytest.raises(OSError, match="No space left"):
        log.put("lost line")
    log.put("whole")
    assert full.taken == b"lost\nwhole\n"


def test_a_full_disk():
    log = LogFile("/dev/full", "--audit")
    with pytest.raises(OSError, match="No space left"):
        log.put("line")
    log.close()


def test_an_unknown_event_is_a_mistake_of_the_program():
    with pytest.raises(ValueError, match="no event of the audit log"):
        Audit(print).line("lgoin", 0.0)


def test_a_rate_is_kept_over_any_pattern():
    limit = RateLimit(rate_hz=100.0, burst=10)
    allowed = sum(limit.allow(now_s=number / 1000) for number in range(5000))
    assert allowed == 10 + 499
    assert limit.refused == 5000 - allowed


def test_a_clock_that_goes_back_gives_nothing():
    limit = RateLimit(rate_hz=1.0, burst=1)
    assert limit.allow(5.0)
    assert not limit.allow(1.0)
    assert limit.wait_s() == 1.0


def test_nobody_waits_for_a_log_that_hangs():
    lines, held = [], threading.Event()

    def put(line):
        held.wait(20)
        lines.append(line)

    audit = Audit(put, apart=True)
    for number in range(MOST + 3):
        audit.line("stop", 0.0, number=number)
    assert not lines and audit.unwritten in (2, 3)  # the thread may have one already
    held.set()
    until(lambda: len(lines) > 100)
    audit.close()
    assert [json.loads(line)["number"] for line in lines[:100]] == list(range(100))


def test_the_end_writes_the_lines_that_wait():
    lines = []
    audit = Audit(lines.append, apart=True)
    for number in range(100):
        audit.line("stop", 0.0, number=number)
    audit.close()
    assert len(lines) == 100
