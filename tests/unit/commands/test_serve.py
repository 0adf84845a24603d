# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink serve`: its arguments. What it serves is in tests/unit/server and tests/end_to_end."""

from __future__ import annotations

from pathlib import Path
from threading import Event

import pytest

from tests.unit.server.served import TEXT
from unitylink.cli import main
from unitylink.commands import serve


@pytest.fixture
def spec(tmp_path: Path) -> str:
    file = tmp_path / "arm.ul"
    file.write_text(TEXT)
    return str(file)


def test_a_checked_configuration(spec: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    tokens = tmp_path / "tokens.toml"
    assert main(["token", "ana", "read", "write nothing.*", "--file", str(tokens)]) == 0
    links = ["left=tcp://127.0.0.1:1", "right=serial:/dev/none?baud=9600"]
    capsys.readouterr()
    assert main(["serve", *links, spec, "--token-file", str(tokens), "--listen", "9", "--check-config"]) == 0
    told, warned = capsys.readouterr()
    assert warned == (
        f"warning: {tokens}, line 4: token 1 (ana): `write nothing.*` allows nothing: the robot has no part "
        "'nothing'\n"
    )
    assert told.splitlines() == [
        "tcp://127.0.0.1:1 at serve://127.0.0.1:9/left",
        "serial:/dev/none?baud=9600 at serve://127.0.0.1:9/right",
        "1 token",
    ]


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        (["tcp://a:1", "tcp://b:2"], 2, "several boards need names"),
        (["x=tcp://a:1", "x=tcp://b:2"], 2, "two boards have the name x"),
        (["tcp://a:1", "--listen", "0.0.0.0:1"], 2, "add --anyone"),
        (["tcp://a:1", "--listen", "70000"], 2, "a port from 0 to 65535"),
        (["nothing:1"], 2, "no scheme 'nothing'"),
        (
            ["tcp://a:1", "--token-file", "/nowhere"],
            1,
            "`unitylink token NAME read --file /nowhere` makes one",
        ),
        (["serial:/dev/none?bauds=1"], 2, "no option 'bauds'"),
        (["sim:/nowhere.ul"], 1, "/nowhere.ul"),
        (["sim:"], 2, "expected sim:SPEC.ul"),
        (["tcp://a:1", "--audit", "/nowhere/log"], 1, "--audit /nowhere/log: there is no folder /nowhere"),
        (["tcp://a:1", "--metrics", "/"], 1, "--metrics /: it is a folder"),
        (["tcp://a:1", "--tls-cert", "/nowhere"], 1, "/nowhere: No such file or directory; expected"),
        ([], 2, "give both: LINK, where the board is, and SPEC"),
    ],
)
def test_wrong_arguments(
    spec: str, words: list[str], code: int, message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    links = [word for word in words if not words[0].startswith("--")]
    place = next((index for index, word in enumerate(links) if word.startswith("--")), len(links))
    assert main(["serve", *links[:place], spec, *links[place:], "--check-config"]) == code
    assert message in capsys.readouterr().err


@pytest.mark.parametrize(
    ("token", "message"), [("secret", "has 6 characters"), ("two words" * 3, "not one word")]
)
def test_a_token_that_others_guess(
    spec: str, token: str, message: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("UNITYLINK_TOKEN", token)
    assert main(["serve", "tcp://a:1", spec, "--check-config"]) == 1
    told = capsys.readouterr().err
    assert message in told
    assert token not in told


def test_an_address_that_is_not_here(spec: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["serve", f"sim:{spec}", spec, "--listen", "192.0.2.1:1", "--anyone"]) == 1
    told = capsys.readouterr().err
    assert "192.0.2.1:1" in told and "give an address of this machine" in told
    assert "up" not in told  # the board was not touched


def test_metrics_that_cannot_be_written_end_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(serve, "_METRICS_S", 0.01)
    stop, reports = Event(), []

    class Server:
        def report(self) -> dict[str, object]:
            reports.append(len(reports))
            if len(reports) == 3:  # now there is room
                (tmp_path / "there").mkdir()
            if len(reports) == 5:
                stop.set()
            return {"refused": 0, "turned_away": 0, "log_lines_lost": 0, "robots": []}

    file = tmp_path / "there" / "metrics.prom"
    serve._write_metrics_until(stop, str(file), Server())
    assert capsys.readouterr().err.count("it is tried again") == 1
    assert "unitylink_server_refused_total 0" in file.read_text()
