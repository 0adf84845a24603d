# SPDX-License-Identifier: BSD-3-Clause
"""No input ends in a traceback: the short form of fuzz_inputs.py, and the defects that it has found."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

from kinds import KINDS, Inputs, allowed, typed

from unitylink.boards import load_board, read_report
from unitylink.capture import messages
from unitylink.capture.pcapng import RECEIVED, SENT, Packet
from unitylink.cli import main
from unitylink.commands.names import Names
from unitylink.commands.wire_reader import wire_reader
from unitylink.connection.schemes import scheme_of
from unitylink.errors import BoardError, UrlError
from unitylink.recording import Origin, Sample, create

pytestmark = pytest.mark.xdist_group("matplotlib")  # one worker, because importing matplotlib takes a second
PER_SHARE = 3  # inputs of a kind, times its share


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    yield tmp_path_factory.mktemp("inputs")


@pytest.mark.filterwarnings("ignore")  # warnings of matplotlib and about wide numbers
@pytest.mark.parametrize("kind", [kind.name for kind in KINDS])
def test_mutated_inputs_are_read_or_refused(kind: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("input_wire.DRAWN", 1 << 62)
    inputs = Inputs(folder, kind)
    for seed in range(PER_SHARE * inputs.kinds[0].share):
        found, data = inputs.one(seed)
        try:
            inputs.read(found, data)
        except Exception as error:
            raise AssertionError(f"seed {seed}, {kind}: {data[:2000]!r}") from error


@pytest.mark.parametrize("kind", [kind.name for kind in KINDS])
def test_inputs_that_are_good_are_read(kind: str, folder: Path) -> None:
    """If one were refused, its mutations would be refused at once and would test nothing."""
    inputs = Inputs(folder, kind)
    for data in inputs.good[kind]:
        inputs.read(inputs.kinds[0], data)


def test_each_good_command_line_is_run(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A line that `read_command_line` leaves out would be a test of nothing, and so would its mutations."""
    run: list[list[str]] = []
    monkeypatch.setattr("input_texts.command", lambda words, _: run.append(words))
    inputs = Inputs(folder, "command line")
    lines = inputs.good["command line"]
    for data in lines:
        inputs.read(inputs.kinds[0], data)
    assert [" ".join(words).encode() for words in run] == [data.replace(b"\0", b" ") for data in lines]


def test_only_errors_of_ours_are_allowed() -> None:
    with allowed():
        raise UrlError("one of ours")
    for error in (KeyError("x"), RecursionError(), MemoryError(), TypeError(), OSError()):
        with pytest.raises(type(error)), allowed():
            raise error


# ---- defects that were found


@pytest.mark.parametrize("command", ["W", "WSR", "RG", "WEM", "R", "RM", "WSA"])
def test_a_line_of_any_length_is_decoded(command: str) -> None:
    line = f"#{command}:".encode() + b"ab" * 30_000 + b"\n"
    for names in (Names(None), Names(typed())):
        reader = wire_reader(names, address_bytes=2, data_bytes=4)
        packets = iter([Packet(0.0, SENT, line), Packet(0.1, RECEIVED, b"#S_" + line[1:])])
        assert all(len(message.meaning) < 400_000 for message in messages(packets, reader))


@pytest.mark.parametrize(
    "value",
    [
        "count=inf mm",
        "count=nan mm",
        "count=0_mm",
        "count=0x1_",
        "gain=0_",
        "count=0x" + "1" * 400 + " m",
        "led=" + "9" * 5000,
    ],
)
def test_numbers_that_are_none_are_usage_errors(
    value: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "lamp.ul").write_text(
        'public lamp() { @count = 0x1: u16 WRITE(UNIT="mm"); @gain = 0x2: f32 WRITE(); @led = 0x3: WRITE(); }'
    )
    assert main(["write", f"sim:{tmp_path}/lamp.ul", value]) == 2
    assert value.partition("=")[0] in capsys.readouterr().err


@pytest.mark.parametrize(
    "url", ["sim:\udcff.ul", "tcp://h\udcff:1", "serial:/dev/\0x", "mmap:/a\0", "sim:a\0.ul"]
)
def test_a_url_that_is_no_text_is_said_to_be_none(url: str) -> None:
    with pytest.raises(UrlError, match="not UTF-8, or contains a NUL"):
        scheme_of(url)
    assert main(["read", url, "0x1"]) in (1, 2)


def test_brackets_without_end_are_no_manifest_and_no_report(tmp_path: Path) -> None:
    (tmp_path / "board.toml").write_text("a = " + "[" * 100_000)
    with pytest.raises(BoardError, match=r"board\.toml"):
        load_board(str(tmp_path))
    (tmp_path / "report.json").write_text("[" * 100_000)
    with pytest.raises(BoardError, match=r"report\.json"):
        read_report(tmp_path)


def test_a_formula_in_a_name_is_drawn_as_it_is(tmp_path: Path) -> None:
    (tmp_path / "r.csv").write_text("time_s,$x,y$,$\\frac$\n0.0,1,2,run\n1.0,2,3,$\\stop$\n")
    picture = tmp_path / "r.svg"
    assert main(["plot", str(tmp_path / "r.csv"), "--out", str(picture)]) == 0
    assert "<!-- $x -->" in picture.read_text()


def test_what_has_no_end_of_units_is_no_picture(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    values = {f"x.a{number}": number for number in range(70)}
    with create(tmp_path / "r.mcap", Origin(units={path: path for path in values})) as writer:
        writer.add(Sample(0.0, values))
    assert main(["plot", str(tmp_path / "r.mcap"), "--out", str(tmp_path / "r.svg")]) == 1
    assert "70 panels do not fit into a picture" in capsys.readouterr().err


def test_the_name_of_an_exchange_is_no_markup(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    exchange = {"name": "[/x]", "steps": [["send", "#RLC\n"], ["quiet", 150]], "response": "?"}
    exchange |= {"status": "required", "compare": "exact"}
    (tmp_path / "x.json").write_text(json.dumps({"runs": [{"run": 0, "exchanges": [exchange]}]}))
    assert main(["conformance", str(tmp_path / "x.json")]) == 1
    assert "run 0, [/x] (required" in capsys.readouterr().out
