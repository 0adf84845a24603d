# SPDX-License-Identifier: BSD-3-Clause
"""The twin equals the recordings of the 2012 gateware, and the replay notices if it does not."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from unitylink.layer1_stream import ClassicDecoder, Reply
from unitylink.simulate import BoardConfiguration
from unitylink_lab.conformance.bench import play_on_twin, same
from unitylink_lab.conformance.replay import RecordingError, Report, difference, render, replay

FILE = Path(__file__).with_name("classic-transcripts.json")


@pytest.fixture(scope="module")
def report() -> Report:
    return replay(FILE)


def test_all_required_exchanges_are_equal(report: Report) -> None:
    wrong = ["\n".join(difference(e)) for e in report.exchanges if e.status == "required" and not e.passed]
    assert not wrong, "\n\n".join(wrong)
    assert report.passed == 366
    assert report.failed == 0


def test_all_defects_are_answered_rightly(report: Report) -> None:
    wrong = ["\n".join(difference(e)) for e in report.exchanges if e.status == "defect" and not e.passed]
    assert not wrong, "\n\n".join(wrong)
    assert report.count("defect", True) == 57
    assert all(e.reason for e in report.exchanges if e.status == "defect")


def test_all_optional_exchanges_are_equal(report: Report) -> None:
    assert report.count("optional", True) == 16
    assert report.count("optional", False) == 0


def test_the_twin_of_the_2012_gateware_has_its_defects() -> None:
    """It answers what was recorded, right or wrong.

    Two recordings end in the middle of a message that never ends.
    """

    def published(configuration: BoardConfiguration, exchanges: Any) -> list[bytes]:
        return play_on_twin(replace(configuration, published_2012=True, protocol="classic"), exchanges)

    played = replay(FILE, published).exchanges
    different = [e for e in played if not same(e.compare, e.recorded, e.got)]
    assert [(e.run, e.name) for e in different] == [(9, "fullgrp_pub"), (12, "pub_to_dps")]
    for exchange in different:
        size = min(len(exchange.recorded), len(exchange.got))
        assert size >= 600
        assert exchange.recorded[:size] == exchange.got[:size]
    assert len(played) == 439


def test_only_the_reply_cnf_has_bytes_that_are_not_digits() -> None:
    """A 2C in the data of other replies is two digits, and its checksum counts it so."""
    replies = {line for e in replay(FILE).exchanges for line in e.recorded.splitlines()}
    assert all("CNF" in line for line in replies if "," in line)
    with_2c = [line for line in replies if line.startswith("$") and "2c2c" in line]
    events = [event for line in with_2c for event in ClassicDecoder().feed(line.encode() + b"\n")]
    assert {type(event) for event in events} == {Reply} and len(events) >= 2


def test_the_last_line_is_the_verdict(report: Report, capsys: pytest.CaptureFixture[str]) -> None:
    render(report)
    lines = capsys.readouterr().out.splitlines()
    assert lines[-1] == "366 passed, 0 failed"
    assert "57/57" in lines[-3]


def recording(**changes: Any) -> dict[str, Any]:
    exchange = {
        "name": "read",
        "steps": [["send", "#R:12\n"], ["quiet", 150]],
        "response": "#S_R:40de1212\n",
        "status": "required",
        "compare": "exact",
    }
    return {"runs": [{"run": 0, "config": {"AW": 8, "DW": 32}, "exchanges": [{**exchange, **changes}]}]}


def write(folder: Path, document: Any) -> Path:
    file = folder / "recordings.json"
    file.write_text(document if isinstance(document, str) else json.dumps(document), encoding="utf-8")
    return file


def test_a_difference_fails_and_is_shown(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    report = replay(write(tmp_path, recording(response="#S_R:40de1213\n")))
    assert (report.passed, report.failed, report.ok) == (0, 1, False)
    render(report)
    out = capsys.readouterr().out
    assert "#S_R:40de1213" in out
    assert "differs from byte 12" in out
    assert out.splitlines()[-1] == "0 passed, 1 failed"


@pytest.mark.parametrize(
    ("document", "words"),
    [
        ("{", "not JSON"),
        ("[]", '"runs"'),
        ({"runs": []}, "no required exchange"),
        ({"runs": [7]}, "runs[0]"),
        (recording(status="wished"), "status is 'wished'"),
        (recording(compare="nearly"), "compare is 'nearly'"),
        (recording(steps=[["shout", "hello"]]), "shout"),
        (recording(steps=[["wait", -1]]), "wait"),
        (recording(steps=[["wait", 10**15]]), "wait"),
        (recording(steps=[]), "steps are missing"),
        (recording(response=None), "response is missing"),
        (recording(status="defect"), "the right answer instead"),
        ({"runs": [{"run": 0, "config": {"AW": 99}, "exchanges": []}]}, "out of range"),
        ({"runs": [{"run": 0, "config": {"COLOUR": 1}, "exchanges": []}]}, "COLOUR"),
    ],
)
def test_a_file_that_is_none(tmp_path: Path, document: Any, words: str) -> None:
    with pytest.raises(RecordingError) as caught:
        replay(write(tmp_path, document))
    assert words in str(caught.value)


def test_no_such_file(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="No such file"):
        replay(tmp_path / "absent.json")


@pytest.mark.parametrize(
    ("rule", "expected", "got", "equal"),
    [
        ("exact", "a\n", "a\n", True),
        ("exact", "a\n", "a", False),
        ("rate", "#S\n%P1\n%P2\n", "#S\n%P1\n", True),
        ("rate", "#S\n%P1\n%P2\n", "#S\n", False),
        ("rate", "#S\n%P1\n", "#S\n%P2\n", False),
        ("rate", "#S\n%P1\n", "%P1\n", False),
        ("any_count", "#S\n%P1\n%P1\n%P1\n", "%P1\n#S\n", True),
        ("any_count", "#S\n%P1\n", "#S\n", False),
        ("any_count", "#S\n%P1\n", "#S\n%P1\n%P2\n", False),
        ("any_count", "?f1\n#S\n%P1\n", "#S\n?f1\n%P1\n", False),
    ],
)
def test_rules(rule: str, expected: str, got: str, equal: bool) -> None:
    assert same(rule, expected, got) is equal
