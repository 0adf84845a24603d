# SPDX-License-Identifier: BSD-3-Clause
"""What a node on DDS tells ROS 2 of itself has the bytes of ROS 2."""

from __future__ import annotations

import numpy as np
import pytest

from unitylink.ros.dds_graph import encode, identifier_size


@pytest.mark.parametrize(("release", "size"), [("ROS2_HUMBLE", 24), ("ROS2_JAZZY", 16)])
def test_a_node_is_told_in_the_form_of_each_release(release: str, size: int) -> None:
    """The bytes are those of rosbags. The node also tells them apart, in what its peers send."""
    from rosbags.typesys import Stores, get_typestore

    known = get_typestore(Stores[release])
    gid, node, participant = (
        known.types[f"rmw_dds_common/msg/{name}"]
        for name in ("Gid", "NodeEntitiesInfo", "ParticipantEntitiesInfo")
    )
    told = [bytes(range(n, n + 16)) for n in (1, 50, 100)]
    own, *ends = [gid(np.frombuffer(one.ljust(size, b"\0"), dtype=np.uint8)) for one in told]
    one_node = node("/lab", "arm", ends, [own])

    def sent(count: int) -> bytes:
        message = participant(own, [one_node] * count)
        return bytes(known.serialize_cdr(message, message.__msgtype__))

    theirs = sent(1)
    assert encode(size, told[0], ("/lab", "arm"), told[1:], told[:1]) == theirs
    assert identifier_size(theirs) == size
    assert [identifier_size(sent(count)) for count in range(4)] == [size] * 4, "nodes of a peer"
    assert identifier_size(theirs[:-5]) == identifier_size(b"") == 0
