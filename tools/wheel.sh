#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds the wheel, the sdist and the bill of materials of this checkout into build/wheels (or the folder named), the
# wheel with the oldest manylinux tag its symbols allow. The same commit gives the same bytes.
# A wheel for all machines is built by cibuildwheel in an older Linux: see pyproject.toml.
set -euo pipefail
cd "$(dirname "$0")/.."
bin=$PWD/.venv/bin
out=${1:-build/wheels}
mkdir -p build
exec 9>build/.lock
flock 9                                   # two at once must not build into each other
export PATH="$bin:$PATH" PIP_DISABLE_PIP_VERSION_CHECK=1
if [ -z "${SOURCE_DATE_EPOCH:-}" ]; then  # the time of all files in them; 1980 is the first that a ZIP file can have
  SOURCE_DATE_EPOCH=$(git log -1 --format=%ct 2>/dev/null || echo 315532800)
  export SOURCE_DATE_EPOCH
fi
rm -rf "$out" && mkdir -p "$out/plain"
# Where the library of .venv was built: what is compiled there, with what settings, need not be again.
"$bin/pip" wheel --quiet --no-build-isolation --no-deps --wheel-dir "$out/plain" \
  --config-settings="build-dir=$(cat .venv/.compiled)" .
"$bin/auditwheel" repair --wheel-dir "$out" "$out"/plain/*.whl > build/auditwheel.log 2>&1 \
  || { cat build/auditwheel.log >&2; exit 1; }
rm -r "$out/plain"
"$bin/python" -c 'import scikit_build_core.build as b; import sys; b.build_sdist(sys.argv[1])' "$out" > build/sdist.log
"$bin/python" tools/sbom.py > "$out/sbom.cdx.json"
"$bin/python" tools/sbom.py "$out"/*.whl
ls -l "$out"
