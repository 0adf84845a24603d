// SPDX-License-Identifier: BSD-3-Clause
//
// One end of the measurement of roscpp. `ros_peer pub TOPIC RATE_HZ` publishes std_msgs/Int32 in a burst every
// millisecond. `ros_peer sub TOPIC` counts them. A line on standard input is the number of seconds to count for. The
// answer is "COUNT SECONDS CPU_SECONDS". The bench compiles this file on a machine with ROS 1 (pkg-config roscpp).
#include <ros/ros.h>
#include <std_msgs/Int32.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <iostream>
#include <string>
#include <thread>

int main(int argc, char** argv) {
  using Clock = std::chrono::steady_clock;
  ros::init(argc, argv, "peer", ros::init_options::AnonymousName | ros::init_options::NoSigintHandler);
  const std::string role = argc > 2 ? argv[1] : "", topic = argc > 2 ? argv[2] : "";
  if (role != "sub" && (role != "pub" || argc < 4))
    return std::cerr << "usage: ros_peer sub TOPIC | pub TOPIC RATE_HZ\n", 2;
  ros::NodeHandle handle;
  std::atomic<unsigned long> count{0};
  std::atomic<bool> stop{false};
  ros::Publisher out;
  ros::Subscriber in;
  std::thread flood;
  if (role == "sub") {
    in = handle.subscribe<std_msgs::Int32>(
        topic, 4096, [&](const std_msgs::Int32::ConstPtr&) { ++count; }, ros::VoidConstPtr(),
        ros::TransportHints().tcpNoDelay());
  } else {
    out = handle.advertise<std_msgs::Int32>(topic, 4096);
    flood = std::thread([&, burst = std::atoi(argv[3]) / 1000] {
      std_msgs::Int32 message;
      for (auto due = Clock::now(); !stop;
           due = std::max(due + std::chrono::milliseconds(1), Clock::now() - std::chrono::milliseconds(10))) {
        std::this_thread::sleep_until(due);
        for (int i = 0; i < burst && out.getNumSubscribers() > 0; ++i, ++count) {
          ++message.data;
          out.publish(message);
        }
      }
    });
  }
  ros::AsyncSpinner spinner(1);
  spinner.start();
  std::cout << "ready" << std::endl;
  for (std::string line; std::getline(std::cin, line);) {
    const auto before = count.load();
    const auto wall = Clock::now();
    const auto cpu = std::clock();
    std::this_thread::sleep_for(std::chrono::duration<double>(std::strtod(line.c_str(), nullptr)));
    const std::chrono::duration<double> took = Clock::now() - wall;
    std::cout << count - before << ' ' << took.count() << ' '
              << static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC << std::endl;
  }
  stop = true;
  if (flood.joinable()) flood.join();
  return 0;
}
