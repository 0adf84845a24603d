// SPDX-License-Identifier: BSD-3-Clause
//
// Runs the generated plug-in of ros2_control like a controller manager: `control_loop URL`. Each line of standard input
// is a position for all joints. The answer is the positions read, and how often read() and write() have allocated
// memory or locked a mutex.
#include <dlfcn.h>
#include <pthread.h>

#include <cstdlib>
#include <iostream>

#include "ros2_control.cpp"

namespace {
thread_local bool watched = false;
thread_local unsigned long allocations = 0, locks = 0;
}  // namespace

extern "C" void* __libc_malloc(std::size_t size);
extern "C" void __libc_free(void* memory);
extern "C" void* malloc(std::size_t size) {
  if (watched) ++allocations;
  return __libc_malloc(size);
}
extern "C" void free(void* memory) {
  if (watched && memory != nullptr) ++allocations;
  __libc_free(memory);
}
extern "C" int pthread_mutex_lock(pthread_mutex_t* mutex) {
  using Lock = int (*)(pthread_mutex_t*);
  static const Lock lock = reinterpret_cast<Lock>(dlsym(RTLD_NEXT, "pthread_mutex_lock"));
  if (watched) ++locks;
  return lock(mutex);
}

int main(int argc, char** argv) {
  PACKAGE::RobotSystem hardware;
  hardware_interface::HardwareInfo info;
  if (argc > 1) info.hardware_parameters["link"] = argv[1];
  if (argc > 2) info.joints.push_back({argv[2]});
  if (hardware.on_init(info) != hardware_interface::CallbackReturn::SUCCESS) return 2;
  auto states = hardware.export_state_interfaces();
  auto commands = hardware.export_command_interfaces();
  if (hardware.on_activate({}) != hardware_interface::CallbackReturn::SUCCESS) return 3;
  const auto once = [&] {
    watched = true;
    const auto came = hardware.read({}, {});
    const auto went = hardware.write({}, {});
    watched = false;
    return came == hardware_interface::return_type::OK && went == hardware_interface::return_type::OK;
  };
  {  // check that allocations and locks are really counted
    watched = true;
    std::vector<int> noticed(1000);
    watched = false;
    if (allocations == 0) return 4;
    allocations = 0;
  }
  double position = 0.0;
  while (std::cin >> position) {
    for (auto& command : commands) command.set_value(position);
    bool good = true;
    for (int i = 0; i < 1000; ++i) good = once() && good;
    std::cout << "allocations " << allocations << " locks " << locks << " good " << good;
    for (const auto& state : states) std::cout << " " << state.get_name() << "=" << state.get_value();
    std::cout << std::endl;
  }
  hardware.on_deactivate({});
  return 0;
}
