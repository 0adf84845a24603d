# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink fleet security`: certificates and access control for Zenoh, from the description of a fleet."""

from __future__ import annotations

import click

from .fleet_run import fleet_argument
from .output import force_option


@click.command(short_help="Make the files for an encrypted network.")
@fleet_argument
@force_option
def security(file: str, *, force: bool) -> None:
    """Make the files for an encrypted network, on which each name may do what FLEET.toml says.

    They go into the folder that `security` below [fleet] names: a configuration of Zenoh for the router, for
    each robot, and for each name in `writers` and `readers`. The script make_certificates.sh makes their
    certificates. It needs openssl, and keeps the certificates that are there.

    \b
    Examples:
      unitylink fleet security fleet.toml && sh secrets/make_certificates.sh
      unitylink fleet status fleet.toml --as ana
    """
    from unitylink.errors import FleetError
    from unitylink.fleet.reader import read_fleet
    from unitylink.fleet.security import SCRIPT, security_files
    from unitylink.output_file import write_output

    fleet = read_fleet(file)
    if not fleet.security:
        raise FleetError(f'{file}: where do the files go? Add security = "secrets" below [fleet]')
    folder = fleet.place(fleet.security)
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    files = security_files(fleet, str(folder))
    for name, text in files.items():
        write_output(folder / name, text.encode(), force=force)
    click.echo(f"{len(files)} files in {folder}; now: sh {folder / SCRIPT}")
