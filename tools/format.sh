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
each() { xargs -0 -r -n 40 -P "$(nproc)" "$@"; }
# All kinds, also where one has faults. A part of a pipe runs in a shell of its own, so `failed` is set behind the pipe.
"$bin/ruff" "${ruff[@]}" . || failed=1
files '*.c' '*.h' '*.cpp' '*.hpp' |       # but those of .clang-format-ignore
  each "$bin/clang-format" "${clang[@]}" || failed=1
files ':(attr:!linguist-generated)*.md' | # but those of .gitattributes
  each "$bin/mdformat" "${mdformat[@]}" || failed=1
exit "$failed"
