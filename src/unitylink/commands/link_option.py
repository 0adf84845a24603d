# SPDX-License-Identifier: BSD-3-Clause
"""The argument LINK and the option `--spec`, and opening what they name."""

from __future__ import annotations

import logging
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar
from urllib.parse import parse_qsl

import click

from unitylink.connection.schemes import SCHEMES, forms

from .failure import Failure
from .names import Names
from .root_option import part_of

if TYPE_CHECKING:
    from unitylink.layer2_message import Link
    from unitylink.spec.model import Spec

F = TypeVar("F", bound=Callable[..., Any])

_SCHEME = re.compile(r"[a-z][a-z0-9+.-]*:")  # the scheme of a URL, as in RFC 3986


def is_link(text: str) -> bool:
    """Tell a LINK from a name. A LINK begins with a scheme and a colon, which no name has."""
    return bool(_SCHEME.match(text))


def _checked(ctx: click.Context, parameter: click.Parameter, value: str) -> str:
    if is_link(value):
        return value
    if value.endswith(".ul"):
        raise click.UsageError(f"LINK comes first and '{value}' is a spec; did you mean sim:{value}?", ctx)
    if value.startswith("/dev/"):
        raise click.UsageError(f"'{value}' is not a LINK; did you mean serial:{value}?", ctx)
    raise click.UsageError(
        f"LINK comes first and '{value}' is not a LINK; a LINK looks like {forms()}",
        ctx,
    )


link_argument = click.argument("link", metavar="LINK", callback=_checked)
spec_option = click.option(
    "--spec",
    "spec_file",
    metavar="FILE",
    help="The spec that gives the names. A sim:, rtl:, bit: or zenoh: link brings its own.",
)


@dataclass(frozen=True)
class Target:
    """An open link and the names on it."""

    link: Link
    names: Names

    @property
    def spec(self) -> Spec | None:
        return self.names.spec


def simulated_spec(link: str) -> str | None:
    """Return the file that a `sim:`, `rtl:` or `bit:` link simulates, or None for other links.

    A `bit:` link to a bitstream has no spec, except with `spec=FILE`.

    >>> simulated_spec("sim:arms/scara.ul?plant=ramp")
    'arms/scara.ul'
    """
    kind, _, rest = link.partition(":")
    if kind not in SCHEMES or not SCHEMES[kind].virtual:
        return None
    path, _, query = rest.partition("?")
    if kind == "bit":
        from unitylink.simulate.bit.link import names_spec

        return path if names_spec(path) else dict(parse_qsl(query)).get("spec")
    return path


def load_names(link: str | None, spec_file: str | None) -> Names:
    """Return the names that belong to a link: those of `--spec`, of the `sim:` link, or none."""
    from unitylink.spec import load

    simulated = simulated_spec(link) if link else None
    if (
        simulated is not None
        and spec_file is not None
        and Path(simulated).resolve() != Path(spec_file).resolve()
    ):
        raise click.UsageError(f"a sim:, rtl: or bit: link brings its own spec; leave --spec {spec_file} out")
    file = spec_file if spec_file is not None else simulated
    if file is None and link is not None and link.startswith("zenoh:"):
        from unitylink.zenoh.link import spec_of

        spec, path = spec_of(link)
        return Names(spec, str(path))
    if file is None:
        return Names(None)
    if not file:
        raise Failure("sim: names no spec", "write the file after the colon: sim:arm.ul")
    spec = load(file)
    root = dict(parse_qsl(link.partition("?")[2])).get("root") if link and simulated else None
    return Names(part_of(spec, root), file)


class _Complaints(logging.Handler):
    """Prints logged messages, such as a failed read, while the link exists.

    The end of the link itself is reported as the command's error.
    """

    link: Link | None = None

    def __init__(self, quiet: bool) -> None:
        super().__init__(logging.WARNING)
        self._quiet = quiet

    def emit(self, record: logging.LogRecord) -> None:
        if not self._quiet and (self.link is None or not self.link.closed):
            click.echo(record.getMessage(), err=True)


@contextmanager
def open_target(
    link: str, spec_file: str | None, *, quiet: bool = False, check: bool = True
) -> Iterator[Target]:
    """Open LINK and load its names. The link is closed at the end.

    Raises DeviceMismatch if the gateware was built from another spec, unless `check` is False. Logged
    messages go to stderr. With `quiet`, the command shows them itself.
    """
    # done first, because a mistake in the spec can be reported without a device
    names = load_names(link, spec_file)
    from unitylink import connect

    logger, complaints = logging.getLogger("unitylink"), _Complaints(quiet)
    logger.addHandler(complaints)
    try:
        with connect(link) as opened:
            complaints.link = opened
            opened.check_time_passes("a command")
            if check:
                names = names.on(opened)
            yield Target(opened, names)
    finally:
        logger.removeHandler(complaints)
