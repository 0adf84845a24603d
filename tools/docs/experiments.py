# SPDX-License-Identifier: BSD-3-Clause
"""Write docs/experiments.md and its figures from docs/experiments.json, and a part of docs/faults.md.

    python tools/docs/experiments.py [--check] [--from RESULTS]

RESULTS is the results.json of a run of `unitylink experiments`. It becomes docs/experiments.json. The same
results give the same bytes, and --check compares. The output of `unitylink faults --beside litex --json`
becomes docs/faults-beside-litex.json. That part of docs/faults.md is made from it.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

from made_files import parser_of, write_or_compare
from made_part import with_part
from page_format import formatted

from unitylink_lab.experiments import markdown, pictures, report
from unitylink_lab.experiments.peer_faults import section

DOCS = Path(__file__).resolve().parents[2] / "docs"
RESULTS = DOCS / "experiments.json"


def files() -> dict[Path, str]:
    """Return the files that follow from the committed results."""
    results = json.loads(RESULTS.read_text(encoding="utf-8"))
    page = formatted(markdown(report(results), images="images/"))
    return {
        DOCS / "experiments.md": page,
        DOCS / "faults.md": faults_page(),
        **{DOCS / "images" / name: text for name, text in pictures(results).items()},
    }


def faults_page() -> str:
    """Return docs/faults.md with its generated part made again."""
    results = json.loads((DOCS / "faults-beside-litex.json").read_text(encoding="utf-8"))
    page = (DOCS / "faults.md").read_text(encoding="utf-8")
    return formatted(with_part(page, "experiments.py", markdown(section(results))))


def main() -> int:
    """Write the files, or compare them."""
    parser = parser_of("Write docs/experiments.md from the committed results.")
    parser.add_argument("--from", dest="source", type=Path, help="results.json of a new run")
    options = parser.parse_args()
    if options.source:
        RESULTS.write_text(options.source.read_text(encoding="utf-8"), encoding="utf-8")
    return write_or_compare(files(), check=options.check)


if __name__ == "__main__":
    sys.exit(main())
