# SPDX-License-Identifier: BSD-3-Clause
"""Generated headers of C and C++ compile without a warning."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
from unit.generate.test_objects import AWKWARD, ROOT, SPECS, header, spec_of

from unitylink.generate.objects.names import usable
from unitylink.spec import load

WARNINGS = ["-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Wconversion", "-Werror", "-fsyntax-only"]
COMPILERS = {"cpp": ["c++", "-std=c++20"], "c": ["cc", "-std=c11"]}


def compiled(folder: Path, language: str, headers: dict[str, str]) -> None:
    """Compile headers with a use of each robot, and let no warning pass."""
    lines = []
    for name, text in headers.items():
        (folder / name).write_text(text, encoding="utf-8")
        lines.append(f'#include "{name}"\n')
        if language == "cpp":
            space = re.findall(r"^namespace (\w+) \{", text, re.M)[0]
            for robot in re.findall(r"^class (\w+) : public unitylink::Robot<", text, re.M):
                lines.append(
                    f"void use(const unitylink::Link& link, {space}::{robot}*) {{ "
                    f"{space}::{robot} made(link); auto other = {space}::{robot}::on(link); }}\n"
                )
    source = folder / f"all.{language}"
    source.write_text("".join(lines) + "int main(void) { return 0; }\n", encoding="utf-8")
    places = [f"-I{folder}", f"-I{ROOT / 'native' / 'include'}"]
    subprocess.run([*COMPILERS[language], *WARNINGS, *places, source], check=True)


@pytest.mark.parametrize("language", COMPILERS)
def test_the_headers_of_all_specs_compile(language: str, tmp_path: Path) -> None:
    headers = dict(header(load(path), language) for path in SPECS)
    headers |= [header(spec_of(AWKWARD), language)]
    assert len(headers) == len(SPECS) + 1, "each has a file of its own"
    compiled(tmp_path, language, headers)


def test_no_macro_of_the_headers_is_a_name() -> None:
    found = set()
    for language, (compiler, _) in COMPILERS.items():
        standard = "gnu++20" if language == "cpp" else "gnu11"  # these have the most macros
        name = "stream.hpp" if language == "cpp" else "part.h"
        command = [compiler, f"-std={standard}", f"-I{ROOT / 'native' / 'include'}", "-dM", "-E", "-x"]
        command += ["c++" if language == "cpp" else "c", "-"]
        source = f"#include <unitylink/{name}>\n#include <time.h>\n"
        done = subprocess.run(command, input=source, check=True, capture_output=True, text=True)
        found |= {line.split()[1].split("(")[0] for line in done.stdout.splitlines()}
    assert "INT8_MAX" in found and "errno" in found
    assert [name for name in sorted(found) if usable(name)] == []
