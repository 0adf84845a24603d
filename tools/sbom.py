# SPDX-License-Identifier: BSD-3-Clause
"""Write the bill of materials in CycloneDX 1.6 (JSON): what the library is made with, and what it needs.

    python tools/sbom.py > build/sbom.cdx.json
    python tools/sbom.py unitylink-0.1.0-cp311-cp311-linux_x86_64.whl    (puts it into the wheel)

Packages from PyPI are read from tools/locks, with the versions and hashes that are installed. Packages from
npm are read from web/package-lock.json. They make the dashboard's page, or are a part of it. Packages from
Debian are read from tools/setup.sh, without a version, because the machine decides that. `scope` says who
needs a package. "required": the library when it runs. "optional": a command that needs an extra or a driver.
"excluded": only somebody who builds or tests. The same checkout gives the same file. Its time is that of the
last commit (SOURCE_DATE_EPOCH).
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import uuid
from base64 import b64decode
from collections.abc import Iterator
from contextlib import suppress
from datetime import datetime, timezone
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from typing import Any

from packaging.requirements import Requirement

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).resolve().parents[1]
COMPILED_IN = ("nanobind",)  # sources of these become part of the native module
RUN_TIME = {
    "all": "optional",
    "ros2": "optional",
}  # locks of extras; "build" holds the library's own dependencies
DYNAMIC = {
    "libusb-1.0-0": "ftdi: links, loaded when one is opened",
    "libssl3": "TLS of a server and of serve:// links, loaded when it is asked for",
}
_NAME = re.compile(r"[A-Za-z0-9._-]+")
_NEED = re.compile(r'^\s*need (?:"[^"]*"|\S+) (\S+) ', re.MULTILINE)
_ORDER = ("required", "optional", "excluded")


def locked(name: str) -> Iterator[tuple[str, str, list[str]]]:
    """Yield (package, version, SHA-256 of each of its files) of a lock."""
    text = (ROOT / "tools" / "locks" / f"{name}.txt").read_text(encoding="utf-8")
    for entry in re.split(r"\n(?=\S)", text.strip()):
        package, version = re.match(r"([^=\s;]+)==([^\s;\\]+)", entry).groups()  # type: ignore[union-attr]
        yield normal(package), version, re.findall(r"--hash=sha256:([0-9a-f]{64})", entry)


def normal(package: str) -> str:
    """Return a package's name in the form that PyPI uses.

    >>> normal("Typing_Extensions[x]>=4")
    'typing-extensions'
    """
    return re.sub(r"[-_.]+", "-", _NAME.match(package)[0]).lower()  # type: ignore[index]


def needed_by(asked: list[str]) -> set[str]:
    """Return the packages of these requirements, with everything that they need, as installed here."""
    found: set[str] = set()
    waiting = [(Requirement(one), True) for one in asked]
    while waiting:
        one, own = waiting.pop()
        name = normal(one.name)
        if name in found or not (own or one.marker is None or one.marker.evaluate({"extra": ""})):
            continue  # our own requirements count even if only another version of Python needs them
        found.add(name)
        with suppress(PackageNotFoundError):
            waiting += [(Requirement(more), False) for more in distribution(name).requires or ()]
    return found


def bill() -> dict[str, Any]:
    """Return the whole bill of materials."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    own = needed_by(project["dependencies"])
    root = f"pkg:pypi/{project['name']}@{project['version']}"
    components = [*_from_pypi(own), *_from_npm(), *_from_debian()]
    body = {
        "components": components,
        "dependencies": [
            {"ref": root, "dependsOn": [one["bom-ref"] for one in components if one["scope"] == "required"]}
        ],
    }
    main = {
        "type": "library",
        "bom-ref": root,
        "name": project["name"],
        "version": project["version"],
        "purl": root,
        "licenses": [{"license": {"id": project["license"]}}],
        "supplier": {"name": project["authors"][0]["name"]},
    }
    return {
        "$schema": "http://cyclonedx.org/schema/bom-1.6.schema.json",
        "bomFormat": "CycloneDX",
        "specVersion": "1.6",
        "serialNumber": f"urn:uuid:{uuid.uuid5(uuid.NAMESPACE_URL, root + json.dumps(body))}",
        "version": 1,
        "metadata": {
            "timestamp": _time(),
            "authors": [{"name": project["authors"][0]["name"]}],
            "component": main,
        },
        **body,
    }


