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
    made = [known.types[f"rmw_dds_common/msg/{name}"] for name in ("Gid", "NodeEntitiesInfo")]
    gid = [made[0](np.arange(n, n + size, dtype=np.uint8)) for n in (1, 50, 100)]
    for at, one in enumerate(gid):
        one.data[16:] = 0
        assert at or len(one.data) == size
    node = made[1]("/lab", "arm", gid[1:], [gid[0]])
    whole = known.types["rmw_dds_common/msg/ParticipantEntitiesInfo"](gid[0], [node])
    theirs = bytes(known.serialize_cdr(whole, whole.__msgtype__))
    told = [bytes(one.data[:16]) for one in gid]
    assert encode(size, told[0], ("/lab", "arm"), told[1:], told[:1]) == theirs
    assert identifier_size(theirs) == size
    for count in range(4):  # nodes of a peer
        more = known.types["rmw_dds_common/msg/ParticipantEntitiesInfo"](gid[0], [node] * count)
        assert identifier_size(bytes(known.serialize_cdr(more, more.__msgtype__))) == size
    assert identifier_size(theirs[:-5]) == identifier_size(b"") == 0
