# SPDX-License-Identifier: BSD-3-Clause
"""How values lie in messages, what is refused, and what a stranger is told."""

from __future__ import annotations

import json
import math
import struct
from pathlib import Path

import numpy as np
import pytest

from unitylink.errors import ProtocolError, UrlError, ValueRangeError
from unitylink.spec import compile_text
from unitylink.spec.model import Spec
from unitylink.zenoh.bridge.topics import layouts_of, topic_names, typed_output
from unitylink.zenoh.bridge.visits import GRACE_NS, Visits
from unitylink.zenoh.keys import Keys
from unitylink.zenoh.messages import SAMPLE
from unitylink.zenoh.schema import Field, fields_of, schema_of, set_layouts
from unitylink.zenoh.spec_files import pack_spec, unpack_spec

TEXT = """
enum mode : u2 { off = 0; hold = 1; run = 2 }
bits flags : u8 { hot: bool @ 0; count: u3 @ 3..1; }
public arm() {
   j[2]: joint() @ (0x10+4*i);
   @mode = 0x30: mode READWRITE(); @on = 0x31: bool WRITE(); @big = 0x32: i64 WRITE(MIN=-9, MAX=9);
   @flags = 0x34: flags READ(PUBLISH(100 Hz)); @real = 0x35: f32 READ(PUBLISH(100 Hz));
}
joint() : @ (a) {
   @goal = a: i16 WRITE(UNIT="rad", SCALE=0.001, MIN=-1.5, MAX=1.5);
   @angle = a+1: i16 READ(UNIT="rad", SCALE=0.001, PUBLISH(100 Hz));
   @go = a+2: PULSE();
}
"""


@pytest.fixture(scope="module")
def spec() -> Spec:
    result = compile_text(TEXT, "arm.ul")
    assert result.spec is not None, [str(one) for one in result.diagnostics]
    return result.spec


@pytest.fixture(scope="module")
def fields(spec: Spec) -> dict[str, Field]:
    return fields_of(spec, 32)


def test_each_item_has_a_type_that_every_language_has(fields: dict[str, Field]) -> None:
    told = {path: field.type for path, field in fields.items()}
    assert told["j[0].goal"] == told["real"] == "f64"
    assert (told["mode"], told["on"], told["big"], told["flags"]) == ("u8", "bool", "i64", "u8")


@pytest.mark.parametrize(
    ("path", "data", "why"),
    [
        ("j[0].goal", struct.pack("<d", math.nan), "goal"),
        ("j[0].goal", struct.pack("<d", math.inf), "goal"),
        ("j[0].goal", struct.pack("<d", 1.6), "1.6 rad is not in -1.5 to 1.5 rad"),
        ("mode", b"\x03", "mode"),
        ("on", b"\x02", "2 is no bool"),
        ("big", struct.pack("<q", 10), "10 is not in -9 to 9"),
    ],
)
def test_a_value_that_the_spec_does_not_allow_is_refused(
    fields: dict[str, Field], path: str, data: bytes, why: str
) -> None:
    with pytest.raises(ValueRangeError, match=why):
        fields[path].unpack(data)


def test_a_part_has_all_its_set_points_and_no_pulse(spec: Spec, fields: dict[str, Field]) -> None:
    sets = set_layouts(spec, fields)
    assert [field.path for field in sets[""].fields] == ["j[0].goal", "j[1].goal", "mode", "on", "big"]
    assert sets["j[1]"].unpack(struct.pack("<d", -0.5)) == {"j[1].goal": -0.5}
    assert "j[0].go" not in sets
    with pytest.raises(ProtocolError, match=r"7 bytes of values; j\[1\].goal take 8"):
        sets["j[1]"].unpack(b"1234567")
    data = sets[""].pack_values([0.5, -0.5, 2, True, -9])
    assert list(sets[""].unpack(data).values()) == [0.5, -0.5, 2, True, -9]


