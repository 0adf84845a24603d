#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# `make demo-ros`: the SCARA as a ROS 1 node, from its spec, with the tools that come with ROS. Leaves nothing running.
set -euo pipefail
cd "$(dirname "$0")/.."
checkout=$PWD bin=$PWD/.venv/bin work=$PWD/build/ros-demo
running=()
end() { for process in "${running[@]}"; do kill -TERM "$process" 2>/dev/null || true; done; wait 2>/dev/null || true; }
trap end EXIT
free_port() {
  "$bin/python" -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])'
}
bold='' plain=''
if [ -t 1 ]; then bold=$'\033[1m' plain=$'\033[0m'; fi
show() { printf '\n%s$ %s%s\n' "$bold" "$*" "$plain"; }
fail() { echo "$1" >&2; cat "$work"/*.log >&2; exit 1; }
await() { for _ in $(seq 100); do "$@" >/dev/null 2>&1 && return; sleep 0.2; done; fail "waited in vain for: $*"; }
first() { timeout -k 10 60 rostopic echo -n 1 "$1" || fail "nothing comes on $1"; }

mkdir -p "$work"
cd "$work"
[ -x env/bin/python3 ] || "$bin/python" "$checkout/tools/ros_environment.py" env >/dev/null
unitylink() { "$bin/unitylink" "$@"; }
export CMAKE_POLICY_VERSION_MINIMUM=3.5   # catkin is older than CMake 4
export PATH="$work/env/bin:$PATH" ROS_IP=127.0.0.1 ROS_HOME=$work/home ROS_LOG_DIR=$work/log PYTHONUNBUFFERED=1
ROS_MASTER_URI="http://127.0.0.1:$(free_port)"; export ROS_MASTER_URI

show "unitylink generate scara.ul --out src --only ros1; catkin_make"
unitylink generate "$checkout/examples/scara/scara.ul" --out src --only ros1 | tail -1
catkin_make -DPYTHON_EXECUTABLE="$work/env/bin/python3" > catkin.log 2>&1 || { tail -30 catkin.log; exit 1; }
set +eu; . devel/setup.bash; set -eu

rosmaster --core -p "${ROS_MASTER_URI##*:}" > master.log 2>&1 & running+=($!)
port=$(free_port)
show "unitylink simulate scara.ul --plant scara --tcp $port"
"$bin/unitylink" simulate "$checkout/examples/scara/scara.ul" --plant scara --tcp "$port" > board.log 2>&1 &
running+=($!)
await grep -q serving board.log
await rostopic list
show "roslaunch scara_unitylink scara.launch link:=tcp://127.0.0.1:$port"
roslaunch scara_unitylink scara.launch link:="tcp://127.0.0.1:$port" > launch.log 2>&1 & running+=($!)
await rostopic info /scara/j1/feedback
show "rostopic echo -n 1 /scara/j1/feedback"
first /scara/j1/feedback
show "rostopic hz /scara/j1/feedback"
timeout -k 10 -s INT 4 rostopic hz /scara/j1/feedback || true
show "rostopic pub -1 /scara/j1/command scara_unitylink/JointCommand '{pos_sp: 3000, spd_sp: 20000}'"
rostopic pub -1 /scara/j1/command scara_unitylink/JointCommand '{pos_sp: 3000, spd_sp: 20000}'
show "rostopic echo -n 1 /scara/j1/feedback/cpos"
position=$(first /scara/j1/feedback/cpos | head -n 1)
echo "$position"
[ "$position" -gt 2900 ] || { echo "the joint has not moved" >&2; exit 1; }
printf '\nthe SCARA has moved by rostopic pub; docs/ros.md goes on from here\n'
