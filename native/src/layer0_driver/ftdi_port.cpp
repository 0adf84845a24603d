// SPDX-License-Identifier: BSD-3-Clause
#include "layer0_driver/ftdi_port.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <new>

#include "layer0_driver/serial_driver.hpp"

namespace unitylink::ftdi {
namespace {

constexpr unsigned int control_timeout_ms = 1000;
constexpr double baud_error_most = 0.03;  // a receiver tolerates this
constexpr std::array<std::uint16_t, 5> products{0x6001, 0x6010, 0x6011, 0x6014, 0x6015};

Outcome refused(const usb::Library& library, int code, const std::string& what) {
  const std::string text = what + ": " + library.error_name(code);
  switch (code) {
    case usb::error_access:
      return {Status::permission,
              text + "; you need the right to use the USB device: `unitylink doctor` shows the udev rule"};
    case usb::error_busy: return {Status::busy, text + "; another program holds it"};
    case usb::error_no_memory: throw std::bad_alloc();
    case usb::error_no_device: return {Status::not_found, text + "; it was unplugged"};
    default: return {Status::closed, text};
  }
}

}  // namespace

Outcome settings_of(const Url& url, Settings& settings) {
  settings = {};
  settings.serial_number = url.path;
  settings.baud_hz = default_baud_hz;
  settings.event = std::uint8_t{'\n'};
  std::uint64_t number = 0;
  if (const std::string* text = url.option("channel"); text != nullptr) {
    if (text->size() != 1 || (*text)[0] < 'A' || (*text)[0] > 'D') {
      return wrong_url(url, "channel=" + *text + " is not one of A, B, C, D");
    }
    settings.channel = static_cast<unsigned>((*text)[0] - 'A');
  }
  if (const std::string* text = url.option("mode"); text != nullptr) {
    if (*text == "fifo") {
      settings.mode = Mode::fifo;
    } else if (*text == "sync-fifo") {
      settings.mode = Mode::sync_fifo;
    } else if (*text != "serial") {
      return wrong_url(url, "mode=" + *text + " is not one of serial, fifo, sync-fifo");
    }
  }
  if (const std::string* text = url.option("baud"); text != nullptr) {
    if (settings.mode != Mode::serial) {
      return wrong_url(url, "a FIFO has no baud rate: leave baud= out");
    }
    if (!parse_number(*text, 0xFFFFFFFFu, number) || number < 300) {
      return wrong_url(url, "baud=" + *text + " is not a baud rate such as 3000000");
    }
    settings.baud_hz = static_cast<std::uint32_t>(number);
  }
  if (const std::string* text = url.option("latency"); text != nullptr) {
    if (!parse_number(*text, 255, number) || number == 0) {
      return wrong_url(url, "latency=" + *text + " is not 1 to 255 ms");
    }
    settings.latency_ms = static_cast<std::uint8_t>(number);
  }
  if (const std::string* text = url.option("event"); text != nullptr) {
    settings.event.reset();
    settings.event_told = true;
    if (*text != "none") {
      if (!parse_number(*text, 255, number)) {
        return wrong_url(url, "event=" + *text + " is not a character such as 0x0A, nor none");
      }
      settings.event = static_cast<std::uint8_t>(number);
    }
  }
  return {};
}

Outcome Port::open(const Settings& settings, std::unique_ptr<Port>& port) {
  std::shared_ptr<usb::Library> library;
  if (Outcome outcome = usb::Library::load(library); !outcome.ok()) {
    return outcome;
  }
  std::unique_ptr<Port> made(new Port(std::move(library)));
  usb::Library& usb = *made->library_;
  if (const int code = usb.init(&made->context_); code != 0) {
    made->context_ = nullptr;
    return refused(usb, code, "USB cannot be used");
  }
  usb::Device** devices = nullptr;
  const std::intptr_t count = usb.get_device_list(made->context_, &devices);
  if (count < 0) {
    return refused(usb, static_cast<int>(count), "USB devices cannot be listed");
  }
  const auto free_list = [&usb](usb::Device** list) { usb.free_device_list(list, 1); };
  const std::unique_ptr<usb::Device*, decltype(free_list)> list(devices, free_list);
  Outcome outcome = made->find(settings.serial_number, devices, static_cast<std::size_t>(count));
  if (outcome.ok()) {
    outcome = made->set_up(settings);
  }
  if (outcome.ok()) {
    port = std::move(made);
  }
  return outcome;
}

// Opens the chip with this serial number, or the only one.
Outcome Port::find(const std::string& serial_number, usb::Device** devices, std::size_t count) {
  std::string there;
  std::size_t found = 0;
  int code = 0;
  const auto close = [this](usb::Handle* handle) { library_->close(handle); };
  for (std::size_t index = 0; index < count; ++index) {
    usb::DeviceDescriptor told{};
    usb::Handle* handle = nullptr;
    const bool known = library_->get_device_descriptor(devices[index], &told) == 0 && told.idVendor == vendor &&
                       std::ranges::find(products, told.idProduct) != products.end();
    if (!known) {
      continue;
    }
    if (const int failed = library_->open(devices[index], &handle); failed != 0) {
      code = failed;
      continue;
    }
    std::unique_ptr<usb::Handle, decltype(close)> opened(handle, close);
    std::array<unsigned char, 256> text{};
    const int length = library_->get_string_descriptor_ascii(handle, told.iSerialNumber, text.data(),
                                                             static_cast<int>(text.size() - 1));
    const std::string serial(reinterpret_cast<const char*>(text.data()),
                             length > 0 ? static_cast<std::size_t>(length) : 0);
    there += (there.empty() ? "" : ", ") + (serial.empty() ? "one without a serial number" : serial);
    if ((serial_number.empty() || serial == serial_number) && handle_ == nullptr) {
      handle_ = opened.release();
      chip_ = chip_of(told.bcdDevice);
      packet_bytes_ = static_cast<std::size_t>(std::max(library_->get_max_packet_size(devices[index], in()), 8));
    }
    ++found;
  }
  if (handle_ != nullptr && serial_number.empty() && found > 1) {
    return {Status::bad_url, "there are several FTDI chips: say which, as in ftdi:SERIAL; there are: " + there};
  }
  if (handle_ == nullptr && code != 0) {
    return refused(*library_, code, "the FTDI chip cannot be opened");
  }
  if (handle_ == nullptr) {
    const std::string which = serial_number.empty() ? "FTDI chip" : "FTDI chip with the serial number " + serial_number;
    return {Status::not_found, "no " + which + " is plugged in" + (there.empty() ? "" : "; there are: " + there)};
  }
  return {};
}

Outcome Port::set_up(const Settings& settings) {
  if (chip_ == nullptr) {
    return {Status::mismatch, "this FTDI chip is not known; use the kernel's serial port"};
  }
  const std::string name(chip_->name);
  if (settings.channel >= chip_->channels) {
    return {Status::bad_url, "a " + name + " has " + std::to_string(chip_->channels) +
                                 " channel(s), and channel=" + static_cast<char>('A' + settings.channel) + " is asked"};
  }
  if (settings.mode == Mode::sync_fifo && (!chip_->sync_fifo || settings.channel != 0)) {
    return {Status::mismatch, "the synchronous FIFO is on channel A of an FT232H or FT2232H; this is channel " +
                                  std::string(1, static_cast<char>('A' + settings.channel)) + " of an " + name};
  }
  channel_ = settings.channel;
  mode_ = settings.mode;
  const Divisor divisor = divisor_of(*chip_, settings.baud_hz);
  const double error = std::abs(static_cast<double>(divisor.baud_hz) / settings.baud_hz - 1);
  if (mode_ == Mode::serial && error > baud_error_most) {
    return {Status::bad_url, "baud=" + std::to_string(settings.baud_hz) + ": the nearest that an " + name + " can is " +
                                 std::to_string(divisor.baud_hz)};
  }
  library_->set_auto_detach_kernel_driver(handle_, 1);  // the kernel's driver returns when the interface is released
  if (const int code = library_->claim_interface(handle_, static_cast<int>(channel_)); code != 0) {
    return refused(
        *library_, code,
        "channel " + std::string(1, static_cast<char>('A' + channel_)) + " of the " + name + " cannot be had");
  }
  claimed_ = true;
  Outcome outcome = request(Request::reset, 0, 0, "reset");
  const auto then = [&](Request what, std::uint16_t value, std::uint16_t index, const char* text) {
    if (outcome.ok()) {
      outcome = request(what, value, index, text);
    }
  };
  then(Request::bit_mode, mode_reset, 0, "bit mode");
  then(Request::latency_timer, settings.latency_ms, 0, "latency timer");
  if (outcome.ok()) {
    outcome = told(send_event(settings.event), "event character");
  }
  if (mode_ == Mode::serial) {
    then(Request::baud_rate, divisor.value, divisor.index, "baud rate");
    then(Request::data_format, format_8n1, 0, "data format");
    then(Request::flow_control, 0, 0, "flow control");
  } else if (mode_ == Mode::sync_fifo) {
    then(Request::bit_mode, mode_sync_fifo, 0, "synchronous FIFO");
    then(Request::flow_control, 0, flow_rts_cts, "flow control");
  }
  then(Request::reset, 1, 0, "purge");
  then(Request::reset, 2, 0, "purge");
  return outcome;
}

int Port::send_event(std::optional<std::uint8_t> event) noexcept {
  const auto value = event ? static_cast<std::uint16_t>(*event | event_enabled) : std::uint16_t{0};
  return transfer(Request::event_character, value, 0);
}

Outcome Port::request(Request request, std::uint16_t value, std::uint16_t index, const char* what) {
  return told(transfer(request, value, index), what);
}

Outcome Port::told(int code, const char* what) const {
  return code < 0
             ? refused(*library_, code, std::string(what) + " of the " + std::string(chip_->name) + " cannot be set")
             : Outcome{};
}

int Port::transfer(Request request, std::uint16_t value, std::uint16_t index) noexcept {
  const unsigned channel = chip_->channels > 1 ? channel_ + 1 : 0;
  return library_->control_transfer(handle_, request_type, static_cast<std::uint8_t>(request), value,
                                    static_cast<std::uint16_t>(index | channel), nullptr, 0, control_timeout_ms);
}

Port::~Port() {
  if (claimed_) {
    if (mode_ == Mode::sync_fifo) {  // the next program may need another mode
      transfer(Request::bit_mode, mode_reset, 0);
    }
    library_->release_interface(handle_, static_cast<int>(channel_));
  }
  if (handle_ != nullptr) {
    library_->close(handle_);
  }
  if (context_ != nullptr) {
    library_->exit(context_);
  }
}

}  // namespace unitylink::ftdi