def test_rows_are_the_same_as_single_values(spec: Spec, fields: dict[str, Field]) -> None:
    """Publications are made without an object for a value. Each value is as a query would answer it."""
    (group,) = topic_names(spec).values()
    mine = [fields[element.path] for element in group.elements]
    chance = np.random.default_rng(1)
    words = chance.integers(0, 1 << 32, (50, len(mine)), dtype=np.uint32)
    words[:, 2] &= 0xF
    puts = list[bytearray]()
    first, times, since_ns = 2**32 - 1, chance.uniform(0, 1e6, 50), -(10**12)
    output = typed_output(puts.append, mine)
    output.send(first, times, since_ns, words)
    heads = [SAMPLE.unpack_from(one) for one in puts]
    times_ns = [int(time_s * 1e9) + since_ns for time_s in times.tolist()]
    assert heads == [((first + number) % 2**32, time_ns) for number, time_ns in enumerate(times_ns)]
    with pytest.raises(ValueError, match="expected 49 rows of 4 words, got 50 of 4"):
        output.send(first, times[:-1], 0, words)
    with pytest.raises(ValueError, match="no time"):
        output.send(first, np.full(50, np.nan), 0, words)
    for row, put in zip(words.tolist(), puts, strict=True):
        data = put[SAMPLE.size :]
        single = b"".join(field.pack(raw & field.codec.mask) for field, raw in zip(mine, row, strict=True))
        assert data == single or np.isnan(np.frombuffer(data[-8:], "<f8")[0])


KINDS = """
bits flags : u12 { hot: bool @ 0; count: u3 @ 3..1; }
open enum mode : u6 { off = 0; }
public all() {
   @a = 0x10: i32 READ(PUBLISH(100 Hz)); @b = 0x11: u32 READ(PUBLISH(100 Hz));
   @c = 0x12: i8 READ(PUBLISH(100 Hz)); @d = 0x13: u9 READ(PUBLISH(100 Hz));
   @e = 0x14: i33 READ(PUBLISH(100 Hz)); @f = 0x18: u64 READ(PUBLISH(100 Hz));
   @g = 0x1c: i64 READ(SCALE=0.1, PUBLISH(100 Hz)); @h = 0x20: u64 READ(SCALE=3, OFFSET=-1, PUBLISH(100 Hz));
   @i = 0x24: i16 READ(SCALE=0.01, OFFSET=1.5, PUBLISH(100 Hz)); @j = 0x25: fixed(8,8) READ(PUBLISH(100 Hz));
   @k = 0x26: f32 READ(SCALE=-2.5, OFFSET=1, PUBLISH(100 Hz)); @l = 0x28: f64 READ(PUBLISH(100 Hz));
   @m = 0x2c: bool READ(PUBLISH(100 Hz)); @n = 0x2d: flags READ(PUBLISH(100 Hz));
   @o = 0x2e: mode READ(PUBLISH(100 Hz));
   @q = 0x30: f32 READ(PUBLISH(100 Hz)); @r = 0x32: i31 READ(SCALE=0.30000000000000004, PUBLISH(100 Hz));
}
"""


@pytest.mark.parametrize("data_bits", [8, 16, 32])
def test_each_kind_of_value_is_as_numpy_decodes_it(data_bits: int) -> None:
    """The ends of each type, and numbers by chance; the bits of NaN too."""
    spec = compile_text(KINDS, "all.ul").spec
    assert spec is not None
    chance = np.random.default_rng(data_bits)
    for field in fields_of(spec, data_bits).values():
        codec, count = field.codec, 500
        raws = chance.integers(0, codec.mask, count, dtype=np.uint64, endpoint=True)
        raws[:4] = 0, codec.mask, codec.mask >> 1, (codec.mask >> 1) + 1
        shifts = np.arange(codec.words, dtype=np.uint64) * np.uint64(data_bits)
        words = (raws[:, None] >> shifts & np.uint64(codec.word_mask)).astype(np.uint32)
        puts = list[bytearray]()
        typed_output(puts.append, [field]).send(0, np.zeros(count), 0, words)
        with np.errstate(invalid="ignore"):  # a signalling NaN becomes a quiet one
            want = raws if field.packed else codec.decode_array(raws)
        kind = {"f64": "<f8", "bool": "u1"}.get(field.type) or f"<{field.type[0]}{field.bytes}"
        assert b"".join(one[SAMPLE.size :] for one in puts) == want.astype(kind).tobytes(), field.path


