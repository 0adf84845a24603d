// SPDX-License-Identifier: BSD-3-Clause
// FTDI's USB chips, used without the kernel's serial driver. So the link can set the latency timer, the event character
// and the FIFO modes, and one transfer moves many packets.
//   ftdi:SERIAL?channel=B&mode=serial&baud=3000000     ftdi:?mode=sync-fifo (if only one chip is plugged in)
// Options, with their defaults:
//   channel=A..D           (A)
//   mode=serial|fifo|sync-fifo   (serial) fifo is the asynchronous FT245 interface
//   baud=                  only for mode=serial
//   latency=               (1) in ms
//   event=                 after this character the chip sends at once what it has collected; none: no such character.
//                          By default it is the end of a message in the protocol of the link

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <new>
#include <thread>
#include <vector>

#include "layer0_driver/ftdi_port.hpp"
#include "layer0_driver/pumped_driver.hpp"
#include "layer0_driver/serial_driver.hpp"

namespace unitylink {
namespace {

constexpr std::size_t transfers = 4;  // several in progress at once, so that the chip never waits for the PC
constexpr std::size_t transfer_bytes = 16 * 1024;  // at most: a short packet ends a transfer early
constexpr unsigned int send_timeout_ms = 100;      // how often the thread checks whether it must end
constexpr long events_timeout_us = 50'000;
constexpr std::uint64_t patience_ns = 100'000'000;
constexpr const char* unplugged = "the FTDI chip was unplugged";

// If the link does not fetch its bytes, they stay in the transfers. When these are full, the chip stops the board.
class FtdiDriver final : public PumpedDriver {
 public:
  FtdiDriver(std::unique_ptr<ftdi::Port> port, SocketPair pair, std::uint64_t byte_time_ns, bool event_told)
      : PumpedDriver(std::move(pair)), port_(std::move(port)), byte_time_ns_(byte_time_ns), event_told_(event_told) {
    for (Incoming& one : incoming_) {
      one.driver = this;
      one.transfer = {port_->library().alloc_transfer(0), port_->library().free_transfer};
      if (one.transfer == nullptr) {
        throw std::bad_alloc();
      }
    }
  }
  ~FtdiDriver() override { FtdiDriver::close(); }

  void begin() {
    start([this] { receive_all(); });
    start([this] { send_all(); });
  }

  [[nodiscard]] std::uint64_t byte_time_ns() const noexcept override { return byte_time_ns_; }
  void messages_end_with(std::uint8_t end) noexcept override {
    if (!event_told_ && running()) {
      static_cast<void>(port_->send_event(end));  // if it fails, the chip delivers when its latency timer ends
    }
  }

 private:
  void let_go(bool ours) noexcept override {
    for (Incoming& one : incoming_) {  // before the port, which unloads the library
      ours ? one.transfer.reset() : static_cast<void>(one.transfer.release());
    }
    ours ? port_.reset() : static_cast<void>(port_.release());
  }

  // ---- from the chip

  struct Incoming {
    std::vector<std::uint8_t> bytes = std::vector<std::uint8_t>(transfer_bytes);
    std::unique_ptr<usb::Transfer, void (*)(usb::Transfer*)> transfer{nullptr, nullptr};
    FtdiDriver* driver = nullptr;
    bool under_way = false;
  };

  static void arrived(usb::Transfer* transfer) {
    auto& incoming = *static_cast<Incoming*>(transfer->user_data);
    incoming.under_way = false;
    incoming.driver->take(incoming);
  }

  void take(Incoming& incoming) {
    const usb::Transfer& transfer = *incoming.transfer;
    const std::span<std::uint8_t> bytes(incoming.bytes.data(), static_cast<std::size_t>(transfer.actual_length));
    hand_on(bytes.first(ftdi::strip_status(bytes, port_->packet_bytes())));
    switch (transfer.status) {
      case usb::TransferStatus::completed:
      case usb::TransferStatus::timed_out:
        if (running()) {
          submit(incoming);
        }
        return;
      case usb::TransferStatus::cancelled: return;
      case usb::TransferStatus::no_device: ended(unplugged); return;
      case usb::TransferStatus::stall: ended("USB transfer from the FTDI chip failed: stall"); return;
      case usb::TransferStatus::overflow: ended("USB transfer from the FTDI chip failed: overflow"); return;
      default: ended("USB transfer from the FTDI chip failed"); return;
    }
  }

  void submit(Incoming& incoming) {
    const int code = port_->library().submit_transfer(incoming.transfer.get());
    incoming.under_way = code == 0;
    if (code != 0) {
      failed_at("USB transfer from the FTDI chip failed: ", code);
    }
  }

  void failed_at(const char* what, int code) noexcept {
    if (code == usb::error_no_device) {
      ended(unplugged);
    } else {
      ended(what, port_->library().error_name(code));
    }
  }

  void receive_all() {
    usb::Library& usb = port_->library();
    for (Incoming& one : incoming_) {
      *one.transfer = usb::Transfer{
          port_->handle(), 0,    port_->in(),      usb::bulk, 0, {}, static_cast<int>(one.bytes.size()), 0,
          &arrived,        &one, one.bytes.data(), 0};
      if (running()) {
        submit(one);
      }
    }
    bool cancelled = false;
    while (std::ranges::any_of(incoming_, &Incoming::under_way)) {
      if (!running() && !cancelled) {
        cancelled = true;
        for (const Incoming& one : incoming_) {
          if (one.under_way) {
            usb.cancel_transfer(one.transfer.get());
          }
        }
      }
      usb::Interval patience{0, events_timeout_us};
      const int code = usb.handle_events_timeout(port_->context(), &patience);
      if (code < 0 && code != usb::error_interrupted) {
        failed_at("USB events cannot be handled: ", code);
        // because the next call may also fail at once
        std::this_thread::sleep_for(std::chrono::microseconds(events_timeout_us));
      }
    }
  }

