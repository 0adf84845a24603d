# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink serve`: its arguments. What it serves is in tests/unit/server and tests/end_to_end."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.unit.server.served import TEXT
from unitylink.cli import main


@pytest.fixture
def spec(tmp_path: Path) -> str:
    file = tmp_path / "arm.ul"
    file.write_text(TEXT)
    return str(file)


def test_a_checked_configuration(spec: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    tokens = tmp_path / "tokens.toml"
    assert main(["token", "ana", "read", "--file", str(tokens)]) == 0
    links = ["left=tcp://127.0.0.1:1", "right=serial:/dev/none?baud=9600"]
    capsys.readouterr()
    assert main(["serve", *links, spec, "--token-file", str(tokens), "--listen", "9", "--check-config"]) == 0
    told = capsys.readouterr().out.splitlines()
    assert told == [
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
        (["tcp://a:1", "--token-file", "/nowhere"], 1, "/nowhere"),
    ],
)
def test_wrong_arguments(
    spec: str, words: list[str], code: int, message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    links = [word for word in words if not words[0].startswith("--")]
    place = next((index for index, word in enumerate(links) if word.startswith("--")), len(links))
    assert main(["serve", *links[:place], spec, *links[place:], "--check-config"]) == code
    assert message in capsys.readouterr().err


def test_an_address_that_is_not_here(spec: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["serve", f"sim:{spec}", spec, "--listen", "192.0.2.1:1", "--anyone"]) == 1
    assert "192.0.2.1:1" in capsys.readouterr().err
