# SPDX-License-Identifier: BSD-3-Clause
"""The model as JSON: it fits the schema, is complete, and is the same for the same spec."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import jsonschema
import pytest

import unitylink.generate.json
from unitylink.generate import generate
from unitylink.generate.json import model_json
from unitylink.spec import load

ROOT = Path(__file__).resolve().parents[3]
SPECS = [*sorted((ROOT / "examples").glob("*/*.ul")), *sorted(Path(__file__).parent.rglob("*.ul"))]
SCHEMA = json.loads((Path(unitylink.generate.json.__file__).parent / "model.schema.json").read_text("utf-8"))


@pytest.fixture(scope="module")
def validator() -> jsonschema.Draft202012Validator:
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    return jsonschema.Draft202012Validator(SCHEMA)


@pytest.mark.parametrize("path", SPECS, ids=lambda p: p.stem)
def test_every_model_is_as_the_schema_says(path: Path, validator: jsonschema.Draft202012Validator) -> None:
    spec = load(path)
    ((name, text),) = generate(spec, "json").items()
    assert name == f"{spec.name}.json" and generate(spec, "json") == {name: text}
    model = json.loads(text)
    assert [error.message for error in validator.iter_errors(model)] == []
    assert model == json.loads(json.dumps(model_json(spec)))


@pytest.mark.parametrize("path", SPECS, ids=lambda p: p.stem)
def test_nothing_of_the_tree_is_lost(path: Path) -> None:
    spec = load(path)
    found = [
        (root["name"], e["path"], e["address"]) for root in model_json(spec)["roots"] for e in elements(root)
    ]
    assert found == [(root.name, e.path, e.address) for root in spec.roots for e in root.walk()]


def elements(instance: dict[str, Any]) -> list[dict[str, Any]]:
    found = []
    for member in instance["members"]:
        if member["kind"] == "element":
            found.append(member)
        elif member["kind"] == "instance":
            found += elements(member)
    return found


def test_the_schema_describes_every_member() -> None:
    """A new member of the export needs a description in the schema."""
    for name, definition in {"model": SCHEMA, **SCHEMA["$defs"]}.items():
        if definition.get("type") == "object" and "properties" in definition:
            assert definition["additionalProperties"] is False, name
            assert set(definition["required"]) == set(definition["properties"]), name
            assert definition["description"], name


def test_what_the_language_says_of_values_is_there() -> None:
    model = model_json(load(Path(__file__).parent / "rich" / "arm.ul"))
    by_path = {element["path"]: element for element in elements(model["roots"][0])}
    torque = by_path["j[1].torque"]
    said = {key: torque[key] for key in ("unit", "minimum", "maximum", "overflow", "initial", "safe")}
    assert said == {
        "unit": "N m",
        "minimum": -20,
        "maximum": 20,
        "overflow": "saturate",
        "initial": 0,
        "safe": 0,
    }
    assert torque["type"]["text"] == "fixed(8,8)"
    assert (by_path["time"]["words"], by_path["reset"]["access"]) == (2, "PULSE")
    assert by_path["j[0].pos"]["publish"]["group"] == "pose"
    (mode,), (status,) = model["enums"], model["bits"]
    assert mode["values"][2] == {"name": "stop", "value": 3, "documentation": "brakes on"}
    temperature = status["fields"][2]
    assert (temperature["unit"], temperature["scale"], temperature["high"]) == ("degC", 0.5, 11)
    joint = next(m for m in model["roots"][0]["members"] if m["name"] == "j[2]")
    assert (joint["array"], joint["index"]) == ("j", 2)
    assert joint["annotations"] == [{"name": "ros", "values": [], "options": {"type": "JointState"}}]
    assert model["links"][0]["baud_hz"] == 3_000_000
    assert [group["name"] for group in model["devices"][0]["groups"]] == ["pose", "on change"]
