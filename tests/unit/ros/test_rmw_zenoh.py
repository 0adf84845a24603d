# SPDX-License-Identifier: BSD-3-Clause
"""What rmw_zenoh_cpp sends, byte for byte. The vectors are from its design and its published logs."""

from __future__ import annotations

import random

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rosbags.typesys import Stores, get_typestore

from unitylink.errors import UrlError
from unitylink.ros.plane import SERVICE_FIELDS
from unitylink.ros.rmw_zenoh import PUBLISHER, Attachment, Endpoint, Graph, Qos, gid_of, read_attachment
from unitylink.ros.standard import STANDARD
from unitylink.ros.type_hash import message_hash, service_hash
from unitylink.ros.zenoh_session import RosSession, overrides

STRING = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
# From std_srvs/srv/*.json of ROS 2 Jazzy (ros-jazzy-std-srvs 5.3.6), which rosidl made.
GENUINE = {
    "std_srvs/Trigger": "RIHS01_eeff2cd6fa5ad9d27cdf4dec64818317839b62f212a91e6b5304b634b2062c5f",
    "std_srvs/SetBool": "RIHS01_abe9e4bb6b41b40e6789712c00ec8871923e089af3f667a79992a428cff2da0a",
}


def test_the_tokens_and_keys_are_those_of_the_talker_and_the_listener() -> None:
    chatter = Endpoint(2, "chatter", "std_msgs::msg::dds_::String_", STRING)
    assert chatter.key == f"2/chatter/std_msgs::msg::dds_::String_/{STRING}"
    talker = Graph(2, "8b20917502ee955ac4476e0266340d5c", "/", "talker")
    token = talker.token(10, PUBLISHER, chatter, Qos(7))
    assert token == (
        "@ros2_lv/2/8b20917502ee955ac4476e0266340d5c/0/10/MP/%/%/talker/%chatter/"
        f"std_msgs::msg::dds_::String_/{STRING}/::,7:,:,:,,"
    )
    assert gid_of(token).hex() == "ac170f31eadcd9ff0cd86d7a17907d1c"
    beside = Attachment(1, 1700000000123456789, gid_of(token)).packed()
    assert beside.hex() == "010000000000000015cd853dfe9c971710ac170f31eadcd9ff0cd86d7a17907d1c"
    assert Graph(0, "ab", "/lab/arm", "n").node == "@ros2_lv/0/ab/0/0/NN/%/%lab%arm/n"


def test_the_hashes_are_those_of_ros() -> None:
    store = get_typestore(Stores.ROS2_JAZZY)
    for name in STANDARD:
        assert message_hash(STANDARD, name) == store.hash_rihs01(name.replace("/", "/msg/")), name
    for name, genuine in GENUINE.items():
        assert service_hash(STANDARD, name, *SERVICE_FIELDS[name]) == genuine


@given(st.binary(max_size=40), st.integers(0, 2**63 - 1), st.integers(0, 2**63 - 1))
def test_an_attachment_is_read_back_or_refused(data: bytes, sequence: int, time_ns: int) -> None:
    given = Attachment(sequence, time_ns, bytes(range(16)))
    assert read_attachment(given.packed()) == given
    try:
        assert read_attachment(data).packed() == data
    except ValueError as error:
        assert "attachment" in str(error)


def test_hundred_thousand_mutated_attachments_are_read_or_refused() -> None:
    chance, whole = random.Random(7), Attachment(5, 10**18, bytes(range(16))).packed()
    refused = 0
    for _ in range(100_000):
        data = bytearray(whole)
        for _ in range(chance.randrange(1, 4)):
            data[chance.randrange(len(data))] = chance.randrange(256)
        del data[chance.randrange(20, 60) :]
        try:
            assert read_attachment(bytes(data)).packed() == bytes(data)
        except ValueError:
            refused += 1
    assert 20_000 < refused < 100_000
    with pytest.raises(ValueError, match="no attachment"):
        read_attachment(None)


@pytest.mark.parametrize("text", ["mode", "mode=client", '="client"', 'mode="client";x'])
def test_an_override_that_is_none_is_refused(text: str) -> None:
    with pytest.raises(UrlError, match=r"ZENOH_CONFIG_OVERRIDE: .* is not KEY=VALUE with a value of JSON"):
        overrides(text)


def test_a_key_that_zenoh_does_not_have_is_named() -> None:
    with pytest.raises(UrlError, match="Zenoh does not take no/such/key"):
        RosSession({"ZENOH_CONFIG_OVERRIDE": "no/such/key=1"}).opened()
    with pytest.raises(UrlError, match=r"Zenoh does not take /no/such\.json5"):
        RosSession({"ZENOH_SESSION_CONFIG_URI": "/no/such.json5"}).opened()
