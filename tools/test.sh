#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The whole proof, in the order in which a failure tells most. A part that cannot run is a failure, not a skip.
set -euo pipefail
cd "$(dirname "$0")/.."
bin=.venv/bin
say() { printf '\n=== %s\n' "$1"; }
started=$SECONDS

say "checks"
tools/check.sh
say "native tests"
build/native/unitylink_tests
say "native fuzz loops, short form"
for fuzzer in build/native/fuzz_*; do
  "$fuzzer" --seconds 3 --seed 1
done
say "faults of the wire, and mistakes that must show there"
"$bin/unitylink" faults --messages 2000000 --jobs 2 | tail -n 1
"$bin/unitylink" faults --messages 200000 --jobs 2 --protocol classic | tail -n 1
"$bin/python" tools/mutants.py --sample 3
say "demo"
tools/setup.sh group demo
"$bin/python" examples/scara/run.py --picture build/scara.png
[ -s build/scara.png ]
say "recorded exchanges of the 2012 gateware"
"$bin/unitylink" conformance tests/conformance/classic-transcripts.json | tail -n 3
"$bin/unitylink" conformance tests/conformance/classic-transcripts.json --rtl | tail -n 3
say "tests"
tools/setup.sh group wheel
tools/setup.sh group docs
tools/setup.sh group boards
rm -rf build/coverage
UNITYLINK_COVERAGE="$PWD/build/coverage" "$bin/python" -m pytest tests -q -n 2 --dist loadgroup
say "line coverage of the gateware"
"$bin/python" tools/coverage.py --report
printf '\nall passed in %d s\n' $((SECONDS - started))
