# SPDX-License-Identifier: BSD-3-Clause
"""The options of `unitylink serve` and `unitylink dashboard` about encryption."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from .several_options import Command, with_options

if TYPE_CHECKING:
    from unitylink.server.tls_files import TlsFiles


_OPTIONS = (
    click.option(
        "--tls-cert", metavar="FILE", help="Encrypt everything (TLS 1.3). The server's certificate, in PEM."
    ),
    click.option("--tls-key", metavar="FILE", help="Its key, if that is in another file."),
    click.option(
        "--tls-ca",
        metavar="FILE",
        help="Let in only clients whose certificate one of these has signed. They need a token, too.",
    ),
)


def tls_options(command: Command) -> Command:
    """Give a command `--tls-cert --tls-key --tls-ca`: the arguments of `tls_files_of`."""
    return with_options(command, _OPTIONS)


def tls_files_of(tls_cert: str | None, tls_key: str | None, tls_ca: str | None) -> TlsFiles | None:
    """Return the files, checked, or None if nothing is to be encrypted."""
    from unitylink.server.tls_files import TlsFiles

    if tls_cert is None:
        for name, value in (("--tls-key", tls_key), ("--tls-ca", tls_ca)):
            if value is not None:
                raise click.UsageError(f"{name} needs --tls-cert FILE, the certificate of the server")
        return None
    files = TlsFiles(tls_cert, tls_key or "", tls_ca or "")
    files.check()
    return files


def exposed(what: str, tls: TlsFiles | None) -> click.UsageError:
    """Return the error about a place that other machines could reach, which has to be said by --anyone."""
    how = "" if tls else ", and tokens go there unencrypted"
    more = "" if tls else ", and --tls-cert to encrypt"
    return click.UsageError(f"{what}{how}; if you want that, add --anyone{more}")
