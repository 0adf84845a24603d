#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# What can be said without running the code: lint, types, C++ warnings as errors, the import rule, stale generated files.
set -euo pipefail
cd "$(dirname "$0")/.."
bin=.venv/bin
say() { printf '\n== %s\n' "$1"; }
say "ruff"                                # a line each: `a && b` would let a failing `a` pass
"$bin/ruff" check .
"$bin/ruff" format --check .
say "mypy --strict"
"$bin/mypy"
say "generated files"
"$bin/python" protocol/generate.py --check
say "house rules (imports go down the layers only, licence lines, folder pages)"
"$bin/python" -m pytest tests/unit/house -q
say "C++ with warnings as errors"
tools/setup.sh system
tools/setup.sh native
echo "no warnings"
