# SPDX-License-Identifier: BSD-3-Clause
"""Who may write which robot, as files for Zenoh: certificates at both ends, and access control. No I/O.

Each robot, each person and each program has a certificate. Its common name is the name by which the router
knows it. The router refuses all that is not allowed here. What somebody who may write can do with a robot,
its bridge decides (`may`).
"""

from __future__ import annotations

import json
import re
import shlex
from collections.abc import Iterable
from typing import Any

from unitylink.errors import FleetError
from unitylink.zenoh.session import LEASE_MS

from .description import ROBOT_PREFIX, ROUTER_NAME, Fleet, inside
from .supervisor import state_key

AUTHORITY = "authority"
SCRIPT = "make_certificates.sh"
DAYS = 365
_NAME = re.compile(r"[A-Za-z0-9_.@-]{1,60}")
_PLACE = re.compile(r"tls/(?:\[(?P<six>[0-9A-Fa-f:]+)\]|(?P<host>[A-Za-z0-9.-]+)):\d+")
_IN, _OUT, _BOTH = ["ingress"], ["egress"], ["ingress", "egress"]
_ASK = ["query", "liveliness_query", "declare_liveliness_subscriber", "declare_subscriber"]
_TELL = ["put", "reply", "liveliness_token", "declare_queryable", "declare_subscriber"]
_ALL = sorted({*_ASK, *_TELL, "delete"})
# What a reader asks: no key here leads to a write, because `hello_read` gives no right to one.
_READ = (
    "hash",
    "spec",
    "schema",
    "state",
    "clock",
    "hello_read",
    "value/**",
    "do/*",
    "publish/**",
    "words/**",
)
_SEEN = ("bridge/*", "board/*", "lease/**")  # tokens, for all who may read


def security_files(fleet: Fleet, folder: str) -> dict[str, str]:
    """Return the files by name: for the router, for each robot and each user, and a script for certificates.

    `folder` is where they will be.

    Raises FleetError if the description does not say who may write, or where the router is.
    """
    users = _users(fleet)
    host = _host(fleet)
    files = {f"{ROUTER_NAME}.json5": _router(fleet, users)}
    for name in (*(f"{ROBOT_PREFIX}{robot.name}" for robot in fleet.robots), *users):
        files[f"{name}.json5"] = _client(fleet, name)
    files[SCRIPT] = _script(host, [name.removesuffix(".json5") for name in files])
    within_json = json.dumps(folder)[1:-1]
    return {name: text.replace("{folder}", within_json) for name, text in files.items()}


def _users(fleet: Fleet) -> tuple[str, ...]:
    for robot in fleet.robots:
        place = f"{fleet.file}: {robot.name}"
        if not robot.writers:
            raise FleetError(f'{place}: who may write it? Add writers = ["ana"] there or below [fleet]')
        for name in (*robot.writers, *robot.readers):
            if not _NAME.fullmatch(name) or name.startswith(ROBOT_PREFIX) or name in (ROUTER_NAME, AUTHORITY):
                raise FleetError(
                    f"{place}: {name!r} is no name for a certificate; expected 1 to 60 letters, digits, and "
                    f"any of . @ - _; not {ROUTER_NAME}, {AUTHORITY}, nor one that begins with {ROBOT_PREFIX}"
                )
    named = (name for robot in fleet.robots for name in (*robot.writers, *robot.readers))
    return tuple(dict.fromkeys(named))


def _host(fleet: Fleet) -> str:
    match = _PLACE.fullmatch(fleet.connect or fleet.router)
    if match is None:
        where = fleet.connect or fleet.router
        raise FleetError(
            f'{fleet.file}: {where} is not encrypted; with TLS, write router = "tls/127.0.0.1:7447"'
        )
    host = match["six"] or match["host"]
    return f"IP:{host}" if match["six"] or re.fullmatch(r"[\d.]+", host) else f"DNS:{host}"


