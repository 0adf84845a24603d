# SPDX-License-Identifier: BSD-3-Clause
"""The native twin answers frames with the same bytes as the reference."""

from __future__ import annotations

from itertools import pairwise

import pytest
from reference.bus import Bus
from reference.device import ReferenceDevice
from reference.framing import Borders, Frame, field
from reference.host import opening, without_clock
from reference.scenario import Scenario, under_a_used_id
from reference.settings import Settings
from reference.small_engine import small_settings

from unitylink import _native
from unitylink import protocol as p
from unitylink.interface.board_configuration import BoardConfiguration

EPOCH = 5
SAFE = ((0x10, 0), (0x11, 0xFFFF))
ERRORS, SILENT = (0x38, 0x3B), (0x3C, 0x3F)


def twin_of(settings: Settings, fifo: int = 0) -> _native.Device:
    return _native.Device(
        BoardConfiguration(
            address_bits=8 * settings.a,
            data_bits=8 * settings.d,
            clock_hz=settings.clock_hz,
            base_hz=settings.base_hz,
            groups=max(settings.groups, 1),
            group_size=max(settings.group_size, 1),
            publish_mode=2 if settings.groups else 0,
            lists=settings.lists,
            protocol="both" if settings.features & p.CONTROL_VALUE_FEATURE_CLASSIC else "framed",
            bus_error_ranges=(ERRORS,),
            silent_ranges=(SILENT,),
            fifo=fifo,
            request_max=settings.request_max,
            reply_max=settings.reply_max,
            credit=settings.credit,
            window=settings.window,
            cache_bytes=settings.cache,
            exchanges=settings.exchanges,
            exchange_size=settings.exchange_size,
            gateware_version=settings.gateware_version,
            build=settings.build,
            spec_hash=settings.spec_hash,
            safe_words=settings.safe,
            long_frames=bool(settings.features & p.CONTROL_VALUE_FEATURE_LONG_FRAMES),
        )
    )


def reference_of(settings: Settings) -> ReferenceDevice:
    bad = dict.fromkeys(range(ERRORS[0], ERRORS[1] + 1), p.REPLY_STATUS_BUS_ERROR)
    bad |= dict.fromkeys(range(SILENT[0], SILENT[1] + 1), p.REPLY_STATUS_BUS_TIMEOUT)
    return ReferenceDevice(settings, Bus(bad))


def ask(twin: _native.Device, data: bytes, clocks: int = 5_000) -> bytes:
    answer = b""
    while data:
        data = data[twin.receive(data) :]
        twin.run_until(twin.clock + clocks)
        answer += twin.take()
    return answer


def open_session(twin: _native.Device, nonce: int = 1) -> None:
    """Open the first session of a device, with EPOCH."""
    assert len(list(Borders().feed(ask(twin, opening(nonce, EPOCH))))) == 2


def a_scenario(seed: int) -> None:
    """Play a scenario to both. They must answer the same, and have the same words at the end."""
    a, d = [(2, 4), (1, 4), (4, 4), (2, 2), (1, 1), (3, 4)][seed % 6]
    # First the features of the gateware, then all features of the protocol.
    credit, features = [(512, 0x1F), (0xFFFF, 0x3F)][seed % 2]
    settings = Settings(a, d, credit=credit, features=features, window=(8, 2, 32)[seed % 3], safe=SAFE)
    twin, reference = twin_of(settings), reference_of(settings)
    for number, step in enumerate(Scenario(seed, settings, addresses=(64, 64, 16)[seed % 3])):
        told = ask(twin, step)
        expected = reference.feed(step)
        assert without_clock(told) == without_clock(expected), (
            f"step {number} of seed {seed}: {step.hex(' ')}"
        )
    for address in range(0x38):
        assert twin.get(address) == reference.bus.words.get(address, 0), f"{address:#x}, seed {seed}"


