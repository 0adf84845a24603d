#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Writes tools/locks/: for each dependency group of pyproject.toml, which versions are installed, each with its hashes.
# Run it after a change of a group, or to take newer versions; then `make test`.
set -euo pipefail
cd "$(dirname "$0")/.."
locks=tools/locks uv=build/lock/bin/uv
[ -x "$uv" ] || { python3 -m venv build/lock && build/lock/bin/pip --quiet --quiet install uv==0.13.9; }
every=build/lock/every.txt                # one version of each package for all groups, which share an environment
compile() {
  "$uv" pip compile --quiet --universal --python-version 3.10 --generate-hashes --no-annotate --no-header "$@"
}

groups=(demo boards docs wheel packages browser test)
compile pyproject.toml --extra all --group build $(printf -- '--group %s ' "${groups[@]}") --upgrade -o "$every"
compile pyproject.toml --group build -c "$every" -o "$locks/build.txt"        # with what the library itself wants
for extra in all ros2; do compile pyproject.toml --extra "$extra" -c "$every" -o "$locks/$extra.txt"; done
for group in "${groups[@]}"; do compile --group "pyproject.toml:$group" -c "$every" -o "$locks/$group.txt"; done
compile --group pyproject.toml:jazzy --upgrade -o "$locks/jazzy.txt"          # in an environment of its own
