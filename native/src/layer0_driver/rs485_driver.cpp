// SPDX-License-Identifier: BSD-3-Clause
// A node on an RS-485 pair: one serial port, shared by the links of this process to all nodes on it. We are the master.
//   rs485:/dev/ttyUSB0?node=3&baud=3000000
// Options: node= (1 to 63), baud=, poll= (s between looks at a node that has nothing to say, 0.001), silence= (s until
// a node that was polled counts as not there, 0.02).

#include <unistd.h>

#include "layer0_driver/pair_master.hpp"
#include "layer0_driver/pumped_driver.hpp"
#include "layer0_driver/serial_driver.hpp"
#include "unitylink/protocol.hpp"

namespace unitylink {
namespace {

using pair_bus::Master;

constexpr std::uint64_t poll_ns_default = 1'000'000;
constexpr std::uint64_t silence_ns_default = 20'000'000;

// The link's end of a socket pair; the master has the other.
class Rs485Driver final : public DescriptorDriver {
 public:
  Rs485Driver(std::shared_ptr<Master> master, unsigned node, int descriptor)
      : DescriptorDriver(descriptor), master_(std::move(master)), node_(node), byte_time_ns_(master_->byte_time_ns()) {}
  ~Rs485Driver() override { Rs485Driver::close(); }

  void close() noexcept override {
    if (master_ != nullptr) {
      master_->leave(node_);
      master_.reset();  // the last one closes the port
    }
    DescriptorDriver::close();
  }
  void disown() noexcept override {  // a forked child: the master's thread is the parent's
    Master::disown(std::move(master_));
    DescriptorDriver::close();
  }
  [[nodiscard]] std::uint64_t byte_time_ns() const noexcept override { return byte_time_ns_; }
  [[nodiscard]] std::string reason() const override {
    const std::string why = master_ != nullptr ? master_->reason() : "";
    return why.empty() ? DescriptorDriver::reason() : why;
  }

 private:
  std::shared_ptr<Master> master_;
  unsigned node_;
  std::uint64_t byte_time_ns_;
};

Outcome settings_of(const Url& url, pair_bus::Settings& settings) {
  std::uint64_t number = 0;
  const std::string* const node = url.option("node");
  if (node == nullptr) {
    return wrong_url(url, "which node? node=1 to node=" + std::to_string(protocol::rs485::nodes_max));
  }
  if (!parse_number(*node, protocol::rs485::nodes_max, number) || number == 0) {
    return wrong_url(url, "node=" + *node + " is not a number from 1 to " + std::to_string(protocol::rs485::nodes_max));
  }
  const std::string* const baud = url.option("baud");
  settings = {static_cast<unsigned>(number), baud != nullptr ? *baud : std::to_string(default_baud_hz), poll_ns_default,
              silence_ns_default};
  for (const auto& [name, ns] : {std::pair{"poll", &settings.poll_ns}, std::pair{"silence", &settings.silence_ns}}) {
    if (const std::string* text = url.option(name); text != nullptr && !parse_seconds(*text, *ns)) {
      return wrong_url(url, std::string(name) + "=" + *text + " is not a time in seconds from 1e-6 to 3600");
    }
  }
  return {};
}

}  // namespace

// bad_url, not_found, permission, busy (the port, or a second link to the node), mismatch (another baud rate than the
// links to other nodes).
Outcome open_rs485(const Url& url, const Patience&, std::unique_ptr<Driver>& driver) {
  pair_bus::Settings settings;
  if (Outcome outcome = settings_of(url, settings); !outcome.ok()) {
    return outcome;
  }
  std::shared_ptr<Master> master;
  if (Outcome outcome = Master::of(url, settings, master); !outcome.ok()) {
    return outcome;
  }
  SocketPair pair;
  if (Outcome outcome = make_socket_pair(pair); !outcome.ok()) {
    return outcome;
  }
  if (Outcome outcome = master->join(settings, pair.far); !outcome.ok()) {
    ::close(pair.near);
    return outcome;
  }
  driver = std::make_unique<Rs485Driver>(std::move(master), settings.node, pair.near);
  return {};
}

}  // namespace unitylink
