# SPDX-License-Identifier: BSD-3-Clause
"""`watch`, `record` and `plot` in this process, on a board whose values come at several rates."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from mcap.reader import make_reader

from unitylink.cli import main
from unitylink.commands.plot import _recorded
from unitylink.recording import origin, samples

SPEC = """
enum mode: u2 { idle = 0; run = 1; stop = 3; }
public arm() {
   @position = 0x10: i16 READ(UNIT="rad", SCALE=0.01, PUBLISH(200 Hz));
   @speed = 0x11: i16 READ(UNIT="rad/s", SCALE=0.1, PUBLISH(100 Hz));
   @mode = 0x12: mode READ(PUBLISH(50 Hz));
   @heat = 0x13: f32 READ(UNIT="degC");
   @target = 0x14: i16 WRITE(UNIT="rad", SCALE=0.01, INITIAL=12.54);
   @limit = 0x15: f32 WRITE(INITIAL=12.54);
}
"""


@pytest.fixture
def link(tmp_path: Path) -> str:
    (tmp_path / "arm.ul").write_text(SPEC)
    return f"sim:{tmp_path / 'arm.ul'}?plant=ramp"


def test_watch_counts_from_its_start_in_the_order_of_time(
    link: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["watch", link, "arm", "--rate", "300", "--count", "150", "--json"]) == 0
    lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    times_s = [line["time_s"] for line in lines]
    assert len(lines) == 150 and times_s == sorted(times_s) and times_s[0] >= 0
    values = {path: value for line in lines for path, value in line["values"].items()}
    assert values.keys() == {"position", "speed", "mode", "heat", "target", "limit"}
    assert (values["mode"], values["target"], values["limit"]) == ("idle", 12.54, 12.54)


@pytest.mark.parametrize("ending", ["mcap", "csv"])
def test_a_recording_is_in_order_and_has_the_set_points_without_extra_digits(
    link: str, tmp_path: Path, ending: str
) -> None:
    path = tmp_path / f"arm.{ending}"
    # At this rate, a busy machine may lose some of the values. Then the command reports it and ends with 1.
    assert main(["record", link, "--out", str(path), "--rate", "300", "--count", "150"]) in (0, 1)
    found = list(samples(path))
    assert [one.time_s for one in found] == sorted(one.time_s for one in found)
    last = {name: value for one in found for name, value in one.values.items()}
    assert (last["target"], last["limit"], last["mode"]) == (12.54, 12.54, "idle")
    if ending == "csv":
        assert not re.search(r"\.\d{10}", path.read_text().replace(f"{found[0].time_s:.0f}", ""))


def test_topics_name_their_rates_and_plots_have_the_units_of_the_file(link: str, tmp_path: Path) -> None:
    path = tmp_path / "arm.mcap"
    assert main(["record", link, "--out", str(path), "--rate", "20", "--count", "150"]) == 0
    with open(path, "rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    topics = {channel.topic for channel in summary.channels.values()}
    assert topics == {"/arm/200_hz", "/arm/100_hz", "/arm/50_hz", "/arm/read_20_hz"}
    texts = [schema.data.decode() for schema in summary.schemas.values()]
    assert any('"description":"in rad/s"' in text for text in texts)
    units = {"position": "rad", "speed": "rad/s", "heat": "degC", "target": "rad"}
    assert origin(path).units == units
    drawn = _recorded(str(path), (), None)
    assert {name: one.unit for name, one in drawn.items() if one.unit} == units
    assert drawn["mode"].members == ["idle", "run", "stop"]
    assert min(one.times_s[0] for one in drawn.values()) == 0.0


def test_units_of_a_csv_recording_come_from_the_spec(link: str, tmp_path: Path) -> None:
    path = str(tmp_path / "arm.csv")
    assert main(["record", link, "--out", path, "--count", "20"]) == 0
    assert _recorded(path, ("position",), None)["position"].unit == ""
    assert _recorded(path, ("position",), str(tmp_path / "arm.ul"))["position"].unit == "rad"
