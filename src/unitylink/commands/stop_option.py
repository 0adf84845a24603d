# SPDX-License-Identifier: BSD-3-Clause
"""`--stop-file`: where a program notes that its robot is stopped."""

from __future__ import annotations

import click

stop_file_option = click.option(
    "--stop-file",
    metavar="FILE",
    help="Note there who has stopped the robot. While FILE exists, this program begins stopped.",
)
