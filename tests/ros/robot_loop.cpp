// SPDX-License-Identifier: BSD-3-Clause
//
// The class below a generated C++ node, without ROS. `robot_loop URL` does what each line of standard input says, like
// the thread of a node, and answers with a line. Messages of the robot are lines that begin with `say`. Without a URL,
// `robot_loop` opens no link, and only converts values.
//   set NAME NUMBER · hang SECONDS · health · number INDEX RAW · encode INDEX NUMBER · joints COUNT NAME... POSITION...
#include <poll.h>

#include <iostream>
#include <memory>
#include <mutex>
#include <sstream>

#include "robot.hpp"

using every_unitylink_robot::table;
using every_unitylink_robot::values;

// A sensor_msgs/JointState without ROS.
struct JointState {
  std::vector<std::string> name;
  std::vector<double> position, velocity, effort;
};

// What a JointState of so many names and then positions sets, or why it is refused.
std::string joints(std::size_t count, std::istream& words) {
  JointState message;
  message.name.resize(count);
  for (auto& joint : message.name) words >> joint;
  for (double position; words >> position;) message.position.push_back(position);
  every_unitylink_robot::Command command;
  command.joint_state(message);
  std::ostringstream answer;
  for (std::size_t i = 0; i < command.indices.size(); ++i)
    answer << values[command.indices[i]].path << '=' << command.numbers[i] << ' ';
  return command.why.empty() ? answer.str() : command.why;
}

int main(int argc, char** argv) {
  std::mutex out;
  const auto tell = [&out](const std::string& line) {
    const std::lock_guard<std::mutex> lock(out);
    std::cout << line << std::endl;
  };
  std::unique_ptr<unitylink::Robot> robot;
  if (argc > 1) {
    unitylink::RobotOptions options;
    options.url = argv[1];
    options.retry_s = 0.05;
    options.deadman_s = 0.3;
    robot = std::make_unique<unitylink::Robot>(
        table, options, [](std::size_t, double, const std::uint64_t*) {},
        [&](int level, const std::string& said) { tell("say " + std::to_string(level) + " " + said); });
  }
  std::string line;
  while (true) {
    pollfd input{0, POLLIN, 0};
    if (robot) robot->alive();
    if (std::cin.rdbuf()->in_avail() == 0 && ::poll(&input, 1, 50) == 0) continue;
    if (!std::getline(std::cin, line)) break;
    std::istringstream words(line);
    std::string what, name, number;
    words >> what >> name;
    if (what == "joints") {
      tell(joints(std::stoul(name), words));
      continue;
    }
    words >> number;
    if (what == "set") {
      std::string why;
      for (std::uint16_t i = 0; i < table.value_count; ++i) {
        const double wanted = std::strtod(number.c_str(), nullptr);
        if (name == values[i].path) why = robot->set(&i, &wanted, 1, why) ? "set" : why;
      }
      tell(why);
    } else if (what == "hang") {
      std::this_thread::sleep_for(std::chrono::duration<double>(std::stod(name)));
      tell("hung");
    } else if (what == "health") {
      unitylink::Facts facts;
      tell("health " + std::to_string(robot->health(facts)) + " " + robot->state());
    } else if (what == "number") {
      char text[40];
      std::snprintf(text, sizeof text, "%.17g", unitylink::number(values[std::stoul(name)], std::stoull(number)));
      tell(text);
    } else if (what == "encode") {
      std::uint64_t raw = 0;
      tell(unitylink::encode(values[std::stoul(name)], std::strtod(number.c_str(), nullptr), raw) ? std::to_string(raw)
                                                                                                  : "none");
    }
  }
  if (robot) robot->rest();
  return 0;
}
