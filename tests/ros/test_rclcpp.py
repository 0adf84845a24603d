# SPDX-License-Identifier: BSD-3-Clause
"""The generated C++ node of ROS 2, compiled against stub headers of ours: rclcpp is in no registry here."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

from unitylink.generate import write
from unitylink.ros import plan_interface
from unitylink.ros.plane import SERVICE_FIELDS
from unitylink.ros.standard import Fields, definitions
from unitylink.spec import load

HERE = Path(__file__).parent
ROOT = HERE.parents[1]


def cpp_type(kind: str) -> str:
    found = re.fullmatch(r"(.*)\[(\d*)\]", kind)
    if found:
        inner = cpp_type(found[1])
        return f"std::array<{inner}, {found[2]}>" if found[2] else f"std::vector<{inner}>"
    if "/" in kind:
        return kind.replace("/", "::msg::")
    return {"string": "std::string", "bool": "bool", "float32": "float", "float64": "double"}.get(
        kind, f"std::{kind}_t"
    )


def body(fields: Fields) -> str:
    return " ".join(f"{cpp_type(kind)} {name}{{}};" for name, kind in fields)


def header_of(name: str) -> str:
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "_", name).lower()


def put(folder: Path, where: str, text: str, kinds: list[str]) -> None:
    """Write a header; `where` is package/msg/Name."""
    package, part, name = where.split("/")
    includes = [f"#include <{k.split('/')[0]}/msg/{header_of(k.split('/')[1])}.hpp>" for k in kinds]
    standard = "".join(f"#include <{h}>\n" for h in ("array", "cstdint", "memory", "string", "vector"))
    head = f"#pragma once\n{standard}"
    path = folder / package / part / f"{header_of(name)}.hpp"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(head + "\n".join(includes) + f"\nnamespace {package}::{part} {{\n{text}\n}}\n")


def test_it_compiles(tmp_path: Path) -> None:
    spec = load(HERE / "rig.ul")
    interface = plan_interface(spec)
    write(spec, tmp_path, "ros2")
    for name, fields in definitions(interface).items():
        package, _, message = name.partition("/")
        needs = [kind.partition("[")[0] for _, kind in fields if "/" in kind]
        ptr = f"using ConstSharedPtr = std::shared_ptr<const {message}>;"
        put(tmp_path, f"{package}/msg/{message}", f"struct {message} {{ {body(fields)} {ptr} }};", needs)
    for name, (request, reply) in SERVICE_FIELDS.items():
        package, _, service = (name if "/" in name else f"{interface.package}/{name}").partition("/")
        parts = "".join(
            f"struct {part} {{ using SharedPtr = std::shared_ptr<{part}>; {body(fields)} }}; "
            for part, fields in (("Request", request), ("Response", reply))
        )
        put(tmp_path, f"{package}/srv/{service}", f"struct {service} {{ {parts}}};", [])
    compiler = shutil.which("c++")
    assert compiler, "no C++ compiler: install the Debian package g++"
    source = tmp_path / "ros2" / "rig_unitylink" / "src" / "node.cpp"
    includes = [f"-I{path}" for path in (HERE / "stubs", tmp_path, ROOT / "native" / "include")]
    command = [compiler, "-std=c++17", "-fsyntax-only", "-Wall", "-Wextra", "-Werror", *includes, str(source)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