def test_a_twin_of_the_small_engine() -> None:
    """It has the sizes of the small engine, and lacks what that lacks. tests/gateware compares the VHDL with
    the reference.
    """
    for seed in range(12):
        a, d = [(2, 4), (1, 4), (4, 4), (2, 2), (1, 1), (3, 4)][seed % 6]
        settings = small_settings(a, d, (8, 2, 4)[seed % 3], safe=SAFE)
        twin, reference = twin_of(settings), reference_of(settings)
        for step in Scenario(seed, settings):
            told, expected = ask(twin, step), reference.feed(step)
            assert without_clock(told) == without_clock(expected), f"seed {seed}: {step.hex(' ')}"


def test_60_scenarios() -> None:
    for seed in range(60):
        a_scenario(seed)


def test_the_dead_man_at_its_tick() -> None:
    settings = Settings(safe=SAFE)
    twin = twin_of(settings)
    tick = settings.clock_hz // settings.base_hz
    open_session(twin)
    ask(twin, Frame(p.REQUEST_KIND_WRITE, field((0, 2), (0x10, 2), (9, 4))).encode(EPOCH))
    deadman = field((1, 2), (p.CONTROL_DEADMAN_TICKS, 2), (3, 4))
    ask(twin, Frame(p.REQUEST_KIND_WRITE_CONTROL, deadman).encode(EPOCH))
    due = (twin.clock // tick + 3) * tick
    twin.run_until(due - 1)
    assert twin.get(0x10) == 9
    twin.run_until(due)
    assert (twin.get(0x10), twin.get(0x11)) == (0, 0xFFFF)
    denied = ask(twin, Frame(p.REQUEST_KIND_WRITE, field((2, 2), (0x10, 2), (9, 4))).encode(EPOCH))
    assert denied[0] == p.DEVICE_KIND_REPLY + p.REPLY_STATUS_DENIED


def test_safe_values_without_an_answer_are_written_at_each_tick_until_it_is_armed() -> None:
    settings = Settings(safe=((0x10, 0), (SILENT[0], 1), (0x11, 0xFFFF)))
    twin = twin_of(settings)
    tick = settings.clock_hz // settings.base_hz
    open_session(twin)
    deadman = field((0, 2), (p.CONTROL_DEADMAN_TICKS, 2), (3, 4))
    ask(twin, Frame(p.REQUEST_KIND_WRITE_CONTROL, deadman).encode(EPOCH))
    twin.run_until((twin.clock // tick + 3) * tick)
    for _ in range(3):
        twin.set(0x10, 9)  # as in a slave that has missed the write
        twin.set(0x11, 9)
        twin.run_until(twin.clock + tick - 1)
        assert twin.get(0x10) == twin.get(0x11) == 9
        twin.run_until(twin.clock + 1)
        assert (twin.get(0x10), twin.get(0x11)) == (0, 0xFFFF)
    read = field((1, 2), (p.CONTROL_DEADMAN_TRIPS, 2), (1, 1))
    told = ask(twin, Frame(p.REQUEST_KIND_READ_CONTROL, read).encode(EPOCH))
    (frame,) = [Frame.decode(piece, EPOCH) for piece in Borders().feed(told)]
    assert frame is not None and frame.payload[4:] == field((1, 4)), "one trip"
    open_session(twin, 2)
    arm = field((0, 2), (p.CONTROL_ARM, 2), (1, 4))
    ask(twin, Frame(p.REQUEST_KIND_WRITE_CONTROL, arm).encode(EPOCH))
    twin.set(0x10, 9)
    twin.run_until(twin.clock + 2 * tick)
    assert twin.get(0x10) == 9


def test_safe_values_that_are_taken_or_refused_are_written_once() -> None:
    settings = Settings(safe=((0x10, 0), (ERRORS[0], 1)))
    twin = twin_of(settings)
    tick = settings.clock_hz // settings.base_hz
    open_session(twin)
    deadman = field((0, 2), (p.CONTROL_DEADMAN_TICKS, 2), (3, 4))
    ask(twin, Frame(p.REQUEST_KIND_WRITE_CONTROL, deadman).encode(EPOCH))
    twin.run_until((twin.clock // tick + 3) * tick)
    twin.set(0x10, 9)
    twin.run_until(twin.clock + 2 * tick)
    assert twin.get(0x10) == 9


def test_publishes_carry_sequence_and_clock() -> None:
    settings = Settings()
    twin = twin_of(settings)
    tick = settings.clock_hz // settings.base_hz
    open_session(twin)
    define = field((0, 2), (1, 1), (2, 4), (0, 1), (2, 1), (0x10, 2), (0x11, 2))
    ask(twin, Frame(p.REQUEST_KIND_DEFINE_GROUP, define).encode(EPOCH))
    begun = twin.clock
    publish = field((1, 2), (p.CONTROL_PUBLISH, 2), (1, 4))
    published = ask(twin, Frame(p.REQUEST_KIND_WRITE_CONTROL, publish).encode(EPOCH), 0)
    twin.run_until(begun + 7 * tick)
    published += twin.take()
    frames = [frame for piece in Borders().feed(published) if (frame := Frame.decode(piece, EPOCH))]
    found = [frame.payload for frame in frames if frame.kind == p.DEVICE_KIND_PUBLISH]
    assert [payload[:3] for payload in found] == [field((1, 1), (n, 2)) for n in range(3)]
    clocks = [int.from_bytes(payload[3:7], "big") for payload in found]
    assert [later - earlier for earlier, later in pairwise(clocks)] == [2 * tick, 2 * tick]


def test_a_session_locks_the_classic_side() -> None:
    settings = Settings()
    twin = twin_of(settings)
    assert ask(twin, b"#W:001000000007\n") == b"#S_W\n"
    open_session(twin)
    assert ask(twin, b"#R:0010\n\0") == b"#S_R:00000007\n"
    assert ask(twin, b"#W:001000000008\n\0") == b"#?E_FBW\n"
    assert ask(twin, b"#EPS\n\0") == b"#?E_ICC\n"
    ask(twin, Frame(p.REQUEST_KIND_CLOSE, field((0, 2))).encode(EPOCH))
    assert ask(twin, b"#W:001000000008\n\0") == b"#S_W\n"


def test_an_id_that_was_another_requests() -> None:
    settings = Settings(window=2)
    reference, twin = reference_of(settings), twin_of(settings)
    open_session(twin)
    reference.feed(b"\0" + Frame(p.REQUEST_KIND_HELLO, b"\1\1").encode())
    reference.feed(Frame(p.REQUEST_KIND_OPEN, field((1, 2), (EPOCH, 2), (0, 1))).encode())
    answers = [reference.feed(step) for step in under_a_used_id(settings, EPOCH)]
    assert [ask(twin, step) for step in under_a_used_id(settings, EPOCH)] == answers
    kinds = [Frame.decode(piece, EPOCH).kind - 0xC0 for answer in answers for piece in Borders().feed(answer)]
    assert kinds[1:8] == [p.REPLY_STATUS_INVALID] * 7
    assert kinds[8:] == [
        p.REPLY_STATUS_NO_GROUP,
        p.REPLY_STATUS_BAD_ADDRESS,
        p.REPLY_STATUS_TOO_LONG,
        0,
        0,
        0,
    ]


def stalled_twin(settings: Settings) -> _native.Device:
    """Return a device in a session that publishes. Its host takes nothing from now on."""
    twin = twin_of(settings, fifo=64)
    open_session(twin)
    define = field((0, 2), (0, 1), (1, 4), (0, 1), (2, 1), (0x10, 2), (0x11, 2))
    ask(twin, Frame(p.REQUEST_KIND_DEFINE_GROUP, define).encode(EPOCH))
    ask(twin, Frame(p.REQUEST_KIND_WRITE, field((1, 2), (0x10, 2), (9, 4))).encode(EPOCH))
    deadman = field((2, 2), (p.CONTROL_DEADMAN_TICKS, 2), (5, 4))
    ask(twin, Frame(p.REQUEST_KIND_WRITE_CONTROL, deadman).encode(EPOCH))
    publish = field((3, 2), (p.CONTROL_PUBLISH, 2), (1, 4))
    ask(twin, Frame(p.REQUEST_KIND_WRITE_CONTROL, publish).encode(EPOCH), 0)
    return twin


def say(twin: _native.Device, data: bytes, clocks: int) -> None:
    """Send without taking the answers."""
    while data:
        data = data[twin.receive(data) :]
        twin.run_until(twin.clock + 50)
    twin.run_until(twin.clock + clocks)


def taken(twin: _native.Device, clocks: int) -> bytes:
    """Return what comes while the host takes all of it."""
    answer = b""
    for _ in range(20):
        twin.run_until(twin.clock + clocks // 20)
        answer += twin.take()
    return answer


def test_a_host_that_takes_nothing_trips_the_dead_man() -> None:
    settings = Settings(features=0x3F, safe=SAFE)
    twin = stalled_twin(settings)
    tick = settings.clock_hz // settings.base_hz
    twin.run_until((twin.clock // tick + 5) * tick)
    assert (twin.get(0x10), twin.get(0x11)) == (0, 0xFFFF)


def test_posts_go_on_while_the_host_takes_nothing_and_publishes_are_left_out() -> None:
    settings = Settings(features=0x3F, safe=SAFE)
    twin = stalled_twin(settings)
    tick = settings.clock_hz // settings.base_hz
    for number in range(20):
        say(twin, Frame(p.REQUEST_KIND_POST, field((number, 2), (0x10, 2), (number, 4))).encode(EPOCH), tick)
        assert twin.get(0x10) == number, "executed, and a sign of life"
    read = field((4, 2), (p.CONTROL_PUBLISHES, 2), (2, 1))
    say(twin, Frame(p.REQUEST_KIND_READ_CONTROL, read).encode(EPOCH), 0)
    told = taken(twin, 2 * tick)
    frames = [frame for piece in Borders().feed(told) if (frame := Frame.decode(piece, EPOCH))]
    (answer,) = (
        frame.payload
        for frame in frames
        if frame.kind == p.DEVICE_KIND_REPLY and frame.payload[:2] == b"\0\4"
    )
    published, left_out = (int.from_bytes(answer[at : at + 4], "big") for at in (4, 8))
    assert published <= 6, "as many as the FIFO holds"
    assert published + left_out == pytest.approx(20, abs=2), "every tick"


def test_frames_that_wait_are_signs_of_life() -> None:
    settings = Settings(features=0x3F, safe=SAFE)
    twin = stalled_twin(settings)
    tick = settings.clock_hz // settings.base_hz
    for number in range(4, 12):  # none of these is answered
        say(twin, Frame(p.REQUEST_KIND_READ, field((number, 2), (0x10, 2))).encode(EPOCH), 3 * tick)
        assert twin.get(0x10) == 9, "a host that sends is alive"
    twin.run_until(twin.clock + 6 * tick)
    assert twin.get(0x10) == 0


def test_only_arm_allows_the_classic_side_to_write_again() -> None:
    settings = Settings(features=0x3F, safe=SAFE)
    twin = stalled_twin(settings)
    tick = settings.clock_hz // settings.base_hz
    twin.run_until(twin.clock + 6 * tick)
    say(twin, Frame(p.REQUEST_KIND_CLOSE, field((4, 2))).encode(EPOCH), 0)
    taken(twin, tick)
    assert ask(twin, b"\0#W:001000000008\n\0") == b"#?E_FBW\n"
    assert ask(twin, b"#R:0010\n\0") == b"#S_R:00000000\n"
    open_session(twin, 2)
    arm = field((0, 2), (p.CONTROL_ARM, 2), (1, 4))
    ask(twin, Frame(p.REQUEST_KIND_WRITE_CONTROL, arm).encode(EPOCH))
    ask(twin, Frame(p.REQUEST_KIND_CLOSE, field((1, 2))).encode(EPOCH))
    assert ask(twin, b"\0#W:001000000008\n\0") == b"#S_W\n"
