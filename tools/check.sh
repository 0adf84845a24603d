#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# What can be said without running the code: lint, format, types, stale generated files, the import rule
# (`check.sh sources`), C++ warnings as errors (`check.sh native`); without a word all of it.
set -euo pipefail
cd "$(dirname "$0")/.."
bin=.venv/bin
say() { printf '\n== %s\n' "$1"; }
part=${1:-all}
case "$part" in all | sources | native) ;; *) echo "usage: check.sh [sources|native]" >&2; exit 2 ;; esac
if [ "$part" != native ]; then            # a line each: `a && b` would let a failing `a` pass
  say "ruff"
  "$bin/ruff" check .
  say "format of Python, C++ and pages (make format)"
  tools/format.sh --check
  say "mypy --strict"
  "$bin/mypy"
  say "generated files"
  "$bin/python" protocol/generate.py --check
  "$bin/python" tools/rust_sys.py --check
  say "house rules (imports go down the layers only, licence lines, folder pages)"
  "$bin/python" -m pytest tests/unit/house -q
fi
if [ "$part" != sources ]; then
  say "C++ with warnings as errors"
  tools/setup.sh native
  echo "no warnings"
fi
