#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The whole proof. A part that cannot run is a failure, not a skip. What does not need the other runs beside it, for
# much of it leaves a processor idle: a download, a robot that moves in real time, a program of one thread.
# `test.sh FOLDER...`: of the Python tests these only.
set -euo pipefail
cd "$(dirname "$0")/.."
bin=.venv/bin
logs=build/test tests=("${@:-tests}")
export UNITYLINK_WERROR=1                 # the library is built as the checks want it, and once
# To pip this means: compile nothing. What is imported is compiled then, a small part of what is installed.
export PIP_NO_COMPILE=0
say() { printf '\n=== %s\n' "$1"; }
started=$SECONDS

set -m                                    # each in a process group of its own, which can be ended as a whole
running=()
beside() {                                # beside NAME...: run these functions at once; `join` shows their logs
  say "$* (beside each other)"
  for part in "$@"; do
    (
      began=$SECONDS
      "$part"
      printf '%s took %d s\n' "$part" $((SECONDS - began))
    ) < /dev/null > "$logs/$part.log" 2>&1 &
    running+=("$part:$!")
  done
}
join() {
  local failed=() part
  for part in "${running[@]}"; do
    if ! wait "${part#*:}"; then failed+=("${part%:*}"); fi
    say "${part%:*}"
    cat "$logs/${part%:*}.log"
  done
  running=()
  [ ${#failed[@]} = 0 ] || { printf '\nfailed: %s\n' "${failed[*]}" >&2; exit 1; }
}
trap 'for part in "${running[@]}"; do kill -- "-${part#*:}" 2>/dev/null || true; done' EXIT

system() { tools/setup.sh system; }
library() { make --no-print-directory build; }
sources() {
  tools/setup.sh group test
  tools/check.sh sources
  # Once, so that the workers find the tests compiled. Else each of them would compile all of them.
  "$bin/python" -m pytest "${tests[@]}" -q --collect-only > /dev/null
}
packages() {
  for name in demo wheel docs boards browser; do tools/setup.sh group "$name"; done
  "$bin/python" examples/scara/run.py --picture build/scara.png
  [ -s build/scara.png ]
  tools/setup.sh page
}
ros2() { tools/setup.sh ros2; }
native() {
  tools/check.sh native
  build/native/unitylink_tests
  local fuzzer fuzzers=()
  for fuzzer in build/native/fuzz_*; do
    "$fuzzer" --seconds 4 --seed 1 &
    fuzzers+=($!)
  done
  for fuzzer in "${fuzzers[@]}"; do wait "$fuzzer"; done
  echo "faults of the wire, and mistakes that must show there"
  "$bin/unitylink" faults --messages 2000000 --jobs 2 | tail -n 1
  "$bin/unitylink" faults --messages 200000 --jobs 2 --protocol classic | tail -n 1
  "$bin/python" tools/mutants.py --sample 1
}

mkdir -p "$logs"
beside system library
join
beside sources native packages ros2
join
say "tests"
# `sources` has the tests of the house.
code=0
"$bin/python" -m pytest "${tests[@]}" --ignore tests/unit/house -q -n 3 --dist loadgroup --cache-clear || code=$?
[ "$code" -le 1 ] || exit "$code"         # 1: tests failed. More: pytest could not run them all
if [ "$code" = 1 ]; then
  # A browser, or a board in real time, may have stood still for seconds on a busy machine. So a few failures
  # are named here, and must pass alone.
  mapfile -t again < <("$bin/python" - <<'PYTHON'
import json, pathlib, re
for name in json.loads(pathlib.Path(".pytest_cache/v/cache/lastfailed").read_text("utf-8")):
    print(re.sub(r"@[^\]]*$", "", name))  # the group, which pytest-xdist adds
PYTHON
  )
  [ ${#again[@]} -gt 0 ] && [ ${#again[@]} -le 5 ] || exit 1
  say "tests that failed beside others, again and alone"
  printf '%s\n' "${again[@]}"
  "$bin/python" -m pytest "${again[@]}" -q
fi
printf '\nall passed in %d s\n' $((SECONDS - started))
