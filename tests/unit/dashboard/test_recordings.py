# SPDX-License-Identifier: BSD-3-Clause
"""Recordings on the side of the server: complete, bounded, told, and only those of the folder."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np
import pytest
from unit.dashboard.robot import Robot, Viewer, robot

from unitylink.dashboard import recorder, shelf
from unitylink.dashboard.extras import Extras
from unitylink.dashboard.shelf import Shelf
from unitylink.errors import UnityLinkError, UnknownName
from unitylink.recording import Origin, Sample, create, origin, samples
from unitylink.server.rate_limit import RateLimit


@pytest.fixture(scope="module")
def arm(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Robot]:
    folder = tmp_path_factory.mktemp("shelf") / "recordings"
    with robot(extras=Extras(Shelf(folder), "// the text")) as served:
        served.page.app.logins = RateLimit(1000, 1000)
        yield served


@pytest.fixture(autouse=True)
def empty(arm: Robot) -> Iterator[None]:
    yield
    arm.page.station.records.close()
    folder = arm.page.station.records.shelf.folder
    for file in folder.glob("*"):
        file.unlink()


def kept(arm: Robot) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = json.loads(arm.request("GET", "/recordings", cookie=arm.log_in())[2])
    return found


def record(arm: Robot, viewer: Viewer, ending: str = ".mcap") -> str:
    """Record until there are samples, and return the name."""
    assert viewer.ask("record", format=ending) == ""
    viewer.until(lambda: (viewer.state("recording") or {}).get("samples", 0) > 20)
    name = str(viewer.state("recording")["name"])
    assert viewer.ask("end_recording") == ""
    return name


@pytest.mark.parametrize("ending", [".mcap", ".csv"])
def test_all_items_are_recorded_with_their_times(arm: Robot, ending: str) -> None:
    arm.board.registers[0x11] = 321
    arm.board.registers[0x30] = 1
    with arm.viewer("cem") as viewer:
        began = time.time()
        name = record(arm, viewer, ending)
    path = arm.page.station.records.shelf.find(name)
    found = list(samples(path))
    values = {path: value for sample in found for path, value in sample.values.items()}
    assert values["j1.angle"] == 32.1 and values["grip"] == "hold" and values["j1.speed"] == 0
    times = [sample.time_s for sample in found]
    assert times == sorted(times) and began - 3 < times[0] and times[-1] < time.time() + 1
    if ending == ".mcap":
        made = origin(path)
        assert (made.name, made.text, made.units["j1.angle"]) == ("arm.ul", "// the text", "deg")
    log = arm.log.until("record", file=name, what="ended")[-2:]
    assert [(one["user"], one["file"], one["what"]) for one in log] == [
        ("cem", name, "began"),
        ("cem", name, "ended"),
    ]


def test_a_recording_is_listed_saved_and_deleted(arm: Robot) -> None:
    with arm.viewer() as viewer:
        assert viewer.ask("record", format=".csv") == ""
        (running,) = kept(arm)
        busy = arm.request("GET", f"/recordings/{running['name']}", cookie=arm.log_in())
        assert busy[0] == 409 and b"still being written" in busy[2]
        assert "owner is recording already" in viewer.ask("record", format=".csv")
        assert "still being written" in viewer.ask("replay", name=running["name"])
        assert viewer.ask("end_recording") == ""
        name = record(arm, viewer)
        assert "nothing is being recorded" in viewer.ask("end_recording")
        status, headers, body = arm.request("GET", f"/recordings/{name}", cookie=arm.log_in())
        path = arm.page.station.records.shelf.find(name)
        assert status == 200 and body == path.read_bytes() and name in headers["content-disposition"]
        with arm.viewer("cem") as cem:
            assert "cem may not admin" in cem.ask("delete_recording", name=name)
        assert viewer.ask("delete_recording", name=name) == ""
        assert not path.exists() and name not in [one["name"] for one in kept(arm)]
    arm.log.until("record", file=name, what="deleted")


@pytest.mark.parametrize(
    "name",
    [
        "../secret.csv",
        "..",
        "",
        "/etc/passwd",
        "a/../../secret.csv",
        "secret.csv\0",
        ".hidden.csv",
        "link.csv",
        "x" * 9000,
    ],
)
def test_no_name_leads_out_of_the_folder(arm: Robot, name: str) -> None:
    folder = arm.page.station.records.shelf.folder
    folder.mkdir(exist_ok=True)
    secret = folder.parent / "secret.csv"
    secret.write_text("time_s,a\n")
    for link in ("link.csv", ".hidden.csv"):
        (folder / link).symlink_to(secret)
    status, _, body = arm.request("GET", f"/recordings/{quote(name, safe='')}", cookie=arm.log_in())
    assert status in (404, 405, 307, 200) and b"time_s" not in body
    if status == 200:  # "" is the list, and it has none of these
        assert json.loads(body) == []
    with arm.viewer() as viewer:
        for request in ("replay", "delete_recording"):
            assert "no" in viewer.ask(request, name=name)
    assert secret.exists()


def test_who_may_what(arm: Robot) -> None:
    with arm.viewer() as viewer:
        name = record(arm, viewer)
    ben = arm.log_in("ben")  # who may not see all of the robot
    assert arm.request("GET", "/recordings", cookie=ben)[0] == 403
    assert arm.request("GET", f"/recordings/{name}", cookie=ben)[0] == 403
    with arm.viewer("ben") as viewer:
        for request in ("record", "end_recording", "replay", "delete_recording"):
            assert "ben may not" in viewer.ask(request, format=".csv", name=name)
    with arm.viewer("dan") as viewer:  # who may look at everything
        assert viewer.ask("replay", name=name) == ""
        for request in ("record", "end_recording"):
            assert "dan may only look" in viewer.ask(request, format=".csv")
    assert arm.request("GET", "/recordings")[0] == 401
    with arm.viewer() as viewer:
        assert "no format" in viewer.ask("record", format="../x.csv")


def test_a_replay_has_what_was_recorded(arm: Robot, tmp_path: Path) -> None:
    folder = arm.page.station.records.shelf.folder
    folder.mkdir(exist_ok=True)
    with create(folder / "old.mcap", Origin()) as writer:
        for number in range(500):
            grip = "hold" if number > 250 else "open"
            writer.add(Sample(1000.0 + number / 100, {"j1.angle": number / 10, "grip": grip, "gone": 1}))
    with arm.viewer() as viewer:
        assert "there is no replay" in viewer.ask("range", series=[[0, 1, 0]], end_s=1, replay=True)
        assert viewer.ask("replay", name="old.mcap") == ""
        told = viewer.told["replay"]
        items = [viewer.item("j1.angle"), viewer.item("grip")]
        assert (told["begun_s"], told["items"]) == (1000.0, items)
        assert told["duration_s"] == pytest.approx(4.99)
        ask = {
            "do": "range",
            "id": 77,
            "end_s": 9,
            "replay": True,
            "series": [[item, 1.0, 0] for item in items],
        }
        viewer.socket.send(json.dumps(ask))
        viewer.until(lambda: any(row[0] == 2.0 and row[1] == 77 for row in viewer.frames))
        row = next(row for row in viewer.frames if row[0] == 2.0 and row[1] == 77)
        count = int(row[5])
        angle = row[6 : 6 + 3 * count].reshape(-1, 3)
        assert angle[:, 0].tolist() == [0, 1, 2, 3, 4]
        assert np.allclose(angle[:, 2], [9.9, 19.9, 29.9, 39.9, 49.9], atol=0.7)  # 8 samples are an entry
        grip = row[6 + 3 * count + 3 :].reshape(-1, 3)
        assert grip[:, 2].tolist() == [0, 0, 1, 1, 1]
        (folder / "other.csv").write_text("time_s,elsewhere\n1.0,2\n")
        assert "no sample of an item of this robot" in viewer.ask("replay", name="other.csv")
        (folder / "broken.mcap").write_bytes(os.urandom(4000))
        assert "broken.mcap" in viewer.ask("replay", name="broken.mcap")


def test_it_ends_when_there_is_no_more_room(arm: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(recorder, "LOOK_S", 0.05)
    monkeypatch.setattr(recorder, "WRITE_S", 0.05)
    records = arm.page.station.records
    monkeypatch.setattr(records.shelf, "most_bytes", 3000)
    with arm.viewer() as viewer:
        assert viewer.ask("record", format=".csv") == ""
        viewer.until(lambda: any("has ended: the recordings have" in one["text"] for one in viewer.events))
        viewer.until(lambda: viewer.told["state"]["recording"] is None)
        assert "delete some" in viewer.ask("record", format=".csv")
    (one,) = records.shelf.all()
    assert 3000 <= one.size_bytes < 200_000
    assert len(list(samples(records.shelf.find(one.name)))) > 5, "it is whole as far as it goes"


def test_the_shelf(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    empty = Shelf(tmp_path / "none")
    assert empty.all() == []
    with pytest.raises(UnknownName):
        empty.find("a.csv")
    first = empty.new("arm", ".csv")
    first.write_text("")
    second = empty.new("arm", ".csv")
    assert first != second and first.parent == second.parent == tmp_path / "none"
    monkeypatch.setattr(shelf, "FREE_BYTES", 1 << 62)
    with pytest.raises(UnityLinkError, match="disk"):
        empty.new("arm", ".csv")
    (tmp_path / "file").write_text("")
    with pytest.raises(UnityLinkError, match="--recordings"):
        Shelf(tmp_path / "file" / "below").new("arm", ".csv")


def test_what_a_chart_shows_as_mcap(arm: Robot, tmp_path: Path) -> None:
    arm.board.registers[0x11] = 123
    with arm.viewer() as viewer:
        viewer.until(lambda: viewer.values.get("j1.angle") == 12.3)
    end_s = arm.link.now_s()
    path = f"/mcap?item=j1.angle&item=grip&begin_s={end_s - 1}&end_s={end_s}"
    status, headers, body = arm.request("GET", path, cookie=arm.log_in())
    assert status == 200 and "values.mcap" in headers["content-disposition"]
    file = tmp_path / "values.mcap"
    file.write_bytes(body)
    found = list(samples(file))
    assert {name for sample in found for name in sample.values} == {"j1.angle", "grip"}
    assert [sample.values["j1.angle"] for sample in found if "j1.angle" in sample.values][-1] == 12.3
    assert all(abs(sample.time_s - time.time()) < 30 for sample in found)
    assert arm.request("GET", path)[0] == 401
    assert arm.request("GET", path, cookie=arm.log_in("ben"))[0] == 403
