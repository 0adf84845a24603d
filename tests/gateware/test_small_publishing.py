# SPDX-License-Identifier: BSD-3-Clause
"""Publishing by the small engine's program: histories compare it with the reference.

They must also notice mistakes in it. tests/gateware/test_small_program.py has what is not publishing.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from typing import Any

import pytest
from reference.bus import Bus
from reference.framing import Borders, Frame
from reference.host import EPOCH, ask, frames_of, opening
from reference.publishing import PublishingDevice
from reference.settings import Settings
from reference.small_engine import SmallEngine, small_settings

from tests.gateware.mistakes import SOURCE, with_mistake
from tests.gateware.small_core import BAD as RTL_BAD
from tests.gateware.small_core import play
from unitylink import protocol as p

WIDTHS = [(2, 4), (1, 4), (4, 4), (2, 2), (1, 1), (3, 4)]
BAD = {0x18: p.REPLY_STATUS_BUS_ERROR, 0x19: p.REPLY_STATUS_BUS_TIMEOUT}
# bytes from the host, or what happens: ("strobes", how many), ("events", groups)
Step = bytes | tuple[str, int]
SILENCE = 9000  # clocks; a publish, or a reply with all counters, takes so long


def without_clocks(answer: bytes) -> list[Frame | bytes]:
    """Return the frames without the times in them, which the model of the engine does not have.

    A piece that is no frame, or a publish with the check of another session, stays as it is.
    """
    shown: list[Frame | bytes] = []
    for piece in Borders().feed(answer):
        outside = piece[0] in (p.DEVICE_KIND_HELLO, p.DEVICE_KIND_OPEN, p.DEVICE_KIND_CLOSED)
        frame = Frame.decode(piece, p.FRAME_OPEN_EPOCH if outside else EPOCH)
        if frame is not None and frame.kind == p.DEVICE_KIND_OPEN:
            frame = Frame(frame.kind, frame.payload[:2])
        elif frame is not None and frame.kind == p.DEVICE_KIND_PUBLISH:
            frame = Frame(frame.kind, frame.payload[:3] + frame.payload[7:])
        shown.append(frame or piece)
    return shown


def history(
    seed: int, settings: Settings, bad: Sequence[int] = tuple(BAD), length: int = 70
) -> Iterator[Step]:
    """Yield what a device that publishes sees: definitions, strobes, events, lost and damaged frames."""
    draw = random.Random(seed)
    a, d = settings.a, settings.d
    nonce, number, posts = 1, 0, 0
    sent: list[bytes] = []
    yield opening()
    for _ in range(length):
        chance = draw.random()
        if chance < 0.35:
            yield ("strobes", draw.choice((1, 1, 1, 2, 3)))
            continue
        if chance < 0.45:
            yield ("events", draw.randrange(1, 1 << settings.groups))
            continue
        if chance < 0.465:
            nonce += 1
            posts = 0
            close = ask(p.REQUEST_KIND_CLOSE, (number, 2)) if draw.random() < 0.5 else b""
            yield close + opening(nonce)
            continue
        address = (draw.choice((*range(0x10, 0x18), *bad)), a)
        if chance < 0.68:
            count = draw.choice((0, 1, 1, 1, 1, 2, 2, 3, 3, settings.group_size, settings.group_size + 1))
            words = [(draw.randrange(0x10, 0x18), a) for _ in range(count)]
            words += [address] * (draw.random() < 0.05)
            rate = draw.choice((0, 1, 1, 1, 1, 1, 2, 2, 3, 5, 0x101, 0xFFFF, 0x10000))
            flags = draw.choice((0, 0, 0, 1, 1, 1, 1, 1, 1, 2))
            told = len(words) + (draw.random() < 0.05)
            group = draw.randrange(settings.groups + (draw.random() < 0.1))
            wire = ask(
                p.REQUEST_KIND_DEFINE_GROUP, (number, 2), (group, 1), (rate, 4), (flags, 1), (told, 1), *words
            )
        elif chance < 0.80:
            value = draw.choice((1, 1, 1, 1, 1, 1, 1, 0, 2, 0x100))
            wire = ask(p.REQUEST_KIND_WRITE_CONTROL, (number, 2), (p.CONTROL_PUBLISH, 2), (value, 4))
        elif chance < 0.85:
            first = draw.choice(((p.CONTROL_PUBLISHES, 2), (p.CONTROL_ARM, 2), (p.CONTROL_GROUPS, 1)))
            wire = ask(p.REQUEST_KIND_READ_CONTROL, (number, 2), (first[0], 2), (first[1], 1))
        elif chance < 0.9:
            wire = ask(p.REQUEST_KIND_WRITE, (number, 2), address, (draw.randrange(1 << 8 * d), d))
        else:
            wire = ask(p.REQUEST_KIND_POST, (posts, 2), address, (draw.randrange(1 << 8 * d), d))
            posts += 1
            number -= 1
        number = (number + 1) % 0x10000
        sent.append(wire)
        fate = draw.random()
        if fate < 0.1:
            wire = wire[: draw.randrange(len(wire))] + b"\0"
        elif fate < 0.25 and chance < 0.9:  # a post may overtake a publish that waits for a reply
            wire = draw.choice(sent[-3:]) + wire
        yield wire


def all_on(settings: Settings, nonce: int) -> Iterator[Step]:
    """Yield a session in which every group publishes: it shows which one was served last before."""
    yield opening(nonce)
    for number in range(settings.groups):
        define = (number, 1), (1 + number % 2, 4), (number % 2, 1), (1, 1), (0x10 + number, settings.a)
        yield ask(p.REQUEST_KIND_DEFINE_GROUP, (number, 2), *define)
    yield ask(p.REQUEST_KIND_WRITE_CONTROL, (settings.groups, 2), (p.CONTROL_PUBLISH, 2), (1, 4))
    yield ("events", (1 << settings.groups) - 1)
    yield ("strobes", 2)
    counters = p.CONTROL_DEADMAN_TRIPS - p.CONTROL_FRAMES + 1
    yield ask(p.REQUEST_KIND_READ_CONTROL, (settings.groups + 1, 2), (p.CONTROL_FRAMES, 2), (counters, 1))


def play_reference(device: PublishingDevice, step: Step) -> bytes:
    if isinstance(step, bytes):
        return device.feed(step)
    what, value = step
    if what == "events":
        device.event(value)
    else:
        for _ in range(value):
            device.strobe()
    return device.serve()


def play_engine(engine: SmallEngine, step: Step) -> bytes:
    if isinstance(step, bytes):
        return engine.feed(step)
    what, value = step
    return engine.event(value) if what == "events" else engine.strobe(value)


def difference(program: Any, seed: int) -> str:
    """Return the first difference between the program and the reference in a history.

    The text is empty if there is none.
    """
    a, d = WIDTHS[seed % 6]
    settings = small_settings(a, d, groups=(6, 2, 3, 1)[seed % 4])
    reference = PublishingDevice(settings, Bus(dict(BAD)))
    engine = SmallEngine(program, settings, Bus(dict(BAD)), reply_steps=seed % 3 * 300)
    steps = list(history(seed, settings))
    for number, step in enumerate(steps):
        expected, told = play_reference(reference, step), play_engine(engine, step)
        if without_clocks(expected) != without_clocks(told) or reference.bus.log != engine.bus.log:
            return f"step {number}: {step!r}: {without_clocks(told)}, not {without_clocks(expected)}"
        if engine.holding:
            return f"step {number}: {step!r}: it keeps the bus"
    for step in all_on(settings, reference.nonce + 1):
        expected, told = play_reference(reference, step), play_engine(engine, step)
        if without_clocks(expected) != without_clocks(told):
            return f"in the end: {step!r}: {without_clocks(told)}, not {without_clocks(expected)}"
    return ""


def program_of(assembler: Any) -> Any:
    return assembler.assemble(SOURCE.read_text(encoding="utf-8"), "publishing")


@pytest.mark.parametrize(
    "seed", [*range(24), *(pytest.param(n, marks=pytest.mark.long) for n in range(24, 600))]
)
def test_a_history(assembler: Any, seed: int) -> None:
    assert not difference(program_of(assembler), seed)


# What the program forgets, and the instructions that it lacks then, with those around them in place of these.
MISTAKES = {
    "that a session begins without groups": (
        "#group_runs; tax 2; clr [x]; ld scratch",
        "#group_runs; ld scratch",
    ),
    "that a session begins without events": ("st [x]; ld #0xFF; note events_taken", "st [x]; ld #0xFF"),
    "to switch the events off": ("note publishing; note enabled", "note publishing"),
    "to switch publishing off": ("note publishing; note enabled", "note enabled"),
    "that a publish goes before a request": (".if publishing; jalert next; .end", ""),
    "that a publish needs the room of the reply": ("jsending now; in wants", "in wants"),
    "the other values of `publish`": ("ld [x]; and #0xFE; jnz invalid_counted; ld [x]", "ld [x]"),
    "the upper bytes of `publish`": ("or [x+]; or [x+]; jnz invalid_counted; ld [x]; and", "ld [x]; and"),
    "that publishing is on already": ("xor publish + 3; jz nothing; ", ""),
    "publishing in `arm`": ("or arm + 3; st arm + 3", "or arm + 3"),
    "the flags of a group": ("and #0xFF ^ FRAME_EVENT_FLAG; jnz invalid; ", ""),
    "that addresses may be cut": ("sub a_bytes; jnc invalid; st rest", "sub a_bytes; st rest"),
    "bytes behind the addresses": ("define_formed: ld rest; call judge_form", "define_formed: call judge"),
    "how many groups there are": ("jc no_group; ", ""),
    "how long a rate may be": ("or [x+]; jnz invalid_counted; get high", "ld [x+]; get high"),
    "how many words a group has": ("sub [x]; jnc no_group", "sub [x]"),
    "that strobes are kept": ("sbc high; jnc define_rate", "sbc high"),
    "when strobes are kept": ("sbc high; jnc define_rate", "sbc high; jc define_rate"),
    "to begin the sequence anew": ("give high; clr [x+]; clr [x+]", "give high; ld [x+]; ld [x+]"),
    "that a group without words is silent": ("ld count; jz define_event; ld low", "ld count; ld low"),
    "that a group forgets its event": ("ld bit; note events_taken; xor", "ld bit; xor"),
    "the other groups' events": ("ldx enabled; and [x]", "ldx enabled"),
    "to take a strobe": ("strobe: note strobe_taken", "strobe: ld #0"),
    "the upper byte of the strobes": ("adc #0; st [x+]; st high", "st [x+]; st high"),
    "the upper byte of a rate": ("ld high; xor [x]; jnz scan_next; ", ""),
    "to begin a rate anew": ("or #group_strobes; tax 2; clr [x+]; clr [x]; ld due", "ld due"),
    "an overrun": ("ld #publish_overruns; call bump; ", ""),
    "which group was served": ("chosen: st served; tax 2", "chosen: tax 2"),
    "to go around": ("jc chosen; ld last_group", "jc chosen; ld #0"),
    "that the rate is served first": ("and due; jz by_event", "and due; jmp by_event"),
    "to take an event": ("by_event: ld bit; note events_taken", "by_event: ld bit"),
    "that a publish belongs to the session": ("jz finish_publish; ", ""),
    "the number of a group": ("adc #0; put; ld served", "put; ld served"),
    "to keep the bus": ("put; ld #1; note hold", "put"),
    "to free the bus": ("jnz publish_word; note hold", "jnz publish_word"),
    "that a word cannot be read": ("call await; jnz publish_fails", "call await"),
    "where a publish ends": ("in place; st end", "ld #data & 0xFF; st end"),
    "to count on": ("#group_sequence + 1; tax 2; ld [x]; add #1; st [x]", "#group_sequence + 1; tax 2"),
    "the upper byte of the sequence": ("ld [x]; add #1; st [x]; publish_counted", "ld [x]; publish_counted"),
    "to count a publish": ("publish_counted: ld #publishes; call bump", "publish_counted:"),
    "what failed": ("jz publish_silent; ", ""),
    "to begin again": ("call bump; note again", "call bump"),
    "to free the bus after an error": ("note again; ld #0; note hold", "note again"),
}


def story() -> Iterator[Step]:
    """Yield what a random history hardly has.

    Long rates, many publishes, a word that cannot be read, an event from the session before.
    """
    number = iter(range(1000))

    def define(rate: int, *words: int, told: int | None = None) -> bytes:
        count = len(words) if told is None else told
        head = (next(number), 2), (0, 1), (rate, 4), (1, 1), (count, 1)
        return ask(p.REQUEST_KIND_DEFINE_GROUP, *head, *((word, 2) for word in words))

    def publishing(on: int) -> bytes:
        return ask(p.REQUEST_KIND_WRITE_CONTROL, (next(number), 2), (p.CONTROL_PUBLISH, 2), (on, 4))

    yield opening()
    yield define(1, 0x10, told=0x81)
    yield define(1, 0x10, 0x11, told=1)
    yield define(1, 0x10)
    yield publishing(1)
    yield from [("strobes", 1)] * 260
    yield define(0x102, 0x10)
    yield from [("strobes", 1)] * 520
    yield define(1, 0x10, *BAD)
    yield ("strobes", 1)
    yield define(1, 0x10)
    yield publishing(0)
    yield ("events", 1)
    yield opening(2)
    yield publishing(1)


def misses(program: Any) -> bool:
    """Tell whether the program does something else in the story, or lets the bus go while it publishes."""
    settings = small_settings(groups=1)
    reference, engine = (
        PublishingDevice(settings, Bus(dict(BAD))),
        SmallEngine(program, settings, Bus(dict(BAD))),
    )
    for step in story():
        expected, told = play_reference(reference, step), play_engine(engine, step)
        if without_clocks(told) != without_clocks(expected) or engine.holding:
            return True
    return not all(engine.held)


def a_request_goes_first(program: Any) -> bool:
    """Tell whether a request goes before a publish, at whatever step the reply before both has been sent."""
    settings = small_settings(groups=1)
    for steps in range(400, 460):
        engine = SmallEngine(program, settings, reply_steps=steps)
        engine.feed(opening())
        engine.feed(ask(p.REQUEST_KIND_DEFINE_GROUP, (0, 2), (0, 1), (1, 4), (0, 1), (1, 1), (0x10, 2)))
        begin = ask(p.REQUEST_KIND_WRITE_CONTROL, (1, 2), (p.CONTROL_PUBLISH, 2), (1, 4))
        told = frames_of(engine.feed(begin + ask(p.REQUEST_KIND_READ, (2, 2), (0x10, 2))))
        if [frame.kind == p.DEVICE_KIND_PUBLISH for frame in told] != [False, True, False]:
            return True
    return False


def test_a_story(assembler: Any) -> None:
    assert not misses(program_of(assembler))


def test_a_publish_goes_first(assembler: Any) -> None:
    assert not a_request_goes_first(program_of(assembler))


def test_the_longest_publish_takes_4400_clocks(assembler: Any) -> None:
    """The page states this number. An instruction takes two clocks."""
    steps: list[int] = []

    class Watched(SmallEngine):
        def _step(self) -> None:
            steps.append(self.position)
            super()._step()

    program = program_of(assembler)
    engine = Watched(program, small_settings(1, 4, groups=1))
    words = [(n, 1) for n in range(17)]
    engine.feed(opening())
    engine.feed(ask(p.REQUEST_KIND_DEFINE_GROUP, (0, 2), (0, 1), (1, 4), (0, 1), (17, 1), *words))
    engine.feed(ask(p.REQUEST_KIND_WRITE_CONTROL, (1, 2), (p.CONTROL_PUBLISH, 2), (1, 4)))
    begun = steps.index(program.labels["choose"])
    assert 4300 < 2 * (steps.index(program.labels["next"], begun) - begun) <= 4400


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_in_the_program_is_noticed(assembler: Any, mistake: str) -> None:
    program = with_mistake(assembler, *MISTAKES[mistake], name="publishing")

    def noticed(seed: int) -> bool:
        try:
            return misses(program) if seed < 0 else bool(difference(program, seed))
        except (AssertionError, IndexError):  # the program hangs, or sends something that is no reply
            return True

    assert any(noticed(seed) for seed in range(-1, 24)) or a_request_goes_first(program)


RTL = [  # seed, generics
    (0, {}),
    (1, {"stall_percent": 30, "bus_stall_percent": 30}),
    (2, {"byte_clocks": 90}),
    (3, {"bus_waits": 3, "byte_clocks": 4}),
    *(pytest.param(seed, {}, marks=pytest.mark.long) for seed in range(4, 24)),
]


@pytest.mark.parametrize(("seed", "generics"), RTL)
def test_a_history_on_rtl(rtl: Any, seed: int, generics: dict[str, Any]) -> None:
    """The first strobe comes when publishing begins, and no other. The events are edges."""
    a, d = WIDTHS[seed % 6]
    settings = small_settings(a, d, groups=(6, 2, 3, 1)[seed % 4], base_hz=1)
    bad = dict.fromkeys(range(RTL_BAD, RTL_BAD + 4), p.REPLY_STATUS_BUS_ERROR)
    bad |= dict.fromkeys(range(RTL_BAD + 4, RTL_BAD + 8), p.REPLY_STATUS_BUS_TIMEOUT)
    reference = PublishingDevice(settings, Bus(bad))
    story = [step for step in history(seed, settings, (RTL_BAD, RTL_BAD + 4), 20) if step[0] != "strobes"]
    sessions = sum(step.count(opening()[:9]) for step in story if isinstance(step, bytes))
    story += [step for step in all_on(settings, sessions + 1) if step[0] != "strobes"]
    raw: list[Any] = []
    for step in story:
        raw += [step] if isinstance(step, bytes) else [("events", step[1]), ("events", 0), ("quiet", SILENCE)]
    answers = iter(play(rtl, settings, raw, silence=SILENCE, edge_events=63, **generics))
    for number, step in enumerate(story):
        told = next(answers) if isinstance(step, bytes) else b"".join(next(answers) for _ in range(3))
        expected = play_reference(reference, step)
        assert without_clocks(told) == without_clocks(expected), f"step {number}: {step!r}"


@pytest.mark.parametrize(("a", "d", "period"), [(2, 4, 2600), (1, 1, 2200)])
def test_posts_at_the_full_rate_of_a_line_while_it_publishes(rtl: Any, a: int, d: int, period: int) -> None:
    """A UART of 80 clocks a byte, which is faster than the compiler allows: nothing is lost.

    The publishes take more than four fifths of the time.
    """
    count = 60
    settings = small_settings(a, d, groups=1, base_hz=50_000_000 // period)
    define = ask(p.REQUEST_KIND_DEFINE_GROUP, (0, 2), (0, 1), (1, 4), (0, 1), (1, 1), (0x21, a))
    on, off = (
        ask(p.REQUEST_KIND_WRITE_CONTROL, (n, 2), (p.CONTROL_PUBLISH, 2), (value, 4))
        for n, value in ((1, 1), (2, 0))
    )
    posts = [ask(p.REQUEST_KIND_POST, (n, 2), (0x20, a), (n, d)) for n in range(count)]
    sync = ask(p.REQUEST_KIND_SYNC, (3, 2))
    lost = ask(p.REQUEST_KIND_READ_CONTROL, (4, 2), (p.CONTROL_RECEIVE_OVERRUNS, 2), (1, 1))
    *_, told = play(
        rtl,
        settings,
        [opening(), define, on[:-1], b"\0" + b"".join(posts) + off + sync + lost],
        physical="uart",
    )
    published = [frame for frame in frames_of(told) if frame.kind == p.DEVICE_KIND_PUBLISH]
    *_, synced, overruns = [frame for frame in frames_of(told) if frame.kind != p.DEVICE_KIND_PUBLISH]
    assert int.from_bytes(synced.payload[4:6], "big") == count
    assert int.from_bytes(overruns.payload[4:], "big") == 0
    line_clocks = 80 * sum(map(len, posts))
    assert len(published) >= 0.8 * line_clocks / period