def _from_pypi(own: set[str]) -> Iterator[dict[str, Any]]:
    found: dict[tuple[str, str], dict[str, Any]] = {}
    for path in sorted((ROOT / "tools" / "locks").glob("*.txt")):
        for package, version, hashes in locked(path.stem):
            scope = RUN_TIME.get(path.stem, "excluded")
            if package in own or package in COMPILED_IN:
                scope = "required"
            one = found.setdefault((package, version), {"scope": scope, "hashes": set(), "locks": []})
            one["scope"] = min(one["scope"], scope, key=_ORDER.index)
            one["hashes"].update(hashes)
            one["locks"].append(path.stem)
    for (package, version), one in sorted(found.items()):
        purl = f"pkg:pypi/{package}@{version}"
        yield {
            "type": "library",
            "bom-ref": purl,
            "name": package,
            "version": version,
            "purl": purl,
            "scope": one["scope"],
            "externalReferences": [
                {
                    "type": "distribution",
                    "url": f"https://pypi.org/project/{package}/{version}/",
                    "hashes": [{"alg": "SHA-256", "content": each} for each in sorted(one["hashes"])],
                }
            ],
            "properties": [{"name": "unitylink:lock", "value": name} for name in one["locks"]],
        }


def _from_npm() -> Iterator[dict[str, Any]]:
    """Yield what the dashboard's page consists of, and what it is made with."""
    lock = json.loads((ROOT / "web" / "package-lock.json").read_text(encoding="utf-8"))
    for path, one in sorted(lock["packages"].items()):
        name = path.removeprefix("node_modules/")
        if not name or "integrity" not in one:
            continue
        kind, _, digest = one["integrity"].partition("-")
        purl = f"pkg:npm/{name.replace('@', '%40')}@{one['version']}"
        yield {
            "type": "library",
            "bom-ref": purl,
            "name": name,
            "version": one["version"],
            "purl": purl,
            "scope": "excluded" if one.get("dev") else "optional",
            "hashes": [{"alg": kind.upper().replace("SHA", "SHA-"), "content": b64decode(digest).hex()}],
            "properties": [{"name": "unitylink:lock", "value": "web/package-lock.json"}],
        }


def _from_debian() -> Iterator[dict[str, Any]]:
    packages = dict.fromkeys(_NEED.findall((ROOT / "tools" / "setup.sh").read_text(encoding="utf-8")), "")
    for package, use in sorted({**packages, **DYNAMIC}.items()):
        yield {
            "type": "library" if use else "application",
            "bom-ref": f"pkg:deb/debian/{package}",
            "name": package,
            "purl": f"pkg:deb/debian/{package}",
            "scope": "optional" if use else "excluded",
            "properties": [{"name": "unitylink:use", "value": use or "tools/setup.sh"}],
        }


def _time() -> str:
    epoch = os.environ.get("SOURCE_DATE_EPOCH")
    if epoch is None:
        git = ["git", "-C", str(ROOT), "log", "-1", "--format=%ct"]
        epoch = subprocess.run(git, capture_output=True, text=True, check=False).stdout.strip() or "0"
    return datetime.fromtimestamp(int(epoch), timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")


def of_wheel(whole: dict[str, Any]) -> dict[str, Any]:
    """Return the part of a bill that concerns who installs a wheel: not what only builds and tests it."""
    components = [one for one in whole["components"] if one["scope"] != "excluded"]
    return {**whole, "components": components}


def put_into(wheel: Path) -> None:
    """Put the bill into a wheel, where PEP 770 looks for it."""
    from auditwheel.wheeltools import InWheel

    text = json.dumps(of_wheel(bill()), indent=1) + "\n"
    with InWheel(wheel, wheel) as folder:
        (about,) = Path(folder).glob("*.dist-info")
        (about / "sboms").mkdir(exist_ok=True)
        (about / "sboms" / "unitylink.cdx.json").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        put_into(Path(sys.argv[1]))
    else:
        print(json.dumps(bill(), indent=1))
