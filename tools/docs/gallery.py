# SPDX-License-Identifier: BSD-3-Clause
"""Make the gallery of the components:  python tools/docs/gallery.py [--check] [--record]

Each folder of components/ gives a picture and a section of docs/components.md. The picture has the pins of
the `.ul`, and the scenes of `picture.toml` as the model of the component plays them. `--record` plays
components without a model in GHDL first. The same folders give the same bytes, and --check compares.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path
from textwrap import dedent

from component_picture import component_picture
from made_files import parser_of, write_or_compare
from made_part import with_part
from page_format import formatted
from scene import scenes

ROOT = Path(__file__).resolve().parents[2]
COMPONENTS = ROOT / "components"
PAGE = ROOT / "docs" / "components.md"


def component_folders() -> list[Path]:
    """Return the folders of the library, in the order of their names."""
    return sorted(one.parent for one in COMPONENTS.glob("*/example.ul"))


def section(folder: Path) -> str:
    """Return what the gallery says about a component: its first sentence, its line, its picture."""
    name = folder.name
    page = (folder / "README.md").read_text("utf-8")
    about = re.match(rf"# {name}\n\n(.*?)\n\n", page, re.S)
    line = re.search(rf"^ *\w.*: {name}\([^;]*\);$", (folder / "example.ul").read_text("utf-8"), re.M)
    if about is None or line is None:
        raise SystemExit(
            f"{folder}: README.md begins with no sentence, or example.ul has no line with {name}"
        )
    shown = (
        f"[![Pins and signals of {name}](../components/{name}/{name}.svg)](../components/{name}/README.md)"
    )
    return (
        f"### [{name}](../components/{name}/README.md)\n\n{about[1]}\n\n"
        f"```ul\n{dedent(line[0])}\n```\n\n{shown}\n\n"
    )


def made() -> dict[Path, str]:
    """Return every file that this tool makes."""
    files = {}
    for folder in component_folders():
        played = [one.play() for one in scenes(folder)]
        files[folder / f"{folder.name}.svg"] = component_picture(folder, played)
    part = "".join(section(folder) for folder in component_folders())
    files[PAGE] = formatted(with_part(PAGE.read_text("utf-8"), "gallery.py", f"\n{part}"))
    return files


def main() -> int:
    """Write the files, or compare them."""
    parser = parser_of("Make the gallery of the components.")
    parser.add_argument("--record", action="store_true", help="play components without a model in GHDL first")
    given = parser.parse_args()
    for scene in (one for folder in component_folders() for one in scenes(folder)):
        if given.record and scene.trace is not None:
            scene.trace.write_text(scene.trace_of_vhdl(), "ascii")
    return write_or_compare(made(), check=given.check)


if __name__ == "__main__":
    sys.exit(main())
