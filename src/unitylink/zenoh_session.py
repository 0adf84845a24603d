# SPDX-License-Identifier: BSD-3-Clause
"""Opens sessions of the Zenoh library, and says in our errors what was wrong."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from unitylink.errors import LinkNotFound, UrlError
from unitylink.optional import absent
from unitylink.zenoh_sockets import close_without_waiting
from unitylink.zenoh_watch import WATCH

if TYPE_CHECKING:
    import zenoh


def open_session(
    file: str, settings: Mapping[str, Any], *, use: str, source: str, unreachable: str
) -> zenoh.Session:
    """Open a session with the configuration in `file`, or the default, and `settings` above it.

    A peer that is cut off holds up no other: its sockets are closed without waiting. A connection from which
    the session does not read is ended, and it connects again.

    `use` says for what the package is needed, `source` where the configuration comes from, and `unreachable`
    what it means if no session opens. Raises ToolError, UrlError or LinkNotFound.
    """
    try:
        import zenoh
    except ImportError:
        raise absent("eclipse-zenoh", use) from None
    what = file
    try:
        configuration = zenoh.Config.from_file(file) if file else zenoh.Config()
        for key, value in settings.items():
            what = f"{key} of {source}"
            configuration.insert_json5(key, json.dumps(value))
    except zenoh.ZError as error:
        raise UrlError(f"Zenoh does not take {what}: {_first(error)}") from None
    WATCH.add(_locators(configuration))
    try:
        session = zenoh.open(configuration)
    except zenoh.ZError as error:
        raise LinkNotFound(f"{unreachable}: {_first(error)}") from None
    close_without_waiting(session)
    return session


def _locators(configuration: zenoh.Config) -> list[str]:
    """Return where a session connects to: a list, or one for each mode."""
    told = json.loads(configuration.get_json("connect/endpoints"))
    lists = told.values() if isinstance(told, dict) else (told,)
    return [str(one) for some in lists if isinstance(some, list) for one in some]


def _first(error: Exception) -> str:
    """Return what an error of Zenoh says, without places in its source and our options of a locator."""
    return re.split(r" at /|\n|#so_", str(error))[0][:200]
