#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Formats Python, C, C++ and the pages. `format.sh --check` writes nothing, names what is not formatted, and then fails.
set -euo pipefail
cd "$(dirname "$0")/.."
bin=.venv/bin
case "${1:-}" in
  "") ruff=(format) clang=(-i) mdformat=() ;;
  --check) ruff=(format --check) clang=(--dry-run -Werror) mdformat=(--check) ;;
  *) echo "usage: format.sh [--check]" >&2; exit 2 ;;
esac
failed=0
files() { git -c safe.directory='*' ls-files -z --cached --others --exclude-standard -- "$@"; }
each() { xargs -0 -r -n 40 -P "$(nproc)" "$@" || failed=1; }                # all kinds, also where one has faults
"$bin/ruff" "${ruff[@]}" . || failed=1
files '*.c' '*.h' '*.cpp' '*.hpp' | each "$bin/clang-format" "${clang[@]}"  # but those of .clang-format-ignore
files ':(attr:!linguist-generated)*.md' | each "$bin/mdformat" "${mdformat[@]}"  # but those of .gitattributes
exit "$failed"
