// SPDX-License-Identifier: BSD-3-Clause
// A node on an RS-485 pair. All links of this process to nodes of the same pair share one serial port. The PC is the
// master.
//   rs485:/dev/ttyUSB0?node=3&baud=3000000
// Options, with their defaults:
//   node=      1 to 63
//   baud=      (115200)
//   poll=      (0.001) s between two polls of a node that has nothing to send
//   silence=   (0.02) s after which a node that does not answer its poll counts as absent

#include "layer0_driver/pair_master.hpp"
#include "layer0_driver/pumped_driver.hpp"
#include "layer0_driver/serial_driver.hpp"
#include "unitylink/protocol.hpp"

namespace unitylink {
namespace {

using pair_bus::Master;

constexpr std::uint64_t poll_ns_default = 1'000'000;
constexpr std::uint64_t silence_ns_default = 20'000'000;

// The link's end of the socket pair. The master has the other end.
class Rs485Driver final : public DescriptorDriver {
 public:
  Rs485Driver(std::shared_ptr<Master> master, unsigned node, Descriptor near)
      : DescriptorDriver(near.release()),
        master_(std::move(master)),
        node_(node),
        byte_time_ns_(master_->byte_time_ns()) {}
  ~Rs485Driver() override { Rs485Driver::close(); }

  [[nodiscard]] Outcome join(const pair_bus::Settings& settings, Descriptor far) {
    Outcome outcome = master_->join(settings, std::move(far));
    joined_ = outcome.ok();
    return outcome;
  }
  void close() noexcept override {
    if (master_ != nullptr) {
      if (joined_) {
        master_->leave(node_);
      }
      master_.reset();  // the last link closes the port
    }
    DescriptorDriver::close();
  }
  void disown() noexcept override {  // for a forked child: the master's thread belongs to the parent
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
  bool joined_ = false;
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

// Errors: bad_url, not_found, permission, busy (another program has the port, or another link has the node), mismatch
// (the links to other nodes have another baud rate).
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
  auto made = std::make_unique<Rs485Driver>(std::move(master), settings.node, std::move(pair.near));
  if (Outcome outcome = made->join(settings, std::move(pair.far)); !outcome.ok()) {
    return outcome;
  }
  driver = std::move(made);
  return {};
}

}  // namespace unitylink
