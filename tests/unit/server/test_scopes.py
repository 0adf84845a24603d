# SPDX-License-Identifier: BSD-3-Clause
import pytest

from unitylink.errors import UnityLinkError
from unitylink.server.scopes import Rights, scope


@pytest.mark.parametrize("text", ["read", "write", "arm", "admin", "read j1.*", "write j[2].*"])
def test_a_scope_is_shown_as_it_is_written(text):
    assert str(scope(text)) == text


@pytest.mark.parametrize("text", ["", "reed", "arm j1", "write j1 j2", "admin *", "write ../j1", "READ"])
def test_a_text_that_is_no_scope_is_refused(text):
    with pytest.raises(UnityLinkError):
        scope(text)


def test_write_includes_read_of_the_same_part_alone():
    rights = Rights.of(["write j1"])
    assert rights.allow("read", "j1.angle")
    assert not rights.allow("read", "j2.angle")
    assert not rights.allow("read")
    assert not rights.allow("arm")


def test_admin_includes_all():
    rights = Rights.of(["admin"])
    assert all(rights.allow(action) for action in ("read", "write", "arm", "admin"))


def test_arm_allows_nothing_else():
    rights = Rights.of(["arm"])
    assert rights.allow("arm")
    assert not any(rights.allow(action, "j1") for action in ("read", "write", "admin"))


def test_parts_are_the_outermost_ones():
    rights = Rights.of(["read j1.motor", "write j1", "read j2", "arm"])
    assert rights.parts("read") == ("j1", "j2")
    assert rights.parts("write") == ("j1",)
    assert Rights.of(["admin", "read j1"]).parts("read") == ("",)
    assert Rights.of(["arm"]).parts("read") == ()
