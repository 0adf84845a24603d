# SPDX-License-Identifier: BSD-3-Clause
# The SCARA's generated package in ROS 1 Noetic, with its node in C++: Noetic's Python is 3.8, Unity-Link's needs 3.10.
# In a checkout, after `unitylink generate examples/scara/scara.ul --out build/noetic --only ros1`:
#   docker build -f examples/ros/noetic.Dockerfile -t scara-noetic . && docker run --net=host scara-noetic link:=tcp://127.0.0.1:5555
FROM ros:noetic-ros-base
RUN apt-get update && apt-get install -y --no-install-recommends g++-10 ninja-build python3-pip ros-noetic-diagnostic-msgs \
    ros-noetic-geometry-msgs ros-noetic-sensor-msgs ros-noetic-std-srvs && rm -rf /var/lib/apt/lists/* && pip3 install 'cmake>=3.20,<4'
WORKDIR /core
COPY CMakeLists.txt ./
COPY cmake cmake
COPY native native
RUN CXX=g++-10 cmake -S . -B build -G Ninja && cmake --build build && cmake --install build --prefix /opt/unitylink
WORKDIR /ws
COPY build/noetic src
RUN . /opt/ros/noetic/setup.sh && CXX=g++-10 catkin_make -DCMAKE_PREFIX_PATH="/opt/unitylink;/opt/ros/noetic"
ENTRYPOINT ["/bin/bash", "-c", ". devel/setup.bash && exec roslaunch scara_unitylink scara.launch node:=node \"$@\"", "--"]
