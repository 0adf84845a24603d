#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Formats all hand-written files: Python and C++. `format.sh --check` writes nothing, names what is not formatted, and then fails.
set -euo pipefail
cd "$(dirname "$0")/.."
bin=.venv/bin
case "${1:-}" in
  "") ruff=(format) clang=(-i) ;;
  --check) ruff=(format --check) clang=(--dry-run -Werror) ;;
  *) echo "usage: format.sh [--check]" >&2; exit 2 ;;
esac
files() { git -c safe.directory='*' ls-files -z --cached --others --exclude-standard -- "$@"; }
"$bin/ruff" "${ruff[@]}" .
files '*.c' '*.h' '*.cpp' '*.hpp' | xargs -0 "$bin/clang-format" "${clang[@]}"     # but those of .clang-format-ignore
