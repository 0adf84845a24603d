# SPDX-License-Identifier: BSD-3-Clause
"""Recordings, written and read back: by us, and by the libraries of those who will open them."""

from __future__ import annotations

import json
import resource
import signal
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from effort import many
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader

from unitylink.errors import UnityLinkError
from unitylink.recording import Origin, RecordingTruncated, Sample, create, origin, samples

NAMES = ("j1.cpos", "j1.spd", "leg[2].mode", "on")
ORIGIN = Origin("arm.ul", "public arm() { }", "0123456789abcdef")
NUMBERS = st.one_of(st.integers(-(2**31), 2**32), st.floats(allow_nan=False, allow_infinity=False))


def sample(number: int) -> Sample:
    values = {"j1.cpos": number, "j1.spd": number / 8, "leg[2].mode": "run", "on": number % 2 == 1}
    return Sample(1.7e9 + number / 1000, values)


@pytest.fixture(params=[".mcap", ".csv"])
def path(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    return tmp_path / f"arm{request.param}"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("recording")


def write(path: Path, count: int) -> None:
    with create(path, ORIGIN, NAMES) as writer:
        for number in range(count):
            writer.add(sample(number))
    assert writer.count == count and writer.size_bytes == path.stat().st_size


def test_what_is_written_is_read(path: Path) -> None:
    write(path, 1000)
    read = list(samples(path))
    assert len(read) == 1000
    for number in (0, 1, 999):
        assert read[number].values == sample(number).values
        assert read[number].time_s == pytest.approx(sample(number).time_s, abs=1e-6)


@settings(max_examples=many(30))
@given(rows=st.lists(st.dictionaries(st.sampled_from(NAMES), NUMBERS, min_size=1), min_size=1, max_size=10))
def test_numbers_come_back_as_they_were(rows: list[dict[str, Any]], folder: Path) -> None:
    for ending in (".mcap", ".csv"):
        path = folder / f"r{ending}"
        path.unlink(missing_ok=True)
        with create(path, Origin(), NAMES) as writer:
            for row in rows:
                writer.add(Sample(0.0, row))
        assert [s.values for s in samples(path)] == rows


def test_the_spec_comes_along_in_mcap(tmp_path: Path) -> None:
    write(tmp_path / "arm.mcap", 1)
    assert origin(tmp_path / "arm.mcap") == ORIGIN
    write(tmp_path / "arm.csv", 1)
    assert origin(tmp_path / "arm.csv") == Origin()


def test_what_is_no_number_is_empty_in_mcap(tmp_path: Path) -> None:
    with create(tmp_path / "n.mcap", Origin()) as writer:
        writer.add(Sample(0.0, {"a": float("nan"), "b": 1.5}))
    (read,) = samples(tmp_path / "n.mcap")
    assert read.values == {"a": None, "b": 1.5}


def test_what_is_no_number_is_empty_in_csv(tmp_path: Path) -> None:
    with create(tmp_path / "n.csv", Origin()) as writer:
        writer.add(Sample(0.0, {"a": float("nan"), "b": float("inf")}))
    assert (tmp_path / "n.csv").read_text().splitlines()[1] == "0.000000000,,inf"
    (read,) = samples(tmp_path / "n.csv")
    assert read.values == {"b": float("inf")}


def test_a_recording_cut_off_at_once_differs_from_a_file_of_another_kind(tmp_path: Path) -> None:
    write(tmp_path / "arm.mcap", 1)
    (tmp_path / "arm.mcap").write_bytes((tmp_path / "arm.mcap").read_bytes()[:20])
    with pytest.raises(RecordingTruncated, match="cut off or damaged before its first sample"):
        list(samples(tmp_path / "arm.mcap"))
    (tmp_path / "arm.mcap").write_bytes(b"PK some other kind of file")
    with pytest.raises(UnityLinkError, match="not an MCAP file"):
        list(samples(tmp_path / "arm.mcap"))


def test_a_cut_off_file_gives_all_samples_before_the_cut(path: Path) -> None:
    count = 10_000
    write(path, count)
    whole = path.read_bytes()
    for part in (0.31, 0.7, 0.99):
        path.write_bytes(whole[: int(len(whole) * part)])
        seen: list[Sample] = []
        with pytest.raises(RecordingTruncated, match="cut off"):
            seen.extend(samples_until_cut(path, seen))
        assert len(seen) > count * part * 0.8
        assert [s.values["j1.cpos"] for s in seen] == list(range(len(seen)))


def samples_until_cut(path: Path, seen: list[Sample]) -> Iterator[Sample]:
    for one in samples(path):
        seen.append(one)
    yield from ()


@pytest.fixture
def full_disk() -> Iterator[None]:
    """Files may have 100 kB and not a byte more."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    ignored = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, before[1]))
    yield
    resource.setrlimit(resource.RLIMIT_FSIZE, before)
    signal.signal(signal.SIGXFSZ, ignored)


@pytest.mark.usefixtures("full_disk")
def test_a_full_disk_is_an_error_that_says_how_much_is_valid(path: Path) -> None:
    with pytest.raises(
        UnityLinkError, match=r"File too large; it holds the first \d+ (samples|lines), whole"
    ):
        write(path, 200_000)
    seen: list[Sample] = []
    with suppress(RecordingTruncated):  # an MCAP file without its index
        seen.extend(samples_until_cut(path, seen))
    assert seen and [s.values["j1.cpos"] for s in seen] == list(range(len(seen)))


def test_other_files_and_endings_are_refused(tmp_path: Path) -> None:
    (tmp_path / "x.csv").write_text("a,b\n1,2\n")
    (tmp_path / "x.mcap").write_text("no recording")
    with pytest.raises(UnityLinkError, match="first column is not time_s"):
        list(samples(tmp_path / "x.csv"))
    with pytest.raises(UnityLinkError, match="not an MCAP file"):
        list(samples(tmp_path / "x.mcap"))
    with pytest.raises(UnityLinkError, match=r"ends in \.mcap or \.csv, not in '\.bag'"):
        create(tmp_path / "x.bag", Origin())
    with pytest.raises(UnityLinkError, match="No such file"):
        create(tmp_path / "absent" / "x.csv", Origin())


def test_pandas_reads_csv(tmp_path: Path) -> None:
    import pandas as pd  # this takes long, so only one worker imports it

    write(tmp_path / "arm.csv", 500)
    frame = pd.read_csv(tmp_path / "arm.csv")
    assert list(frame.columns) == ["time_s", *NAMES]
    assert frame["j1.cpos"].tolist() == list(range(500)) and frame["j1.spd"].dtype == "float64"


def test_the_format_s_own_reader_finds_topics_schemas_and_times(tmp_path: Path) -> None:
    """The reader of Foxglove's library needs the index and the statistics at the end of the file."""
    write(tmp_path / "arm.mcap", 3000)
    with open(tmp_path / "arm.mcap", "rb") as stream:
        reader = make_reader(stream)
        summary = reader.get_summary()
        assert summary is not None and summary.statistics is not None
        assert summary.statistics.message_count == 3000
        (channel,) = summary.channels.values()
        schema = json.loads(summary.schemas[channel.schema_id].data)
        assert (channel.topic, channel.message_encoding) == ("/j1_leg2_on", "json")
        assert schema["properties"]["j1"]["properties"]["cpos"] == {"type": "number"}
        late = list(reader.iter_messages(starting_at=int(1.7e18 + 2e9)))
    assert len(late) == 1000
    assert json.loads(late[0][2].data) == {
        "j1": {"cpos": 2000, "spd": 250.0},
        "leg": {"2": {"mode": "run"}},
        "on": False,
    }


def test_a_recording_of_ten_minutes_at_1_khz_of_18_joints_is_whole(tmp_path: Path) -> None:
    names = tuple(f"leg[{leg}].{joint}" for leg in range(6) for joint in ("hip", "knee", "foot"))
    count = 600_000 // 60  # a 60th of the samples, some 40 chunks; the loop is the same for all samples
    with create(tmp_path / "walker.mcap", ORIGIN, names) as writer:
        for number in range(count):
            writer.add(
                Sample(1.7e9 + number / 1000, {name: number + place for place, name in enumerate(names)})
            )
    with open(tmp_path / "walker.mcap", "rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None and summary.statistics is not None
    assert summary.statistics.message_count == count
    last = -1
    for last, one in enumerate(samples(tmp_path / "walker.mcap")):
        assert one.values["leg[5].foot"] == last + 17
    assert last == count - 1
