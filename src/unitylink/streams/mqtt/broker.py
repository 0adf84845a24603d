# SPDX-License-Identifier: BSD-3-Clause
"""Where a broker is, and who we are there."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import unquote, urlsplit

from unitylink.dashboard.place import written
from unitylink.errors import UnityLinkError, shown

PASSWORD = "UNITYLINK_MQTT_PASSWORD"  # the environment variable
_PORTS = {"mqtt": 1883, "mqtts": 8883}


@dataclass(frozen=True)
class Broker:
    """An address. `secure` is TLS, with the certificates that this machine trusts."""

    host: str
    port: int
    secure: bool
    user: str | None = None
    password: str | None = field(default=None, repr=False)

    def __str__(self) -> str:
        return f"mqtt{'s' if self.secure else ''}://{written(self.host)}:{self.port}"


def read_broker(url: str, password_file: str | None = None) -> Broker:
    """Return the broker of `mqtt://[USER@]HOST[:PORT]`, or of `mqtts:`, which is TLS.

    The password is in a file or in the environment. Raises UnityLinkError if it cannot be.

    >>> read_broker("mqtts://ana@home.lan")
    Broker(host='home.lan', port=8883, secure=True, user='ana')
    """
    try:
        parts = urlsplit(url)
        port = parts.port
    except ValueError as error:
        raise UnityLinkError(f"--mqtt: {error}") from error
    if parts.password is not None:  # not shown, because it is in there
        raise UnityLinkError(f"--mqtt: leave the password out of the URL; put it into a file or {PASSWORD}")
    if parts.scheme not in _PORTS or not parts.hostname or parts.path not in ("", "/") or parts.query:
        raise UnityLinkError(f"--mqtt {shown(url)}: expected mqtt://[USER@]HOST[:PORT], or mqtts: for TLS")
    user = unquote(parts.username) if parts.username else None
    password = os.environ.get(PASSWORD)
    if password_file is not None:
        try:
            password = Path(password_file).read_text(encoding="utf-8").removesuffix("\n")
        except (OSError, ValueError) as error:
            raise UnityLinkError(f"--mqtt-password-file {password_file}: {error}") from error
    if user is None and password_file is not None:
        raise UnityLinkError("--mqtt-password-file: the URL names no user; write mqtt://USER@HOST")
    secure = parts.scheme == "mqtts"
    return Broker(parts.hostname, port or _PORTS[parts.scheme], secure, user, password if user else None)