  // ---- to the chip

  void send_all() {
    while (running()) {
      push(std::span(outgoing_.data(), fetch(outgoing_, patience_ns)));
    }
  }

  void push(std::span<std::uint8_t> bytes) {
    while (!bytes.empty() && running()) {
      int done = 0;
      const int code = port_->library().bulk_transfer(port_->handle(), port_->out(), bytes.data(),
                                                      static_cast<int>(bytes.size()), &done, send_timeout_ms);
      bytes = bytes.subspan(static_cast<std::size_t>(done));
      if (code != 0 && code != usb::error_timeout) {  // a timeout: the board takes no bytes now
        failed_at("USB transfer to the FTDI chip failed: ", code);
      }
    }
  }

  std::unique_ptr<ftdi::Port> port_;
  std::uint64_t byte_time_ns_;
  bool event_told_;
  // made with the driver, so that the threads need no memory
  std::array<Incoming, transfers> incoming_;
  std::vector<std::uint8_t> outgoing_ = std::vector<std::uint8_t>(transfer_bytes);
};

// The kernel's serial port of the chip, with a warning that it is used instead.
class KernelPort final : public Driver {
 public:
  KernelPort(std::unique_ptr<Driver> driver, std::string notice)
      : driver_(std::move(driver)), notice_(std::move(notice)) {}
  [[nodiscard]] Transfer send(std::span<const std::uint8_t> bytes) noexcept override { return driver_->send(bytes); }
  [[nodiscard]] Transfer receive(std::span<std::uint8_t> room) noexcept override { return driver_->receive(room); }
  void close() noexcept override { driver_->close(); }
  void disown() noexcept override { driver_->disown(); }
  [[nodiscard]] int descriptor() const noexcept override { return driver_->descriptor(); }
  [[nodiscard]] std::uint64_t byte_time_ns() const noexcept override { return driver_->byte_time_ns(); }
  [[nodiscard]] std::string reason() const override { return driver_->reason(); }
  [[nodiscard]] std::string warning() const override { return notice_; }

 private:
  std::unique_ptr<Driver> driver_;
  std::string notice_;
};

std::string first_line(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  return line;
}

// The kernel's port of this chip and channel, such as /dev/ttyUSB0. "": there is none. For tests, UNITYLINK_ROOT names
// another folder that contains sys and dev.
std::string kernel_port(const ftdi::Settings& settings) {
  const char* const told = std::getenv("UNITYLINK_ROOT");
  const std::string root = told != nullptr ? told : "";
  const std::filesystem::path devices = root + "/sys/bus/usb/devices";
  std::error_code ignored;
  std::string port;
  for (const auto& device : std::filesystem::directory_iterator(devices, ignored)) {
    const std::string serial = first_line(device.path() / "serial");
    if (first_line(device.path() / "idVendor") != "0403" ||
        (!settings.serial_number.empty() && serial != settings.serial_number)) {
      continue;
    }
    const std::filesystem::path channel =
        devices / (device.path().filename().string() + ":1." + std::to_string(settings.channel));
    for (const auto& entry : std::filesystem::directory_iterator(channel, ignored)) {
      const std::string name = entry.path().filename().string();
      if (name.starts_with("ttyUSB")) {
        if (!port.empty()) {
          return {};  // several chips match, and the URL does not say which one
        }
        port = root + "/dev/" + name;
      }
    }
  }
  return port;
}

Outcome fall_back(const Url& url, const ftdi::Settings& settings, const Outcome& why, std::unique_ptr<Driver>& driver) {
  const std::string path = kernel_port(settings);
  if (path.empty()) {
    return why;
  }
  Url serial = url;
  serial.scheme = "serial";
  serial.path = path;
  std::unique_ptr<Driver> opened;
  if (!open_serial(serial, {}, opened).ok()) {
    return why;
  }
  driver = std::make_unique<KernelPort>(
      std::move(opened), why.text + ": the kernel's serial port " + path + " is used instead, without event character");
  return {};
}

}  // namespace

// Errors: bad_url, not_found, permission, busy. If libusb is missing or may not use the chip, the kernel's serial port
// of the same chip is opened instead, and warning() says so. This does not work for mode=sync-fifo.
Outcome open_ftdi(const Url& url, const Patience&, std::unique_ptr<Driver>& driver) {
  ftdi::Settings settings;
  if (Outcome outcome = ftdi::settings_of(url, settings); !outcome.ok()) {
    return outcome;
  }
  std::unique_ptr<ftdi::Port> port;
  if (Outcome outcome = ftdi::Port::open(settings, port); !outcome.ok()) {
    const bool may_be_had_otherwise =
        outcome.status == Status::permission || (outcome.status == Status::not_found && port == nullptr);
    return may_be_had_otherwise && settings.mode != ftdi::Mode::sync_fifo ? fall_back(url, settings, outcome, driver)
                                                                          : outcome;
  }
  SocketPair pair;
  if (Outcome outcome = make_socket_pair(pair); !outcome.ok()) {
    return outcome;
  }
  const std::uint64_t byte_time_ns = settings.mode == ftdi::Mode::serial ? 10'000'000'000 / settings.baud_hz : 0;
  auto made = std::make_unique<FtdiDriver>(std::move(port), std::move(pair), byte_time_ns, settings.event_told);
  made->begin();
  driver = std::move(made);
  return {};
}

}  // namespace unitylink
