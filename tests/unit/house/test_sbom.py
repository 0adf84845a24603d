# SPDX-License-Identifier: BSD-3-Clause
"""The bill of materials names everything that is locked, that setup.sh installs, and that is loaded at run
time.
"""

from __future__ import annotations

import json
import re
import shlex
import sys
from pathlib import Path
from typing import Any

import pytest
from packaging.utils import canonicalize_name
from unit.modules import module_of

sys.path.insert(0, str(Path(__file__).parent))

from test_locks import ASKED, LOCKS, PROJECT, ROOT, entries


@pytest.fixture(scope="module")
def bill() -> dict[str, Any]:
    module = module_of(ROOT / "tools" / "sbom.py")
    made: dict[str, Any] = module.bill()
    assert json.dumps(module.bill()) == json.dumps(made), "the same checkout has the same bill"
    return made


def by_purl(bill: dict[str, Any]) -> dict[str, dict[str, Any]]:
    found = {one["purl"]: one for one in bill["components"]}
    assert len(found) == len(bill["components"]) == len({one["bom-ref"] for one in bill["components"]})
    return found


@pytest.mark.parametrize("name", ASKED)
def test_it_has_all_locked_packages_with_their_hashes(name: str, bill: dict[str, Any]) -> None:
    found = by_purl(bill)
    text = (LOCKS / f"{name}.txt").read_text(encoding="utf-8")
    for (pinned, _), entry in zip(entries(name), re.split(r"\n(?=\S)", text.strip()), strict=True):
        (only,) = pinned.specifier
        one = found[f"pkg:pypi/{canonicalize_name(pinned.name)}@{only.version}"]
        (reference,) = one["externalReferences"]
        hashes = {each["content"] for each in reference["hashes"]}
        assert set(re.findall(r"sha256:(\w+)", entry)) <= hashes
        assert {"name": "unitylink:lock", "value": name} in one["properties"]


def test_it_says_who_needs_what(bill: dict[str, Any]) -> None:
    scopes: dict[str, set[str]] = {}
    for one in bill["components"]:
        scopes.setdefault(one["name"], set()).add(one["scope"])
    for asked in ("click", "rich", "numpy", "jinja2", "markupsafe", "pygments", "nanobind"):
        assert scopes[asked] == {"required"}, asked
    for extra in ("matplotlib", "mcap", "prompt-toolkit", "libusb-1.0-0"):
        assert scopes[extra] == {"optional"}, extra
    for tool in ("cmake", "ruff", "pandas", "yosys", "tshark"):
        assert scopes[tool] == {"excluded"}, tool
    (root,) = bill["dependencies"]
    assert set(root["dependsOn"]) == {one["purl"] for one in bill["components"] if one["scope"] == "required"}


def test_it_has_everything_that_setup_installs_or_a_program_loads(bill: dict[str, Any]) -> None:
    found = by_purl(bill)
    lines = (ROOT / "tools" / "setup.sh").read_text(encoding="utf-8").splitlines()
    needs = [shlex.split(line, comments=True) for line in lines if re.match(r"\s*need ", line)]
    assert len(needs) > 10 and all(f"pkg:deb/debian/{words[2]}" in found for words in needs)
    loaded = {
        name
        for path in Path(ROOT / "native" / "src").rglob("*.cpp")
        for name in re.findall(r"apt-get install (lib[\w.-]+)", path.read_text(encoding="utf-8"))
    }
    assert loaded and all(f"pkg:deb/debian/{name}" in found for name in loaded)


def test_it_has_what_the_page_of_the_dashboard_consists_of(bill: dict[str, Any]) -> None:
    found = {one["name"]: one for one in bill["components"] if one["purl"].startswith("pkg:npm/")}
    asked = json.loads((ROOT / "web" / "package.json").read_text(encoding="utf-8"))
    for name, version in {**asked["dependencies"], **asked["devDependencies"]}.items():
        assert found[name]["version"] == version and found[name]["hashes"][0]["alg"] == "SHA-512"
        assert found[name]["scope"] == ("optional" if name in asked["dependencies"] else "excluded")
        assert len(found[name]["hashes"][0]["content"]) == 128
    licences = (ROOT / "src" / "unitylink" / "dashboard" / "page" / "licences.txt").read_text("utf-8")
    shipped = [one for one in found.values() if one["scope"] == "optional"]
    assert shipped and all(f"{one['name']} {one['version']}" in licences for one in shipped)


def test_it_has_what_such_a_bill_must_have(bill: dict[str, Any]) -> None:
    assert (bill["bomFormat"], bill["specVersion"], bill["version"]) == ("CycloneDX", "1.6", 1)
    assert re.fullmatch(r"urn:uuid:[0-9a-f]{8}-([0-9a-f]{4}-){3}[0-9a-f]{12}", bill["serialNumber"])
    assert re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ", bill["metadata"]["timestamp"])
    main = bill["metadata"]["component"]
    assert (main["name"], main["version"]) == (PROJECT["project"]["name"], PROJECT["project"]["version"])
    assert main["licenses"] == [{"license": {"id": "BSD-3-Clause"}}]
