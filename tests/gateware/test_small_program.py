# SPDX-License-Identifier: BSD-3-Clause
"""The small engine's program: histories compare it with the reference.

They must also notice mistakes in it.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import pytest
from reference.bus import Bus
from reference.device import ReferenceDevice
from reference.framing import Frame, field
from reference.host import EPOCH, ask, frames_of, opening, without_clock
from reference.line import Line
from reference.scenario import Scenario
from reference.settings import Settings
from reference.small_engine import SmallEngine, small_settings

from tests.gateware.mistakes import SOURCE, with_mistake
from unitylink import protocol as p
from unitylink.layer2_message import Link

WIDTHS = [(2, 4), (1, 4), (4, 4), (2, 2), (1, 1), (3, 4)]
BAD = {0x38: p.REPLY_STATUS_BUS_ERROR, 0x39: p.REPLY_STATUS_BUS_TIMEOUT}
SAFE = ((0x10, 1), (0x11, 0xFF))


def test_the_files_made_from_the_program_are_not_stale(assembler: Any) -> None:
    programs = assembler.assembled(SOURCE.read_text(encoding="utf-8"))
    remedy = "python tools/small/assemble.py"
    assert assembler.PACKAGE.read_text(encoding="utf-8") == assembler.package(programs), remedy
    assert assembler.LISTING.read_text(encoding="utf-8") == assembler.listing(programs), remedy
    for name, program in programs.items():
        assert 4 * len(program.words) <= 3 * program.room, f"{name}: a quarter of its room stays free"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (" jmp nowhere", "line 1: jmp nowhere: there is no place nowhere"),
        ("a: put\na: put", "line 2: a stands twice"),
        (".var a\n.var a", "line 2: a stands twice"),
        ("\n ld #256", "line 2: ld #256: #256 is 256, and must be from 0 to 255"),
        (" ld 512", "line 1: ld 512: 512 is 512, and must be from 0 to 511"),
        (" halt", "line 1: halt : there is no instruction halt"),
        (" in time", "line 1: in time: "),
        (" out shift", "line 1: out shift: "),
        (" ld #later", "line 1: ld #later: later: name 'later' is not defined"),
        (" follow 256", "line 1: follow 256: 256 is 256, and must be from 0 to 255"),
        (" ldx 1024", "line 1: ldx 1024: 1024 is 1024, and must be from 0 to 1023"),
        (".if small", "line 1: .if small: there is plain and publishing, one at a time"),
        (".if plain\n.if plain", "line 2: .if plain: there is plain and publishing, one at a time"),
        (" put\n.if plain", "line 2: .if: there is no .end behind it"),
        (".end", "line 1: .end: there is no .if before it"),
        (" put\n" * 1025, "the program has 1025 instructions, and at most 1024 fit"),
    ],
)
def test_a_line_that_cannot_be_assembled_is_told(assembler: Any, text: str, message: str) -> None:
    with pytest.raises(assembler.Mistake) as told:
        assembler.assemble(text)
    assert str(told.value).startswith(message)


def end_of_all(settings: Settings, nonce: int) -> Iterator[bytes]:
    """Yield a session that asks for what the earlier histories have left in memory and counters."""
    yield opening(nonce)
    for number in range(0x40):
        yield ask(p.REQUEST_KIND_READ, (number, 2), (number, settings.a))
    yield ask(p.REQUEST_KIND_READ_CONTROL, (0x40, 2), (p.CONTROL_FRAMES, 2), (18, 1))


def history(seed: int, settings: Settings) -> Iterator[bytes]:
    """Yield the steps of a scenario, or of what scenarios lack: the dead-man, pieces of all lengths, more
    registers.
    """
    if seed % 2 == 0:
        yield from (step for step in Scenario(seed, settings, steps=40) if step)
        return
    draw = random.Random(seed)
    yield opening()
    sent = []
    posts, nonce = 0, 1
    if seed % 4 == 3:  # the host lost its board, so the dead-man has tripped
        yield ask(p.REQUEST_KIND_WRITE_CONTROL, (0, 2), (p.CONTROL_DEADMAN_TICKS, 2), (1 << 30, 4))
        nonce += 1
        yield opening(nonce)
    for number in range(60):
        kind = draw.choice((p.REQUEST_KIND_READ, p.REQUEST_KIND_WRITE, p.REQUEST_KIND_POST) * 3 + OTHERS)
        address = (draw.choice((0x10, 0x11, 0x20, 0x38, 0x39)), settings.a)
        data = (draw.randrange(1 << 8 * settings.d), settings.d)
        register = draw.choice((p.CONTROL_ARM, *[p.CONTROL_DEADMAN_TICKS] * 3, p.CONTROL_PUBLISH, 0x102))
        fields = {
            p.REQUEST_KIND_READ: (address,),
            p.REQUEST_KIND_READ_CONTROL: ((draw.randrange(0x50), 2), (draw.randrange(20), 1)),
            p.REQUEST_KIND_WRITE_CONTROL: ((register, 2), (draw.choice((0, 1, 1 << 30, 1 << 30)), 4)),
            p.REQUEST_KIND_SYNC: (),
            p.REQUEST_KIND_CLOSE: (),
        }.get(kind, (address, data))
        if kind == p.REQUEST_KIND_POST:
            wire = ask(kind, (posts, 2), *fields)
            posts += 1
        else:
            chained = p.FRAME_CHAINED_BIT * draw.randrange(2)
            barrier = p.FRAME_BARRIER_BIT * (draw.random() < 0.3)
            head = ((number, 2), (posts, 2))[: 2 if barrier else 1]
            wire = ask(kind | chained | barrier, *head, *fields)
        sent.append(wire)
        fate = draw.random()
        if fate < 0.1:
            wire = bytes(draw.randrange(1, 256) for _ in range(draw.choice((3, 20, 33, 34, 39, 60, 150))))
            wire = bytes([draw.randrange(0x80, 0x100)]) + wire + b"\0"
        elif fate < 0.2:
            wire = wire[: draw.randrange(len(wire))] + b"\0"
        elif fate < 0.4:
            wire += draw.choice(sent[-3:])
        if kind == p.REQUEST_KIND_CLOSE:  # the frames after a CLOSE belong to no session, or to the next one
            wire += sent[-1]
        if kind == p.REQUEST_KIND_CLOSE or draw.random() < 0.05:
            nonce += 1
            wire = sent[0] + wire + sent[-1] + opening(nonce if draw.random() < 0.8 else nonce - 1) + sent[0]
        if TIME_LOW not in wire:
            yield wire


OTHERS = (
    p.REQUEST_KIND_READ_CONTROL,
    p.REQUEST_KIND_READ_CONTROL,
    p.REQUEST_KIND_WRITE_CONTROL,
    p.REQUEST_KIND_WRITE_CONTROL,
    p.REQUEST_KIND_SYNC,
    p.REQUEST_KIND_CLOSE,
)
TIME_LOW = bytes([p.CONTROL_TIME_LOW])  # the value of this register is different each time


def difference(program: Any, seed: int) -> str:
    """Return the first difference between the program and the reference in a history.

    The text is empty if there is none.
    """
    a, d = WIDTHS[seed % 6]
    settings = small_settings(a, d, (8, 2, 4)[seed % 5 % 3], safe=SAFE)
    reference = ReferenceDevice(settings, Bus(dict(BAD)))
    engine = SmallEngine(program, settings, Bus(dict(BAD)), reply_steps=seed % 4 * 300)
    steps = list(history(seed, settings))
    for number, step in enumerate(steps):
        if seed % 3 == 2 and number == len(steps) // 2:  # reset in the middle of a session
            engine.reset()
            engine.feed(b"\0")  # after a border it takes frames
            reference = ReferenceDevice(settings, reference.bus, nonce=reference.nonce)
        expected, told = reference.feed(step), engine.feed(step)
        if without_clock(expected) != without_clock(told) or reference.bus.log != engine.bus.log:
            return f"step {number}: {step.hex(' ')}: {without_clock(told)}, not {without_clock(expected)}"
    for step in end_of_all(settings, reference.nonce + 1):
        expected, told = reference.feed(step), engine.feed(step)
        if without_clock(expected) != without_clock(told):
            return f"in the end: {step.hex(' ')}: {without_clock(told)}, not {without_clock(expected)}"
    return ""


@pytest.mark.parametrize(
    "seed", [*range(24), *(pytest.param(n, marks=pytest.mark.long) for n in range(24, 2000))]
)
def test_a_history(assembler: Any, seed: int) -> None:
    assert not difference(assembler.assemble(SOURCE.read_text(encoding="utf-8")), seed)


def test_it_looks_for_bytes_every_3700_clocks(assembler: Any) -> None:
    """It does so however long a frame is. An instruction takes two clocks. The page states this number."""
    program = assembler.assemble(SOURCE.read_text(encoding="utf-8"))
    looks: list[int] = []

    class Watched(SmallEngine):
        steps = 0

        def _step(self) -> None:
            if self.position == program.labels["next"]:
                looks.append(self.steps)
            self.steps += 1
            super()._step()

    settings = small_settings(4, 4)
    engine = Watched(program, settings)
    registers = ask(p.REQUEST_KIND_READ_CONTROL, (0, 2), (p.CONTROL_FRAMES, 2), (18, 1))
    sync = ask(p.REQUEST_KIND_SYNC | p.FRAME_BARRIER_BIT | p.FRAME_CHAINED_BIT, (1, 2), (0, 2))
    for step in (opening(), registers, sync, sync, ask(p.REQUEST_KIND_CLOSE, (2, 2)), b"\x83" * 200 + b"\0"):
        engine.feed(step)
    gaps = [behind - before for before, behind in pairwise(looks)]
    assert 1750 < max(gaps) <= 1850


def test_counters_stop_at_their_most(assembler: Any) -> None:
    program = assembler.assemble(SOURCE.read_text(encoding="utf-8"))
    engine = SmallEngine(program, small_settings())
    engine.feed(opening())
    frames = program.names["counters"]
    engine.memory[frames : frames + 4] = bytes.fromhex("fffffffe")
    read = [ask(p.REQUEST_KIND_READ_CONTROL, (n, 2), (p.CONTROL_FRAMES, 2), (1, 1)) for n in range(3)]
    told = [frame.payload[4:].hex() for frame in frames_of(engine.feed(b"".join(read)))]
    assert told == ["ffffffff"] * 3
    engine.memory[frames : frames + 4] = bytes.fromhex("0000ffff")
    (frame,) = frames_of(engine.feed(ask(p.REQUEST_KIND_READ_CONTROL, (3, 2), (p.CONTROL_FRAMES, 2), (1, 1))))
    assert frame.payload[4:].hex() == "00010000"


MISTAKES = {  # what the program forgets: (from, to)
    "to clear the counters at a reset": ("ldx counters; ld #nonce_h; call clear; ", ""),
    "to end the session at a reset": ("set epoch_h; set epoch_l; next:", "next:"),
    "to clear its words at a reset": ("ldx time_low; ld #cleared & 0xFF; call clear; ", ""),
    "to store the id": ("give id_l; give id_h; give status", "out [x+]; out [x+]; give status"),
    "to store the status": ("give status; give count; ret", "out [x+]; give count; ret"),
    "the first byte of the check": (
        "decode_code; in check; xor [x+]; jnz is_wrong",
        "decode_code; in check; out [x+]",
    ),
    "the last byte of the check": ("xor [x]; jnz is_wrong; ", ""),
    "that a wrong frame is dropped": ("is_wrong: ld #discarded_check & 0x7F", "is_wrong: ld kind"),
    "that a block may be cut": ("jnc is_wrong; st rest; ld [x]", "st rest; ld [x]"),
    "that a repeat is known": ("jz not_new; ", ""),
    "that an old id is stale": ("ld count; and #0x80; jnz stale; ", ""),
    "the order of chained requests": ("jnc order; ", ""),
    "the barrier": ("xor posts_l; jnz behind; ", ""),
    "that a post is old": ("jnz post_other; ", ""),
    "to count a post": ("add #1; st posts_l; ld", "add #1; ld"),
    "to empty the places": ("jnz session_place; ", ""),
    "the nonce of an OPEN": ("xor nonce_l; jnz stale; ", ""),
    "that a nonce is accepted once": ("st offered; tell trip", "tell trip"),
    "that OPEN trips the dead-man": ("st offered; tell trip", "st offered"),
    "that a request waits for an OPEN": ("st paused; jmp judged_kind", "jmp judged_kind"),
    "that a request waits for a CLOSE": ("set paused; is_alive:", "is_alive:"),
    "the epoch": ("ld epoch_l; st low; ld epoch_h", "ld epoch_h"),
    "that a denied write was not executed": ("xor #REPLY_STATUS_DENIED; jz answer; ", ""),
    "what a read failed of": ("call await; jnz unanswered; call slot", "call await; call slot"),
    "that a long piece is dropped": ("st over; st look; jmp free_head", "st look; jmp free_head"),
    "zeros in a reply": ("jnz encode; in x", "jnz sum_end; in x"),
    "a byte of a kept reply": ("give data + 1; ", "out [x+]; "),
    "that a request is counted": ("may: call bump_frames; ", "may: "),
    "that a form is wrong": ("judge_form: jnz invalid; ", "judge_form: add #0; "),
    "to free the ring": ("st head; out free; xor look", "st head; xor look"),
}


def damage_passes(program: Any) -> bool:
    """Return whether a WRITE with two flipped bits is executed or answered, wherever these bits are."""
    engine = SmallEngine(program, small_settings())
    engine.feed(opening())
    right = Frame(p.REQUEST_KIND_WRITE, field((0, 2), (0x20, 2), (0x12345678, 4))).encode(EPOCH)
    draw = random.Random(5)
    for _ in range(400):
        hurt = bytearray(right)
        for bit in draw.sample(range(8 * (len(hurt) - 1)), 2):
            hurt[bit // 8] ^= 1 << bit % 8
        if frames_of(engine.feed(bytes(hurt) + b"\0")) or engine.bus.log:
            return True
    assert frames_of(engine.feed(b"\0" + right))
    assert engine.bus.log == [("write", 0x20, 0x12345678)]
    return False


def test_a_frame_with_two_wrong_bits_does_nothing(assembler: Any) -> None:
    assert not damage_passes(assembler.assemble(SOURCE.read_text(encoding="utf-8")))


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_in_the_program_is_noticed(assembler: Any, mistake: str) -> None:
    program = with_mistake(assembler, *MISTAKES[mistake])

    def noticed(seed: int) -> bool:
        try:
            return bool(difference(program, seed))
        except (AssertionError, IndexError):  # the program hangs, or sends something that is no reply
            return True

    assert any(noticed(seed) for seed in range(24)) or damage_passes(program)


@pytest.mark.parametrize("seed", range(3))
def test_the_host_works_with_it_on_a_bad_line(assembler: Any, seed: int) -> None:
    """Whatever is lost, damaged, cut or doubled: each write reaches the bus once, and in order."""
    line = Line(seed)
    line.rate, line.reset_rate = 0.05, 0.0
    program = assembler.assemble(SOURCE.read_text(encoding="utf-8"))
    engine = SmallEngine(program, small_settings())
    line.device = engine  # type: ignore[assignment]  # it has `feed`, too
    with Link(line.url) as link:
        for number in range(12):
            link.write(0x20, number)
            assert link.read(0x20) == number
            link.post_many([0x21, 0x22], [number, 100 + number])
        link.write_many(range(0x30, 0x40), range(16))
        link.sync()
        assert link.read_many([*range(0x30, 0x40), 0x21, 0x22]).tolist() == [*range(16), 11, 111]
    written = [(address, value) for kind, address, value in engine.bus.log if kind == "write"]
    assert [value for address, value in written if address == 0x20] == list(range(12))
    posted = [(address, value) for address, value in written if address in (0x21, 0x22)]
    assert posted == [word for n in range(12) for word in ((0x21, n), (0x22, 100 + n))]
    assert sorted(word for word in written if word[0] >= 0x30) == [(0x30 + n, n) for n in range(16)]
