# SPDX-License-Identifier: BSD-3-Clause
"""The files that a tool makes: written, or compared with --check."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def parser_of(description: str) -> argparse.ArgumentParser:
    """Return a parser with the option that all these tools have."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument(
        "--check", action="store_true", help="exit code 1 where a file differs; nothing is written"
    )
    return parser


def write_or_compare(files: Mapping[Path, str], *, check: bool) -> int:
    """Write the files whose text differs and print their names. With `check`, write nothing.

    Return the exit code.
    """
    stale = [path for path, text in files.items() if not path.is_file() or path.read_text("utf-8") != text]
    if not check:
        for path in stale:
            path.write_text(files[path], "utf-8")
    names = ", ".join(str(path.relative_to(ROOT)) for path in stale)
    print(f"{'these differ, `make docs` makes them' if check else 'made'}: {names or 'none'}")
    return int(check and bool(stale))
