// SPDX-License-Identifier: BSD-3-Clause
//
// Runs the generated plug-in of ros2_control like a controller manager: `control_loop PARAMETER=VALUE..
// PART/INTERFACE..`. A PART/INTERFACE is a state interface that the URDF lists, `>PART/INTERFACE:TYPE` a command
// interface on a gpio. Each line of standard input is an order:
//
//     configure, activate, deactivate, cleanup, shutdown, cycle N, set NAME NUMBER, get NAME, names
//
// `cycle` calls read() and write() N times. It answers how often they have allocated memory, locked or waited, thrown,
// and failed. The state of the hardware changes as ros2_control's system.cpp does it.
#include <dlfcn.h>
#include <poll.h>
#include <pthread.h>
#include <semaphore.h>
#include <time.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "ros2_control.cpp"

namespace {
thread_local bool watched = false;
thread_local unsigned long allocations = 0, waits = 0;
template <typename Function>
Function genuine(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}
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
#define COUNTED(name, parameters, arguments)                      \
  extern "C" int name parameters {                                \
    static const auto called = genuine<int(*) parameters>(#name); \
    if (watched) ++waits;                                         \
    return called arguments;                                      \
  }
COUNTED(pthread_mutex_lock, (pthread_mutex_t * mutex), (mutex))
COUNTED(pthread_rwlock_rdlock, (pthread_rwlock_t * lock), (lock))
COUNTED(pthread_rwlock_wrlock, (pthread_rwlock_t * lock), (lock))
COUNTED(sem_wait, (sem_t * semaphore), (semaphore))
COUNTED(sem_timedwait, (sem_t * semaphore, const timespec* until), (semaphore, until))
COUNTED(sem_clockwait, (sem_t * semaphore, clockid_t clock, const timespec* until), (semaphore, clock, until))
COUNTED(poll, (pollfd * files, nfds_t count, int timeout), (files, count, timeout))
COUNTED(clock_nanosleep, (clockid_t clock, int flags, const timespec* until, timespec* rest),
        (clock, flags, until, rest))

using hardware_interface::return_type;
using PACKAGE::CallbackReturn;

class Manager {
 public:
  bool init(const hardware_interface::HardwareInfo& info) {
#ifdef UNITYLINK_FRAMEWORK_KEEPS_NUMBERS
    hardware_interface::HardwareComponentInterfaceParams params{};
    params.hardware_info = info;
    if (hardware_.on_init(params) != CallbackReturn::SUCCESS) return false;
    for (const auto& one : hardware_.on_export_state_interfaces()) states_.emplace_back(one->get_name(), one);
    for (const auto& one : hardware_.on_export_command_interfaces()) commands_.emplace_back(one->get_name(), one);
#else
    if (hardware_.on_init(info) != CallbackReturn::SUCCESS) return false;
    for (auto& one : hardware_.export_state_interfaces()) states_.emplace_back(one.get_name(), std::move(one));
    for (auto& one : hardware_.export_command_interfaces()) commands_.emplace_back(one.get_name(), std::move(one));
#endif
    return true;
  }

  void order(const std::string& line) {
    const std::string order = line.substr(0, line.find(' '));
    const std::string rest = order.size() < line.size() ? line.substr(order.size() + 1) : "";
    if (order == "configure") move("unconfigured", hardware_.on_configure({}), "inactive");
    if (order == "activate") move("inactive", hardware_.on_activate({}), "active");
    if (order == "deactivate") move("active", hardware_.on_deactivate({}), "inactive");
    if (order == "cleanup") move("inactive", hardware_.on_cleanup({}), "unconfigured");
    if (order == "shutdown") move(state_, hardware_.on_shutdown({}), "finalized");
    if (order == "cycle") cycle(std::strtoul(rest.c_str(), nullptr, 10));
    if (order == "set") set(rest.substr(0, rest.find(' ')), std::strtod(rest.c_str() + rest.find(' '), nullptr));
    if (order == "get") std::printf("%.15g", number(rest));
    if (order == "names") names();
    std::printf("\n");
    std::fflush(stdout);
  }

 private:
  void move(const std::string& from, CallbackReturn done, const std::string& to) {
    if (done == CallbackReturn::SUCCESS) state_ = to;
    if (done == CallbackReturn::FAILURE) state_ = from;
    if (done == CallbackReturn::ERROR) error();
    std::printf("%s", state_.c_str());
  }
  void error() { state_ = hardware_.on_error({}) == CallbackReturn::SUCCESS ? "unconfigured" : "finalized"; }

  void cycle(unsigned long count) {
    unsigned long failed = 0, thrown = 0;
    allocations = waits = 0;
    for (; count > 0 && (state_ == "active" || state_ == "inactive"); --count) {
      auto came = return_type::ERROR, went = return_type::ERROR;
      watched = true;
      try {
        came = hardware_.read({}, {});
        if (came == return_type::OK) went = hardware_.write({}, {});
      } catch (...) {
        ++thrown;
      }
      watched = false;
      if (came != return_type::OK || went != return_type::OK) ++failed, error();
    }
    std::printf("allocations %lu waits %lu thrown %lu failed %lu %s", allocations, waits, thrown, failed,
                state_.c_str());
  }

  template <typename Handles>
  static auto& find(Handles& handles, const std::string& name) {
    for (auto& one : handles)
      if (one.first == name) return one.second;
    std::fprintf(stderr, "no interface %s\n", name.c_str());
    std::exit(5);
  }

#ifdef UNITYLINK_FRAMEWORK_KEEPS_NUMBERS
  double number(const std::string& name) {
    return name[0] == '>' ? find(commands_, name.substr(1))->as_double() : find(states_, name)->as_double();
  }
  void set(const std::string& name, double number) {
    const auto& handle = find(commands_, name);
    PACKAGE::typed(PACKAGE::kind_of(handle->get_data_type().to_string()),
                   [&](auto type) { return handle->set_value(static_cast<decltype(type)>(number), true); });
  }
  void names() {
    for (const auto& one : states_)
      std::printf("%s:%s ", one.first.c_str(), one.second->get_data_type().to_string().c_str());
    for (const auto& one : commands_)
      std::printf(">%s:%s ", one.first.c_str(), one.second->get_data_type().to_string().c_str());
  }
  std::vector<std::pair<std::string, hardware_interface::StateInterface::ConstSharedPtr>> states_;
  std::vector<std::pair<std::string, hardware_interface::CommandInterface::SharedPtr>> commands_;
#else
  double number(const std::string& name) {
    return name[0] == '>' ? find(commands_, name.substr(1)).get_value() : find(states_, name).get_value();
  }
  void set(const std::string& name, double number) { find(commands_, name).set_value(number); }
  void names() {
    for (const auto& one : states_) std::printf("%s:double ", one.first.c_str());
    for (const auto& one : commands_) std::printf(">%s:double ", one.first.c_str());
  }
  std::vector<std::pair<std::string, hardware_interface::StateInterface>> states_;
  std::vector<std::pair<std::string, hardware_interface::CommandInterface>> commands_;
#endif
  PACKAGE::RobotSystem hardware_;
  std::string state_ = "unconfigured";
};

// Adds an interface of the URDF.
void list(hardware_interface::HardwareInfo& info, std::string text) {
  const bool command = text[0] == '>';
  if (command) text.erase(0, 1);
  const auto slash = text.find('/'), colon = text.find(':');
  hardware_interface::InterfaceInfo one{};
  one.name = text.substr(slash + 1, colon - slash - 1);
  one.data_type = colon == std::string::npos ? "double" : text.substr(colon + 1);
  auto& parts = command ? info.gpios : info.joints;
  parts.push_back({});
  parts.back().name = text.substr(0, slash);
  (command ? parts.back().command_interfaces : parts.back().state_interfaces).push_back(one);
}

int main(int argc, char** argv) {
  {  // check that allocations and waits are really counted
    std::mutex mutex;
    watched = true;
    std::vector<int> noticed(1000);
    mutex.lock();
    watched = false;
    mutex.unlock();
    if (allocations == 0 || waits == 0) return 4;
  }
  hardware_interface::HardwareInfo info;
  info.name = "arm";
  info.type = "system";
  for (int i = 1; i < argc; ++i) {
    const std::string text = argv[i];
    const auto equals = text.find('=');
    if (equals != std::string::npos && text.find('/') > equals)
      info.hardware_parameters[text.substr(0, equals)] = text.substr(equals + 1);
    else
      list(info, text);
  }
  Manager manager;
  if (!manager.init(info)) return 2;
  char line[200];
  while (std::fgets(line, sizeof line, stdin) != nullptr) manager.order(std::string(line, std::strcspn(line, "\n")));
  return 0;
}