def _router(fleet: Fleet, users: Iterable[str]) -> str:
    rules: list[dict[str, Any]] = []
    policies: list[dict[str, Any]] = []
    subjects: list[dict[str, Any]] = []
    for robot in fleet.robots:
        key = robot.key
        below = [f"{key}/**"]
        rules.append(_rule(f"be {robot.name}", _BOTH, _ALL, below))
        rules.append(_rule(f"write {robot.name}, ask", _IN, [*_ASK, "put", "liveliness_token"], below))
        rules.append(_rule(f"write {robot.name}, hear", _OUT, _TELL, below))
        read = [f"{key}/{one}" for one in _READ]
        seen = [f"{key}/{one}" for one in _SEEN]
        rules.append(_rule(f"read {robot.name}, ask", _IN, ["query", "declare_subscriber"], read))
        rules.append(_rule(f"read {robot.name}, look", _IN, _ASK[1:3], seen))
        rules.append(_rule(f"read {robot.name}, come", _IN, ["liveliness_token"], [f"{key}/client/*"]))
        rules.append(_rule(f"read {robot.name}, stop", _IN, ["put", "query"], [f"{key}/stop"]))
        rules.append(_rule(f"read {robot.name}, hear", _OUT, _TELL, [*read, *seen, f"{key}/stop"]))
    told = [state_key(fleet.name)]
    rules.append(_rule("the fleet, ask", _IN, ["query"], told))
    rules.append(_rule("the fleet, hear", _OUT, ["reply", "declare_queryable"], told))
    for robot in fleet.robots:
        subjects.append(
            {"id": f"{ROBOT_PREFIX}{robot.name}", "cert_common_names": [f"{ROBOT_PREFIX}{robot.name}"]}
        )
        policies.append({"rules": [f"be {robot.name}"], "subjects": [f"{ROBOT_PREFIX}{robot.name}"]})
    for user in users:
        subjects.append({"id": user, "cert_common_names": [user]})
        may = ["the fleet, ask", "the fleet, hear"]
        for robot in fleet.robots:
            kind = "write" if user in robot.writers else "read" if user in robot.readers else ""
            may += [rule["id"] for rule in rules if kind and rule["id"].startswith(f"{kind} {robot.name}, ")]
        policies.append({"rules": may, "subjects": [user]})
    access = {
        "enabled": True,
        "default_permission": "deny",
        "rules": rules,
        "subjects": subjects,
        "policies": policies,
    }
    settings: dict[str, Any] = {
        "mode": "router",
        "listen": {"endpoints": [fleet.router]},
        "scouting": {"multicast": {"enabled": False}, "gossip": {"enabled": False}},
        "transport": {
            "link": {
                "protocols": ["tls"],
                "tx": {"lease": LEASE_MS},
                "tls": {
                    "root_ca_certificate": f"{{folder}}/{AUTHORITY}.pem",
                    "enable_mtls": True,
                    "listen_certificate": f"{{folder}}/{ROUTER_NAME}.pem",
                    "listen_private_key": f"{{folder}}/{ROUTER_NAME}-key.pem",
                },
            }
        },
        "access_control": access,
    }
    return _text("the router: what each name may do", settings)


def _client(fleet: Fleet, name: str) -> str:
    settings = {
        "mode": "client",
        "connect": {"endpoints": [fleet.connect or inside(fleet.router)], "timeout_ms": 2000},
        "scouting": {"multicast": {"enabled": False}, "gossip": {"enabled": False}},
        "transport": {
            "link": {
                "protocols": ["tls"],
                "tls": {
                    "root_ca_certificate": f"{{folder}}/{AUTHORITY}.pem",
                    "enable_mtls": True,
                    "connect_certificate": f"{{folder}}/{name}.pem",
                    "connect_private_key": f"{{folder}}/{name}-key.pem",
                    "verify_name_on_connect": True,
                },
            }
        },
    }
    return _text(f"{name}, on the machine where it runs", settings)


def _rule(name: str, flows: list[str], messages: list[str], keys: list[str]) -> dict[str, Any]:
    return {"id": name, "permission": "allow", "flows": flows, "messages": messages, "key_exprs": keys}


def _text(what: str, settings: dict[str, Any]) -> str:
    return f"// Zenoh, for {what}. Made by `unitylink fleet security`.\n{json.dumps(settings, indent=2)}\n"


def _script(host: str, names: list[str]) -> str:
    lines = [
        "#!/bin/sh",
        "# Made by `unitylink fleet security`. Makes a certificate for each name that has none yet.",
        "# Keep authority-key.pem to yourself. A machine needs authority.pem and the files of its name.",
        "set -eu",
        'cd "$(dirname "$0")"',
        "umask 077",
        'key() { openssl ecparam -name prime256v1 -genkey -noout -out "$1-key.pem"; }',
        "if [ ! -e authority.pem ]; then",
        "  [ -e authority-key.pem ] || key authority",
        f"  openssl req -x509 -new -key authority-key.pem -days {10 * DAYS} -subj /CN=authority \\",
        "    -out authority.pem",
        "fi",
        "make() {",
        '  [ ! -e "$1.pem" ] || return 0',
        '  key "$1"',
        '  openssl req -new -key "$1-key.pem" -subj "/CN=$1" -out "$1.csr"',
        '  printf "subjectAltName=%s\\n" "$2" > "$1.ext"',
        '  openssl x509 -req -in "$1.csr" -CA authority.pem -CAkey authority-key.pem -CAcreateserial \\',
        f'    -days {DAYS} -extfile "$1.ext" -out "$1.pem"',
        '  rm "$1.csr" "$1.ext"',
        "}",
    ]
    for name in names:
        lines.append(
            f"make {shlex.quote(name)} {host if name == ROUTER_NAME else shlex.quote('DNS:' + name)}"
        )
    return "\n".join(lines) + "\n"
