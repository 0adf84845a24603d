# SPDX-License-Identifier: BSD-3-Clause
"""The files with which a server encrypts its connections.

TLS of programs is native, with this machine's OpenSSL. That of browsers is Python's.
"""

from __future__ import annotations

import os
import ssl
import stat
from dataclasses import dataclass

from unitylink import _native
from unitylink.errors import UnityLinkError


@dataclass(frozen=True)
class TlsFiles:
    """Files in the format PEM.

    `certificate` is the server's. `key` is its key; empty: it is in the same file. If `authorities` is
    given, each client must show a certificate that one of these has signed. "system" means those that this
    machine trusts.
    """

    certificate: str
    key: str = ""
    authorities: str = ""

    def check(self) -> None:
        """Raises UnityLinkError or LinkNotFound, with the file and the remedy, if they cannot be used."""
        _native.check_tls(self.certificate, self.key, self.authorities)
        path = self.key or self.certificate
        if os.stat(path).st_mode & (stat.S_IROTH | stat.S_IWOTH):
            raise UnityLinkError(
                f"{path}: every user of this machine may use this key; run chmod o-rwx {path}"
            )

    def context(self) -> ssl.SSLContext:
        """Return the same for a server in Python: TLS 1.3, with what `check` has found good."""
        made = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        made.minimum_version = ssl.TLSVersion.TLSv1_3
        made.load_cert_chain(self.certificate, self.key or None, password="")
        if self.authorities == "system":
            made.load_default_certs(ssl.Purpose.CLIENT_AUTH)
        elif self.authorities:
            made.load_verify_locations(self.authorities)
        if self.authorities:
            made.verify_mode = ssl.CERT_REQUIRED
        return made
