# SPDX-License-Identifier: BSD-3-Clause
import pytest

from unitylink.errors import UnityLinkError
from unitylink.server.token_file import load_tokens
from unitylink.server.tokens import digest, new_token

ENTRY = '[[token]]\nname = "ana"\nsha256 = "{}"\nscopes = ["read"]\n'


def written(tmp_path, text, mode=0o600):
    path = tmp_path / "tokens.toml"
    path.write_text(text)
    path.chmod(mode)
    return path


def test_a_token_logs_its_user_in_and_no_other_does(tmp_path):
    token, other = new_token(), new_token()
    tokens = load_tokens(written(tmp_path, ENTRY.format(digest(token))))
    assert len(token) == 43
    assert tokens.user(token, 0.0).name == "ana"
    for wrong in (other, "", token[:-1], token + "x", digest(token), "\ud800"):
        assert tokens.user(wrong, 0.0) is None


def test_a_token_ends_at_the_begin_of_its_day_in_utc(tmp_path):
    text = ENTRY.format(digest("t")) + "expires = 1970-01-02\n"
    tokens = load_tokens(written(tmp_path, text))
    assert tokens.user("t", 86399.9) is not None
    assert tokens.user("t", 86400.0) is None


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "nobody could log in"),
        ("[[token]", "tokens.toml: "),
        ("token = 1", "begin each token with"),
        ("\npassword = 'x'", r"tokens\.toml, line 2: password is unknown"),
        (ENTRY.format("abc"), r"tokens\.toml, line 3: token 1 \(ana\): sha256 is no digest"),
        (ENTRY.format(digest("a")) + "admin = true", "line 5: token 1: admin is unknown; expected name"),
        ('token = [{name = "ana", admin = true}]', r"tokens\.toml: token 1: admin is unknown"),
        (ENTRY.format(digest("a")).replace('["read"]', '"read"'), "scopes is no list"),
        (ENTRY.format(digest("a")).replace('["read"]', "[]"), "scopes is no list"),
        (ENTRY.format(digest("a")).replace("read", "root"), r"line 4: token 1 \(ana\): 'root' is no scope"),
        (ENTRY.format(digest("a")).replace("ana", "a b"), "name is 'a b'"),
        (ENTRY.format(digest("a")) + "expires = 7", "expires is 7; expected a day"),
        (ENTRY.format(digest("a")) * 2, r"line 6: token 2: two tokens have the name ana"),
        (ENTRY.format(digest("a")) + ENTRY.format(digest("a")).replace("ana", "ben"), "the sha256"),
    ],
)
def test_a_file_that_is_wrong_is_refused_with_the_place(tmp_path, text, told):
    with pytest.raises(UnityLinkError, match=told):
        load_tokens(written(tmp_path, text))


def test_a_file_that_others_may_write_is_refused(tmp_path):
    path = written(tmp_path, ENTRY.format(digest("a")), 0o620)
    with pytest.raises(UnityLinkError, match="chmod go-w"):
        load_tokens(path)


def test_a_file_that_is_not_there_or_is_binary(tmp_path):
    with pytest.raises(UnityLinkError, match="No such file"):
        load_tokens(tmp_path / "none.toml")
    path = written(tmp_path, "")
    path.write_bytes(b"\xff\xfe")
    with pytest.raises(UnityLinkError, match=r"tokens\.toml"):
        load_tokens(path)
