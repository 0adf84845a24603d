# SPDX-License-Identifier: BSD-3-Clause
"""Imports go down the layers only; the table here is the one of docs/architecture.md."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
PACKAGE = ROOT / "src" / "unitylink"

SHARED = {"errors", "protocol", "settings"}
MAY_IMPORT: dict[str, set[str]] = {
    "errors": set(),
    "protocol": set(),
    "settings": set(),
    "_native": set(),
    "program": {"errors"},
    "optional": {"errors"},
    "output_file": {"errors"},
    "lazy": set(),
    "spec": SHARED,
    "values": {"spec", "errors"},
    "interface": {"values", "spec", *SHARED},
    # Generated code derives from layer 4's Node: the generator must know its names and its binding version.
    "generate": {
        "interface",
        "resources",
        "ros",
        "spec",
        "values",
        "layer4_data",
        *SHARED,
    },
    "layer0_driver": {"_native", *SHARED},
    "layer1_stream": {"layer0_driver", "_native", *SHARED},
    "layer2_message": {"layer1_stream", "_native", *SHARED},
    "layer3_hardware": {"layer2_message", *SHARED},
    # Trees are built from a Spec as well as by generated classes, so layer 4 knows the model.
    "layer4_data": {"interface", "lazy", "layer3_hardware", "layer2_message", "spec", "values", *SHARED},
    # The RTL board compiles what the VHDL generator makes; a recording is played as a plant.
    "simulate": {
        "interface",
        "generate",
        "gateware",
        "recording",
        "resources",
        "spec",
        "values",
        "_native",
        *SHARED,
    },
    # A node is built on layer 4; who starts it hands it what opens links.
    "ros": {"optional", "program", "layer4_data", "layer2_message", "spec", "values", *SHARED},
    "resources": SHARED,
    "recording": {"optional", "output_file", *SHARED},
    # The doctor tries what a link would do, below it and through it.
    "ports": {"interface", "layer2_message", "layer1_stream", "layer0_driver", "spec", *SHARED},
    "gateware": {"resources", *SHARED},
    # A bitstream is made of generated VHDL; its report has the budget of the spec.
    "boards": {"interface", "generate", "gateware", "resources", "spec", *SHARED},
    # Captures are read with the codec of layer 1, above no link.
    "capture": {"layer1_stream", "output_file", *SHARED},
    # The table of link URLs; what makes a virtual board is imported when one is asked for.
    "connection": {"lazy", "simulate", "layer0_driver", "layer2_message", *SHARED},
}
UNRESTRICTED = {"commands", "cli", "testing", "__main__", "__init__"}


def unit_of(path: Path) -> str:
    return path.relative_to(PACKAGE).parts[0].removesuffix(".py").removesuffix(".pyi")


def imported_units(path: Path) -> Iterator[tuple[int, str]]:
    """Yield (line, unit) for everything of ours that a file imports, at any nesting."""
    package = ("unitylink", *path.relative_to(PACKAGE).parent.parts)
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names = [tuple(alias.name.split(".")) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            start = package[: len(package) - node.level + 1] if node.level else ()
            module = (*start, *(node.module.split(".") if node.module else ()))
            names = [(*module, alias.name) for alias in node.names] if len(module) == 1 else [module]
        else:
            continue
        for name in names:
            if name[0] == "unitylink" and len(name) > 1:
                yield node.lineno, name[1]


def test_every_unit_has_a_rule() -> None:
    units = {unit_of(path) for path in PACKAGE.rglob("*.py*") if path.suffix in (".py", ".pyi")}
    assert units <= set(MAY_IMPORT) | UNRESTRICTED, (
        "add the new unit to docs/architecture.md and to this table"
    )


@pytest.mark.parametrize("path", sorted(PACKAGE.rglob("*.py")), ids=lambda p: str(p.relative_to(PACKAGE)))
def test_imports_go_down(path: Path) -> None:
    unit = unit_of(path)
    if unit in UNRESTRICTED:
        return
    allowed = MAY_IMPORT[unit] | {unit}
    known = set(MAY_IMPORT) | UNRESTRICTED
    edges = [
        f"{path.relative_to(ROOT)}:{line}: {unit} -> {target}"
        for line, target in imported_units(path)
        if target in known and target not in allowed
    ]
    assert not edges, "these imports go up or sideways:\n" + "\n".join(edges)


LAYERS = ("layer0_driver", "layer1_stream", "layer2_message")
NATIVE_MAY_INCLUDE = {
    "layer0_driver": {"layer0_driver"},
    "layer1_stream": {"layer1_stream"},
    "layer2_message": set(LAYERS),
    "abi": {"abi", *LAYERS},
    "mapped_memory": {"mapped_memory", "layer0_driver"},
    "device": {"device", "layer1_stream", "layer0_driver"},
    "faults": {"faults", "device", *LAYERS},
}


def test_native_includes_go_down() -> None:
    source = ROOT / "native" / "src"
    edges = []
    for path in sorted([*source.rglob("*.hpp"), *source.rglob("*.cpp")]):
        unit = path.relative_to(source).parts[0]
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            if line.startswith('#include "'):
                target = line.split('"')[1].split("/")[0]
                if target in NATIVE_MAY_INCLUDE and target not in NATIVE_MAY_INCLUDE[unit]:
                    edges.append(f"{path.relative_to(ROOT)}:{number}: {unit} -> {target}")
    assert not edges, "these includes go up or sideways:\n" + "\n".join(edges)