def test_the_schema_says_where_each_value_is(spec: Spec, fields: dict[str, Field]) -> None:
    told = schema_of(spec, fields, set_layouts(spec, fields), layouts_of(spec, fields))
    assert json.loads(json.dumps(told)) == told
    goal = told["values"]["j/0/goal"]
    assert (goal["type"], goal["unit"], goal["minimum"], goal["access"]) == ("f64", "rad", -1.5, "WRITE")
    assert told["values"]["mode"]["members"] == {"off": 0, "hold": 1, "run": 2}
    (topic,) = told["publish"].values()
    assert topic["fields"][0] == {"path": "j[0].angle", "type": "f64", "offset": 12}
    assert topic["bytes"] == 12 + 8 + 8 + 1 + 8


@pytest.mark.parametrize(
    "name", ["lab/*", "lab/**", "*", "lab/$*x", "", "/lab", "lab//x", "lab/", "l b", "@x", "a#b", "é"]
)
def test_a_name_that_is_none(name: str) -> None:
    with pytest.raises(UrlError, match="wildcard" if set(name) & set("*$") else "is no name"):
        Keys(name)


def test_a_spec_travels_with_its_imports(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "joint.ul").write_text(
        'import "deep/unit.ul";\njoint() : @ (a) { @x = a: READ(); u: unit() @ (a+1); }'
    )
    (tmp_path / "parts" / "deep").mkdir()
    (tmp_path / "parts" / "deep" / "unit.ul").write_text("unit() : @ (a) { @y = a: WRITE(); }")
    (tmp_path / "arm.ul").write_text('import "parts/joint.ul";\npublic arm() { j: joint() @ (0x10); }')
    text = pack_spec(tmp_path / "arm.ul", "arm")
    there = tmp_path / "there"
    there.mkdir()
    spec, file = unpack_spec(text, there)
    assert [path for path, _ in spec.walk()] == ["j.x", "j.u.y"] and file == there / "arm.ul"


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        '{"file": "a.ul", "root": "a", "files": {"b.ul": ""}}',
        '{"file": "../a.ul", "root": "a", "files": {"../a.ul": ""}}',
        '{"file": "/tmp/a.ul", "root": "a", "files": {"/tmp/a.ul": ""}}',
        "[" * 100_000,
    ],
)
def test_a_spec_that_is_none_is_refused(text: str, tmp_path: Path) -> None:
    with pytest.raises(ProtocolError):
        unpack_spec(text, tmp_path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "files", [{"a.ul": "\ud800"}, {"a.ul": "", "a.ul/b": ""}, {"a.ul": "", "n" * 300: ""}]
)
def test_a_spec_with_files_that_cannot_be_is_refused(files: dict[str, str], tmp_path: Path) -> None:
    with pytest.raises(ProtocolError, match="cannot be written"):
        unpack_spec(json.dumps({"file": "a.ul", "root": "a", "files": files}), tmp_path)


def test_a_visit_ends_with_its_token() -> None:
    visits, client = Visits(), None
    first = visits.add("ana", client, now_ns=0)  # type: ignore[arg-type]
    assert visits.token("ana", True) == () and first.present
    assert visits.token("ana", False) == (first,) and visits.get(first.number) is None
    late = visits.add("ben", client, now_ns=0)  # type: ignore[arg-type]
    assert visits.absent(GRACE_NS) == () and visits.absent(GRACE_NS + 1) == (late,)
