# SPDX-License-Identifier: BSD-3-Clause
"""Texts, from specs to command lines: good ones, and the code that reads them."""

import json
import os
import re
from pathlib import Path

from input_base import ROOT, TYPED, allowed, command, elements, typed
from input_wire import captured

from unitylink import connect
from unitylink.boards import load_board
from unitylink.boards import read_report as report_of
from unitylink.boards.fit import settings_of
from unitylink.commands.value_text import parse_value
from unitylink.connection.schemes import SCHEMES
from unitylink.fleet.reader import read_fleet
from unitylink.fleet.security import security_files
from unitylink.generate import ARTEFACTS, generate
from unitylink.spec import compile_text
from unitylink.values import Codec, Quantity

_PORT = re.compile(r"\s*(?!sim:)(" + "|".join(SCHEMES) + "):")


# ---- texts: specs, imports, boards, reports, settings, values


def specs(_: Path) -> list[bytes]:
    files = [TYPED, *ROOT.glob("examples/*/*.ul"), ROOT / "tests" / "unit" / "spec" / "everything.ul"]
    return [path.read_bytes() for path in files]


def read_spec(data: bytes, folder: Path) -> None:
    spec = compile_text(data, "x.ul").spec
    if spec is not None and len(data) % 8 == 0:
        with allowed():
            generate(spec, list(ARTEFACTS)[len(data) // 8 % len(ARTEFACTS)])
    if len(data) % 8 == 1:
        (folder / "x.ul").write_bytes(data)
        command(["check", "x.ul"], folder)


def imports(_: Path) -> list[bytes]:
    return [path.read_bytes() for path in (ROOT / "tests" / "unit" / "commands" / "rdl").glob("*.rdl")]


def read_import(data: bytes, folder: Path) -> None:
    (folder / "x.rdl").write_bytes(data)
    command(["import", "x.rdl"], folder)


def fleets(folder: Path) -> list[bytes]:
    robots = (
        '[[robot]]\nname = "a"\nlink = "sim:x.ul?root=arm"\n[[robot]]\nname = "b"\nlink = "tcp://lab:5555"\n'
    )
    more = (
        'key = "hall/b"\nspec = "x.ul"\nmay = ["read", "write j1.*"]\nwriters = ["ana"]\nreaders = ["ben"]\n'
    )
    return [f'[fleet]\nname = "lab"\nrouter = "tls/127.0.0.1:7447"\nanyone = true\n{robots}{more}'.encode()]


def read_fleet_text(data: bytes, folder: Path) -> None:
    (folder / "x.ul").write_text(_LAMP)
    (folder / "fleet.toml").write_bytes(data)
    with allowed():
        security_files(read_fleet(folder / "fleet.toml"), "secrets")


def configurations(_: Path) -> list[bytes]:
    return [path.read_bytes() for path in (ROOT / "tests" / "unit" / "commands" / "riocore").glob("*.json")]


def read_configuration(data: bytes, folder: Path) -> None:
    (folder / "x.json").write_bytes(data)
    command(["import", "x.json"], folder)


def boards(_: Path) -> list[bytes]:
    return [path.read_bytes() for path in ROOT.glob("boards/*/board.toml")]


def read_board(data: bytes, folder: Path) -> None:
    mine = folder / "board"
    mine.mkdir(exist_ok=True)
    (mine / "board.toml").write_bytes(data)
    with allowed():
        board = load_board(str(mine))
        board.configuration(typed(), None, {})


def reports(_: Path) -> list[bytes]:
    return [json.dumps({"board": "icebreaker", "bitstream": "servo.bin", "clock_hz": 1}).encode()]


def read_report(data: bytes, folder: Path) -> None:
    (folder / "report.json").write_bytes(data)
    with allowed():
        report_of(folder)
    command(["flash", "."], folder)


def exchanges(_: Path) -> list[bytes]:
    path = ROOT / "tests" / "conformance" / "classic-transcripts.json"
    runs = json.loads(path.read_text())["runs"][:3]
    return [json.dumps({"runs": [{**run, "exchanges": run["exchanges"][:4]}]}).encode() for run in runs]


def read_exchanges(data: bytes, folder: Path) -> None:
    (folder / "x.json").write_bytes(data)
    command(["conformance", "x.json"], folder)


def settings(_: Path) -> list[bytes]:
    return [b"rx_fifo=256", b"groups=4", b"deadman=no", b"protocol=framed", b"base_hz=1000", b"window=64"]


def read_settings(data: bytes, _: Path) -> None:
    with allowed():
        settings_of([part.decode("utf-8", "surrogateescape") for part in data.split(b"\n")])


def values(_: Path) -> list[bytes]:
    texts = [b"30", b"-0.5", b"0x1E", b"30deg", b"true", b"run", b"{ready=1, level=2.5}", b"1e308", b"inf"]
    return [path.encode() + b"=" + text for path in elements().elements for text in texts]


def read_value(data: bytes, _: Path) -> None:
    path, _, text = data.decode("utf-8", "surrogateescape").partition("=")
    items = elements().all()
    item = next((one for one in items if one.name == path), items[len(data) % len(items)])
    assert item.element is not None
    with allowed():
        value = parse_value(text, item)
        codec = Codec(item.name, Quantity.of(item.element), 32, commanded=True)
        raw = codec.encode(value)
        assert 0 <= raw <= codec.mask
        codec.decode(raw)  # a value that was accepted can be shown


# ---- the command line


_LAMP = """enum mode: u2 { idle = 0; run = 1; }
bits state: u8 { on: bool @ 0; mode: mode @ 2..1; }
public lamp() {
   @led = 0x10: WRITE(); @light = 0x11: i16 READ(UNIT="rad", SCALE=0.5); @mode = 0x12: mode READWRITE();
   @gain = 0x13: f32 WRITE(); @state = 0x14: state WRITE(); @count = 0x15: u16 WRITE(UNIT="mm");
}
"""
_COMMANDS = (  # of commands that make no file and serve nothing
    "check lamp.ul",
    "check lamp.ul --json",
    "list --spec lamp.ul",
    "list --spec lamp.ul --json",
    "explain UL001",
    "budget lamp.ul --baud 115200",
    "diff lamp.ul lamp.ul",
    "decode lamp.pcapng --spec lamp.ul --only request,reply --match l.*",
    "decode lamp.pcapng --raw --json --address-bytes 2 --data-bytes 4",
    "read sim:lamp.ul l* 0x10 --json",
    "read sim:lamp.ul?timeout=0.1&attempts=3&fifo=16,16&crc=1&window=64&protocol=classic 0x11",
    "write sim:lamp.ul led=5 gain=1.5 mode=run state={on=1,mode=run}",
    "write sim:lamp.ul count=12mm 0x10=0xFF --json",
    "info sim:lamp.ul?protocol=framed&spec_hash=any&deadman=1",
)
_NAMES = {line.partition(" ")[0] for line in _COMMANDS}


def command_lines(folder: Path) -> list[bytes]:
    (folder / "lamp.ul").write_text(_LAMP)
    (folder / "lamp.pcapng").write_bytes(captured("classic", folder))
    return [os.fsencode(line.replace(" ", "\0")) for line in _COMMANDS]


def read_command_line(data: bytes, folder: Path) -> None:
    words = [os.fsdecode(word) for word in data.split(b"\0")]
    if words[0] not in _NAMES or any(_PORT.match(word) for word in words):
        return  # it would make files, serve, or send to ports of this machine
    if any(word.startswith(("--out", "--pcapng", "--fix")) or "trace=" in word for word in words):
        return
    command(words, folder)


_URLS = (
    "sim:lamp.ul?timeout=0.1&attempts=3&fifo=16,16&crc=1&window=64&protocol=classic&polynomial=0x07",
    "sim:lamp.ul?plant=ramp&groups=4&base_hz=1000&gateware=2012",
    "serial:/absent?baud=3000000&parity=even&rts=1",
    "tcp:///absent?crc=1",
    *(re.sub(r":[^?]*", ":/absent", row.form, count=1) for row in SCHEMES.values() if "/dev/" in row.form),
    "mmap:/absent?size=4096&offset=0x1000",
    "bluetooth:whatever",
)


def urls(folder: Path) -> list[bytes]:
    (folder / "lamp.ul").write_text(_LAMP)
    return [os.fsencode(url) for url in _URLS]


def read_url(data: bytes, folder: Path) -> None:
    url = os.fsdecode(data)
    if _PORT.match(url) and not re.match(r"\w+:(//)?/absent\?", url):
        return
    if "trace=" in url or "reconnect" in url or "wait" in url:
        return
    before = Path.cwd()
    os.chdir(folder)
    try:
        with allowed(), connect(url) as link:
            link.read(0x10)
    finally:
        os.chdir(before)
