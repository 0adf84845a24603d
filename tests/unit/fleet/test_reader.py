# SPDX-License-Identifier: BSD-3-Clause
"""FLEET.toml: what a fleet is, and each mistake with its place and remedy."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from unitylink.errors import FleetError
from unitylink.fleet.reader import parse_fleet, read_fleet

SPEC = "public arm() { @x = 0x10: READ(); @y = 0x11: WRITE(SAFE=0); }\n"
TWO = """
[fleet]
name = "lab"
spec = "arm.ul"
may = ["read", "write j1.*"]

[[robot]]
name = "arm1"
link = "tcp://10.0.0.1:5555"
writers = ["ana"]

[[robot]]
name = "arm2"
link = "sim:arm.ul?plant=ramp"
key = "hall/left"
may = ["read"]
"""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    (tmp_path / "arm.ul").write_text(SPEC)
    return tmp_path / "fleet.toml"


def test_a_robot_has_what_the_fleet_has_unless_it_says_otherwise(file: Path) -> None:
    file.write_text(TWO)
    fleet = read_fleet(file)
    first, second = fleet.robots
    assert (fleet.name, fleet.is_router, fleet.network().connect) == ("lab", True, "tcp/127.0.0.1:7447")
    assert (first.key, first.spec, first.may, first.writers) == (
        "lab/arm1",
        "arm.ul",
        ("read", "write j1.*"),
        ("ana",),
    )
    assert (second.key, second.spec, second.may) == ("hall/left", "arm.ul", ("read",))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('name = "arm2"', 'name = "arm1"', "robots 1 and 2 have the name arm1; each needs its own"),
        ('"hall/left"', '"lab/arm1"', "robots 1 and 2 have the key lab/arm1"),
        ('"hall/left"', '"lab/arm1/x"', "the key lab/arm1/x is below the key lab/arm1 of another robot"),
        ('"hall/left"', '"lab/*"', "robot 2 (arm2): key: the key 'lab/*' has a wildcard"),
        ('"hall/left"', '"lab//x"', "robot 2 (arm2): key: the key 'lab//x' is no name"),
        ('name = "arm2"', 'name = "a/b"', "robot 2 (a/b): the name has a `/`"),
        ('name = "arm2"\n', "", 'robot 2: it has no name; add name = "arm2"'),
        ('link = "tcp://10.0.0.1:5555"\n', "", "robot 1 (arm1): it has no link; add for example"),
        ('spec = "arm.ul"\n', "", 'robot 1 (arm1): it has no spec; add spec = "arm.ul"'),
        ('spec = "arm.ul"', 'spec = "amr.ul"', "robot 1 (arm1): there is no spec amr.ul in "),
        ('spec = "arm.ul"', f'spec = "{"x" * 300}"', "robot 1 (arm1): there is no spec xxx"),
        ('name = "lab"', 'audit = "a\\u0000b"', "[fleet]: audit = 'a\\x00b'; expected a folder"),
        ("sim:arm.ul", "sim:amr.ul", "robot 2 (arm2): there is no spec amr.ul in "),
        ('key = "hall/left"', 'spec = "x.ul"', "a sim: link brings its own spec; leave spec = 'x.ul' out"),
        ("tcp://10.0.0.1:5555", "tpc://10.0.0.1:5555", "robot 1 (arm1): "),
        ("tcp://10.0.0.1:5555", "zenoh:lab/x", "robot 1 (arm1): 'zenoh:lab/x' is a robot that has a bridge"),
        ("write j1.*", "wirte j1.*", "robot 1 (arm1): may: 'wirte j1.*' is no scope"),
        ("writers =", "writer =", "robot 1 (arm1): writer is unknown; did you mean writers?"),
        ("spec =", "sepc =", "[fleet]: sepc is unknown; did you mean spec?"),
        ("[[robot]]", "[[robots]]", "robots is unknown; did you mean robot?"),
        ('["ana"]', '"ana"', "writers = 'ana'; expected a list of names"),
        ('["ana"]', "[1]", "writers = [1]; expected a list of names"),
        ('name = "lab"', "name = 1", "[fleet]: name = 1; expected a name"),
        ('name = "lab"', 'name = "l*b"', "[fleet]: name: the key 'l*b' has a wildcard"),
        ('name = "lab"', 'router = "a"\nconnect = "b"', "router and connect: one of them says where"),
        ('link = "sim:arm.ul?plant=ramp"', 'link = "tcp://10.0.0.1:5555"', "two robots have the link tcp:"),
        ('may = ["read"]', "may = []", "robot 2 (arm2): may = [] allows nothing"),
        ('may = ["read", "write j1.*"]', "may = []", "robot 1 (arm1): may = [] allows nothing"),
        ("[fleet]", "[fleet", "fleet.toml: "),
    ],
)
def test_a_mistake_is_named_with_its_remedy(file: Path, old: str, new: str, message: str) -> None:
    text = TWO.replace(old, new)
    assert text != TWO
    with pytest.raises(FleetError, match=re.escape(message)) as caught:
        parse_fleet(text, file)
    assert str(caught.value).startswith(str(file))


def test_a_bitstream_may_bring_its_spec_or_not(file: Path) -> None:
    head, *_ = TWO.partition("[[robot]]")
    robot = '[[robot]]\nname = "arm"\nlink = "bit:{}"\n'
    for link, spec in (("arm.ul", "arm.ul"), ("arm.bin?spec=arm.ul", "arm.ul"), ("arm.bin", "arm.ul")):
        assert parse_fleet(head + robot.format(link), file).robots[0].spec == spec
    with pytest.raises(FleetError, match=r"there is no spec other\.ul"):
        parse_fleet(head + robot.format("arm.bin?spec=other.ul"), file)


@pytest.mark.parametrize(
    ("first", "second", "same"),
    [
        ("serial:/dev/ttyUSB0", "serial:/dev/ttyUSB0?baud=3000000", True),
        ("serial:/dev/ttyUSB0", "serial:/dev/../dev/ttyUSB0?crc=1", True),
        ("tcp://10.0.0.1:5555", "tcp://10.0.0.1:5555?crc=1", True),
        ("rs485:/dev/ttyUSB0?node=3&baud=9600", "rs485:/dev/ttyUSB0?baud=9600&node=3", True),
        ("rs485:/dev/ttyUSB0?node=3", "rs485:/dev/ttyUSB0?node=4", False),
        ("ftdi:AB12?channel=A", "ftdi:AB12?channel=B", False),
    ],
)
def test_two_robots_with_one_port(file: Path, first: str, second: str, same: bool) -> None:
    text = TWO.replace("tcp://10.0.0.1:5555", first).replace("sim:arm.ul?plant=ramp", second)
    if not same:
        parse_fleet(text, file)
        return
    with pytest.raises(FleetError, match="two robots have the link"):
        parse_fleet(text, file)


def test_what_editors_of_windows_write(file: Path) -> None:
    file.write_bytes(b"\xef\xbb\xbf" + TWO.replace("\n", "\r\n").encode())
    assert [one.name for one in read_fleet(file).robots] == ["arm1", "arm2"]


def test_a_file_that_is_none(tmp_path: Path) -> None:
    with pytest.raises(
        FleetError, match=r"no\.toml: No such file or directory; a fleet is described in a file"
    ):
        read_fleet(tmp_path / "no.toml")
    with pytest.raises(FleetError, match=r"0 robots; begin each with \[\[robot\]\]"):
        parse_fleet("", tmp_path / "fleet.toml")
    (tmp_path / "fleet.toml").write_bytes(b"\xff\xfe")
    with pytest.raises(FleetError, match="utf-8"):
        read_fleet(tmp_path / "fleet.toml")
