// SPDX-License-Identifier: BSD-3-Clause
// One channel of an FTDI chip, claimed and set up. The driver moves its bytes through it.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "layer0_driver/ftdi_chip.hpp"
#include "layer0_driver/url.hpp"
#include "layer0_driver/usb_library.hpp"

namespace unitylink::ftdi {

enum class Mode { serial, fifo, sync_fifo };

struct Settings {
  std::string serial_number;  // "": any, if only one chip is plugged in
  unsigned channel = 0;
  Mode mode = Mode::serial;
  std::uint32_t baud_hz = 0;
  std::uint8_t latency_ms = 1;
  std::optional<std::uint8_t> event;
  bool event_told = false;  // the URL has event=, so the protocol does not change it
};

[[nodiscard]] Outcome settings_of(const Url& url, Settings& settings);

class Port {
 public:
  [[nodiscard]] static Outcome open(const Settings& settings, std::unique_ptr<Port>& port);
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;
  ~Port();

  [[nodiscard]] usb::Library& library() const noexcept { return *library_; }
  [[nodiscard]] usb::Context* context() const noexcept { return context_; }
  [[nodiscard]] usb::Handle* handle() const noexcept { return handle_; }
  [[nodiscard]] std::uint8_t in() const noexcept { return static_cast<std::uint8_t>(0x81 + 2 * channel_); }
  [[nodiscard]] std::uint8_t out() const noexcept { return static_cast<std::uint8_t>(0x02 + 2 * channel_); }
  // Sets the event character; nullopt: none. Returns a code of libusb.
  [[nodiscard]] int send_event(std::optional<std::uint8_t> event) noexcept;
  [[nodiscard]] std::size_t packet_bytes() const noexcept { return packet_bytes_; }

 private:
  explicit Port(std::shared_ptr<usb::Library> library) : library_(std::move(library)) {}
  [[nodiscard]] Outcome find(const std::string& serial_number, usb::Device** devices, std::size_t count);
  [[nodiscard]] Outcome set_up(const Settings& settings);
  [[nodiscard]] Outcome told(int code, const char* what) const;
  [[nodiscard]] Outcome request(Request request, std::uint16_t value, std::uint16_t index, const char* what);
  int transfer(Request request, std::uint16_t value, std::uint16_t index) noexcept;  // returns a code of libusb

  std::shared_ptr<usb::Library> library_;
  usb::Context* context_ = nullptr;
  usb::Handle* handle_ = nullptr;
  const Chip* chip_ = nullptr;
  unsigned channel_ = 0;
  std::size_t packet_bytes_ = 64;
  bool claimed_ = false;
  Mode mode_ = Mode::serial;
};

}  // namespace unitylink::ftdi
