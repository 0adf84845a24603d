# SPDX-License-Identifier: BSD-3-Clause
"""Cargo, which builds programs of generated crates without a network."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

from .figure import BenchError
from .programs import made


def cargo_build(folder: Path, library: Path, *options: str, flags: str = "") -> Path:
    """Build the package in `folder`, and return the folder of its programs.

    They are linked with the library in the folder `library`, and find it there.
    """
    tools = _tools()
    target = folder / "target"
    settings = {
        "RUSTC": tools["rustc"],
        "UNITYLINK_LIB_DIR": str(library),
        "RUSTFLAGS": f"{flags} -C link-arg=-Wl,-rpath,{library}".strip(),
        "CARGO_TARGET_DIR": str(target),
        "CARGO_INCREMENTAL": "0",
    }
    manifest = folder / "Cargo.toml"
    build = ("build", "--offline", "--quiet", "--manifest-path", str(manifest))
    made([tools["cargo"], *build, *options], os.environ | settings)
    return target / ("release" if "--release" in options else "debug")


def _tools() -> dict[str, str]:
    """Return cargo and rustc. Those of rustup do not run without its folder in the home, and Debian's do."""
    for path in (None, "/usr/bin"):
        found = {name: shutil.which(name, path=path) for name in ("cargo", "rustc")}
        works = [
            tool and not subprocess.run([tool, "--version"], capture_output=True, check=False).returncode
            for tool in found.values()
        ]
        if all(works):
            return {name: str(tool) for name, tool in found.items()}
    raise BenchError("cargo and rustc are missing: install the Debian packages cargo and rustc")
