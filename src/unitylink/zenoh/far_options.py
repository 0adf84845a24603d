# SPDX-License-Identifier: BSD-3-Clause
"""The URL `zenoh:NAME?…`: which robot, how to get on the network, and how long to wait. Opens nothing."""

from __future__ import annotations

import re
from dataclasses import dataclass
from urllib.parse import parse_qsl

from unitylink.errors import UrlError

from .keys import Keys
from .session import Network

OPTIONS = ("connect", "config", "timeout", "attempts", "reconnect", "spec_hash", "name")
_NAME = re.compile(r"[A-Za-z0-9_-]{0,20}")
TIMEOUT_S, TIMEOUT_MOST_S, ATTEMPTS, ATTEMPTS_MOST = 0.3, 60.0, 3, 100


@dataclass(frozen=True)
class FarOptions:
    """What the URL of a robot on a Zenoh network says. `spec_hash` is 16 hex digits, `any`, or empty.

    `name` is what others see of this client, if it holds a lease for example.
    """

    url: str
    keys: Keys
    network: Network
    timeout_s: float = TIMEOUT_S
    attempts: int = ATTEMPTS
    reconnect: bool = True
    spec_hash: str = ""
    name: str = ""


def read_far_url(url: str) -> FarOptions:
    """Return what a URL says. Raises UrlError with what is known instead of what is wrong.

    >>> read_far_url("zenoh:lab/arm1?connect=tcp/10.0.0.7:7447").keys.name
    'lab/arm1'
    """
    _, _, rest = url.partition(":")
    name, _, query = rest.partition("?")
    options: dict[str, str] = {}
    for key, value in parse_qsl(query, keep_blank_values=True):
        if key not in OPTIONS:
            raise UrlError(f"link URL {url!r}: no option {key!r}; there are {', '.join(OPTIONS)}")
        if key in options:
            raise UrlError(f"link URL {url!r}: {key} is given twice")
        options[key] = value
    try:
        keys = Keys(name)
        timeout_s = float(options.get("timeout", TIMEOUT_S))
        attempts = int(options.get("attempts", ATTEMPTS))
    except ValueError as error:
        raise UrlError(f"link URL {url!r}: {error}") from None
    if not 0 < timeout_s <= TIMEOUT_MOST_S or not 1 <= attempts <= ATTEMPTS_MOST:
        raise UrlError(
            f"link URL {url!r}: timeout is up to {TIMEOUT_MOST_S:g} s, and attempts are 1 to {ATTEMPTS_MOST}"
        )
    if options.get("reconnect", "1") not in ("0", "1"):
        raise UrlError(f"link URL {url!r}: reconnect is 0 or 1")
    if not _NAME.fullmatch(options.get("name", "")):
        raise UrlError(f"link URL {url!r}: name has up to 20 letters, digits, `_` or `-`")
    return FarOptions(
        url,
        keys,
        Network(connect=options.get("connect", ""), config=options.get("config", "")),
        timeout_s,
        attempts,
        options.get("reconnect", "1") == "1",
        options.get("spec_hash", "").lower(),
        options.get("name", ""),
    )
