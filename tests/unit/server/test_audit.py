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


def test_lines_for_which_there_is_no_place_are_counted_and_told(capsys):
    lines, held, taken = [], threading.Event(), threading.Event()

    def put(line):
        taken.set()
        held.wait(20)
        lines.append(line)

    audit = Audit(put, apart=True)
    audit.line("up", 0.0)
    assert taken.wait(20)
    for number in range(MOST + 3):
        audit.line("stop", 0.0, number=number)
    assert not lines and audit.unwritten == 3
    held.set()
    until(lambda: len(lines) == MOST + 1)
    audit.close()
    assert json.loads(lines[1])["number"] == 3
    assert "3 older lines of the log are left out" in capsys.readouterr().err
