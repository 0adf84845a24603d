#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Brings a fresh machine to where `make` can go on. Says by name what is absent and stops.
#   setup.sh build          virtual environment, build tools, the library with its native core
#   setup.sh group NAME     the packages of a dependency group of pyproject.toml
#   setup.sh system         Debian packages that only the tests need
#   setup.sh native         the native tests, fuzzers and benches
set -euo pipefail
cd "$(dirname "$0")/.."
python=${PYTHON:-python3}
venv=.venv
mkdir -p build
exec 9>build/.lock
flock 9                                   # two makes at once must not build into each other

stop() { printf 'unitylink: %s\n' "$1" >&2; exit 1; }

need() {                                  # need COMMAND PACKAGE
  command -v "$1" >/dev/null || stop "'$1' is not installed; on Debian or Ubuntu: apt-get install $2"
}

pip() { "$venv/bin/python" -m pip --quiet --quiet --disable-pip-version-check "$@"; }

group() {                                 # the stamp makes the second run free
  local stamp="$venv/.group-$1"
  [ "$stamp" -nt pyproject.toml ] && return
  "$venv/bin/python" - "$1" > "build/group-$1.txt" <<'PY'
import pathlib, re, sys
# tomllib comes with Python 3.11; the one table that is read here is simple enough for its absence not to matter.
text = pathlib.Path("pyproject.toml").read_text()
line = re.search(rf"^{sys.argv[1]} = \[(.*)\]$", text, re.M).group(1)
print("\n".join(re.findall(r'"([^"]+)"', line)))
PY
  pip install -r "build/group-$1.txt" || stop "could not install the '$1' packages (see above); is a package index reachable?"
  touch "$stamp"
}

case "${1:?usage: setup.sh build|group|system|native}" in
build)
  need "$python" python3
  need git git
  command -v c++ >/dev/null || command -v g++ >/dev/null || stop "no C++ compiler; on Debian or Ubuntu: apt-get install g++"
  "$python" -c 'import sys; sys.exit(sys.version_info < (3, 10))' || stop "Python 3.10 or newer is needed, $("$python" --version) found"
  "$python" -c 'import ensurepip, venv' 2>/dev/null || stop "Python has no venv; on Debian or Ubuntu: apt-get install python3-venv"
  "$python" -c 'import os, sys, sysconfig; sys.exit(not os.path.exists(os.path.join(sysconfig.get_path("include"), "Python.h")))' \
    || stop "the Python headers are missing; on Debian or Ubuntu: apt-get install python3-dev"
  echo 'int main() { return [](auto... x) requires(sizeof...(x) == 0) { return 0; }(); }' > build/.probe.cpp
  "${CXX:-c++}" -std=c++20 -o build/.probe build/.probe.cpp 2>/dev/null || stop "the C++ compiler does not know C++20; g++ 10 or clang 12 is needed"
  [ -x "$venv/bin/python" ] || { echo "creating $venv"; "$python" -m venv "$venv"; }
  touch build/.started                     # an edit made during the build must count as newer than it
  group build
  echo "building the native core (about a minute the first time)"
  PATH="$PWD/$venv/bin:$PATH" pip install --no-build-isolation --editable . || stop "the native core did not build (see above)"
  touch -r build/.started "$venv/.built"
  ;;
group) group "$2" ;;
system)
  missing=()
  command -v ghdl >/dev/null || missing+=(ghdl)                       # compiles the generated VHDL
  [ -e /usr/include/doctest/doctest.h ] || missing+=(doctest-dev)      # the native tests' framework
  if [ ${#missing[@]} -gt 0 ]; then
    if command -v apt-get >/dev/null && [ "$(id -u)" = 0 ]; then
      echo "installing ${missing[*]}"
      { apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}"; } > build/apt.log 2>&1 \
        || { tail -5 build/apt.log >&2; stop "apt-get could not install ${missing[*]}"; }
    else
      stop "the tests need: sudo apt-get install ${missing[*]}"
    fi
  fi
  ;;
native)
  touch build/.started
  group build
  PATH="$PWD/$venv/bin:$PATH" cmake -S . -B build/native -G Ninja -DUNITYLINK_TESTS=ON -DUNITYLINK_WERROR=ON > build/cmake.log 2>&1 \
    || { cat build/cmake.log >&2; stop "cmake failed"; }
  PATH="$PWD/$venv/bin:$PATH" cmake --build build/native > build/native.log 2>&1 || { tail -60 build/native.log >&2; stop "the native tests did not build"; }
  touch -r build/.started build/native/.built
  ;;
*) stop "unknown step '$1'" ;;
esac
