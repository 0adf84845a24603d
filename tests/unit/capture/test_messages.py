# SPDX-License-Identifier: BSD-3-Clause
"""The messages in a capture, whatever the packets in which they came."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from unitylink.capture import CaptureMessage, MessageReader, Packet, messages
from unitylink.layer1_stream import ClassicEncoder

NAMES = {0x88: "j1.cpos", 0x8C: "j1.pos_sp"}
CONFIGURATION = b"#CNF:01,04,20,02,03e8,02,10,02\n"


def read(*parts: tuple[str, bytes], **options: object) -> list[CaptureMessage]:
    packets = [
        Packet(float(index), "sent" if arrow == ">" else "received", data)
        for index, (arrow, data) in enumerate(parts)
    ]
    return list(messages(packets, MessageReader(NAMES, **options)))  # type: ignore[arg-type]


def meanings(*parts: tuple[str, bytes], **options: object) -> list[str]:
    return [
        message.meaning for message in read((">", b"#RLC\n"), ("<", CONFIGURATION), *parts, **options)[2:]
    ]


def test_requests_and_their_replies_are_matched_by_order() -> None:
    assert meanings(
        (">", b"#R:88\n#RM:0288ff\n#W:8C0000000a\n"),
        ("<", b"#S_R:00000005\n#S_RM:0000000100000002\n#S_W\n"),
    ) == [
        "read j1.cpos",
        "read j1.cpos, 0xff",
        "write j1.pos_sp = 0xa",
        "j1.cpos = 0x5",
        "j1.cpos = 0x1, 0xff = 0x2",
        "done",
    ]


def test_publishes_have_the_names_their_group_was_given() -> None:
    said = meanings(
        (">", b"#WSA:000188\n#WSR:00000a\n#WIC:0003\n#EPS\n"),
        ("<", b"#S_WSA\n#S_WSR\n#S_WIC\n#S_EPS\n%PUB:00010000000c\n"),
    )
    assert said[:4] == [
        "group 0 is j1.cpos",
        "group 0: publish every 10 base periods",
        "publish on event: groups 0, 1",
        "publishing on",
    ]
    assert said[-1] == "publish of group 0: j1.cpos = 0xc"


def test_a_capture_of_anything_is_read_to_its_end() -> None:
    """Requests without their data, configurations that no device has: a damaged message is shown as it is."""
    said = meanings(
        (">", b"#RM\n#RM:\n#WSA\n#WSA:00\n#WSR\n#RSI\n#WIC\n"), ("<", b"#CNF:01,54,20,02,03e8,02,10,02\n")
    )
    assert said[:2] == ["RM: unknown or not complete"] * 2
    assert said[-1] == "configuration that no device has"


@given(
    st.lists(
        st.tuples(
            st.sampled_from("<>"),
            st.lists(st.sampled_from([*"#$!%?:*\n", *"0f1:", "RM", "S_RM", "WSA", "CNF", "PUB", "04,"])),
        )
    )
)
def test_no_line_crashes_the_reader(parts: list[tuple[str, list[str]]]) -> None:
    read((">", b"#RLC\n"), ("<", CONFIGURATION), *((way, "".join(text).encode()) for way, text in parts))


def test_errors_say_what_they_are_about() -> None:
    assert meanings((">", b"#R:88\n"), ("<", b"#?E_FBR\n")) == [
        "read j1.cpos",
        "E_FBR: bus error on read (asked: read j1.cpos)",
    ]
    assert meanings(("<", b"?f4\n")) == ["datalink: checksum wrong or missing"]
    assert meanings(("<", b"?f8\n")) == ["datalink: parity and framing error on the line"]


def test_damage_is_believed_by_nobody() -> None:
    bad_sum, half, nonsense = read(("<", b"$S_R:40de1212*2e\n"), (">", b"#R:8\n"), ("<", b"hello\n"))
    assert (bad_sum.kind, bad_sum.meaning) == ("damaged", "bad checksum")
    assert half.kind == nonsense.kind == "damaged"


def test_a_fence_voids_what_was_asked_before() -> None:
    said = meanings(
        (">", b"#R:88\n!$RLC*9B\n"), ("<", CONFIGURATION), (">", b"#R:8c\n"), ("<", b"#S_R:00000001\n")
    )
    assert said[-1] == "j1.pos_sp = 0x1"


def test_without_a_configuration_widths_can_be_given() -> None:
    talk = ((">", b"#R:0088\n"), ("<", b"#S_R:0012\n"))
    assert "address width not known" in read(*talk)[0].meaning
    assert read(*talk, address_bytes=2, data_bytes=2)[1].meaning == "j1.cpos = 0x12"


def test_a_capture_that_ends_within_a_message_is_reported() -> None:
    (message,) = read((">", b"#R:"))
    assert (message.kind, message.meaning) == ("damaged", "the capture ends within this message")


def test_answers_written_before_their_requests_are_put_in_order() -> None:
    packets = [Packet(0.2, "received", b"#S_R:00000005\n"), Packet(0.1, "sent", b"#R:88\n")]
    assert [m.meaning for m in messages(packets, MessageReader(NAMES, address_bytes=1))] == [
        "read j1.cpos",
        "j1.cpos = 0x5",
    ]


@given(data=st.lists(st.tuples(st.booleans(), st.binary(max_size=30)), max_size=10))
def test_any_bytes_give_messages_that_hold_all_of_them(data: list[tuple[bool, bytes]]) -> None:
    found = read(*((">" if sent else "<", part) for sent, part in data))
    for direction, sent in (("sent", True), ("received", False)):
        whole = b"".join(part for side, part in data if side == sent)
        assert b"".join(m.data for m in found if m.direction == direction) == whole


@given(cuts=st.lists(st.integers(0, 60), max_size=6))
def test_packets_do_not_matter_only_bytes(cuts: list[int]) -> None:
    talk = ClassicEncoder(checked=True).encode("R", bytes([0x88])) * 4
    ends = sorted({len(talk), *(cut for cut in cuts if cut < len(talk))})
    pieces = [(">", talk[begin:end]) for begin, end in zip([0, *ends], ends, strict=False)]
    assert [m.text for m in read(*pieces)] == [talk[:9].decode().strip()] * 4
