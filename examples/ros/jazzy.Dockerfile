# SPDX-License-Identifier: BSD-3-Clause
# The SCARA's generated package in ROS 2 Jazzy, with both nodes and the plug-in of ros2_control. Of another release with
# --build-arg ROS=humble or rolling. In a checkout:
#   docker build -f examples/ros/jazzy.Dockerfile -t scara-jazzy . && docker run --net=host scara-jazzy link:=tcp://127.0.0.1:5555
ARG ROS=jazzy
FROM ros:${ROS}-ros-base
RUN apt-get update && apt-get install -y --no-install-recommends g++ git ninja-build python3-venv python3-dev \
    python3-colcon-common-extensions ros-$ROS_DISTRO-ros2-control ros-$ROS_DISTRO-ros2-controllers \
    ros-$ROS_DISTRO-xacro ros-$ROS_DISTRO-robot-state-publisher && rm -rf /var/lib/apt/lists/*
WORKDIR /unity-link
COPY . .
RUN cmake -S . -B /core -G Ninja && cmake --build /core && cmake --install /core --prefix /opt/unitylink
ENV VIRTUAL_ENV=/opt/venv PATH=/opt/venv/bin:$PATH CMAKE_PREFIX_PATH=/opt/unitylink LD_LIBRARY_PATH=/opt/unitylink/lib
RUN python3 -m venv --system-site-packages /opt/venv && pip install '.[ros2]'
WORKDIR /ws
RUN unitylink generate /unity-link/examples/scara/scara.ul --out src --only ros2 \
    && . /opt/ros/$ROS_DISTRO/setup.sh && python3 -m colcon build
ENTRYPOINT ["/bin/bash", "-c", ". install/setup.bash && exec ros2 launch scara_unitylink scara.launch.py \"$@\"", "--"]
