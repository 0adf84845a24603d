// SPDX-License-Identifier: BSD-3-Clause
// The part of libusb-1.0 that the FTDI driver uses, with one chip plugged in. FAKE_USB is `key=value` words with spaces
// between them:
//   port=5555     the board behind the chip: TCP on this machine
//   serial=FT1  release=0x0700 (bcdDevice)  packet=512
//   log=FILE      gets a line for each control request, and at the end the reasons why packets were sent
//   unplug=1000   after so many bytes from the board the chip is gone, in the middle of a transfer
//   refuse=-3     the result of opening the chip
//   claim=-6      the result of claiming a channel
//   take=100      most bytes that the chip takes in one transfer
#include <algorithm>
#include <arpa/inet.h>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <map>
#include <mutex>
#include <poll.h>
#include <sstream>
#include <string>
#include <sys/socket.h>
#include <unistd.h>

#include "layer0_driver/usb_library.hpp"

using namespace unitylink::usb;
using Clock = std::chrono::steady_clock;

namespace {

struct Chip {
  std::map<std::string, std::string> settings;
  std::mutex mutex;
  int board = -1;
  std::deque<std::uint8_t> gathered;  // bytes from the board for the PC
  std::deque<Transfer*> waiting;
  std::deque<Transfer*> cancelled;
  Clock::time_point last = Clock::now();
  std::size_t latency_ms = 16, passed = 0;
  int event = -1;
  std::size_t full = 0, by_event = 0, by_timer = 0;
  bool gone = false;

  long number(const char* key, long otherwise) {
    const auto found = settings.find(key);
    return found == settings.end() ? otherwise : std::strtol(found->second.c_str(), nullptr, 0);
  }
  void log(const std::string& line) {
    if (std::FILE* file = std::fopen(settings["log"].c_str(), "a"); file != nullptr) {
      std::fprintf(file, "%s\n", line.c_str());
      std::fclose(file);
    }
  }
};

Chip& chip() {
  static Chip one;
  return one;
}

void connect_board() {
  Chip& c = chip();
  c.board = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in place{};
  place.sin_family = AF_INET;
  place.sin_port = htons(static_cast<std::uint16_t>(c.number("port", 0)));
  place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(c.board, reinterpret_cast<sockaddr*>(&place), sizeof place) != 0) {
    ::close(c.board);
    c.board = -1;
  }
}

void gather() {
  Chip& c = chip();
  std::uint8_t bytes[4096];
  while (c.board >= 0 && c.gathered.size() < 4096) {  // the size of the chip's buffer; when it is full, the board waits
    const ssize_t count = ::recv(c.board, bytes, 4096 - c.gathered.size(), MSG_DONTWAIT);
    if (count <= 0) {
      return;
    }
    c.gathered.insert(c.gathered.end(), bytes, bytes + count);
  }
}

// Adds one packet to the transfer. True: the transfer is complete.
bool pack(Transfer& transfer, std::size_t count, std::size_t packet) {
  Chip& c = chip();
  unsigned char* const place = transfer.buffer + transfer.actual_length;
  place[0] = 0x31;  // modem status and line status of an FT2232H
  place[1] = 0x60;
  for (std::size_t n = 0; n < count; ++n) {
    place[2 + n] = c.gathered.front();
    c.gathered.pop_front();
  }
  c.passed += count;
  transfer.actual_length += static_cast<int>(count + 2);
  const long unplug = c.number("unplug", 0);
  if (unplug > 0 && c.passed >= static_cast<std::size_t>(unplug)) {
    c.gone = true;
  }
  return c.gone || count + 2 < packet || transfer.actual_length + static_cast<int>(packet) > transfer.length;
}

// The PC asks the chip for a packet. True: the first transfer is complete.
bool serve(Transfer& transfer) {
  Chip& c = chip();
  const auto packet = static_cast<std::size_t>(c.number("packet", 512));
  gather();
  while (true) {
    if (c.gathered.size() >= packet - 2) {
      ++c.full;
      c.last = Clock::now();
      if (pack(transfer, packet - 2, packet)) {
        return true;
      }
    } else if (c.event >= 0 && std::ranges::find(c.gathered, static_cast<std::uint8_t>(c.event)) != c.gathered.end()) {
      ++c.by_event;
      c.last = Clock::now();
      return pack(transfer, c.gathered.size(), packet);
    } else if (Clock::now() - c.last >= std::chrono::milliseconds(c.latency_ms)) {
      c.by_timer += c.gathered.empty() ? 0 : 1;
      c.last = Clock::now();
      return pack(transfer, c.gathered.size(), packet);
    } else {
      return false;
    }
  }
}

}  // namespace

extern "C" {

int libusb_init(Context** context) {
  Chip& c = chip();
  *context = reinterpret_cast<Context*>(3);
  const char* const told = std::getenv("FAKE_USB");
  std::istringstream words(told != nullptr ? told : "");
  for (std::string word; words >> word;) {
    c.settings[word.substr(0, word.find('='))] = word.substr(word.find('=') + 1);
  }
  return 0;
}
void libusb_exit(Context*) {
  Chip& c = chip();
  c.log("full " + std::to_string(c.full) + " event " + std::to_string(c.by_event) + " timer " +
        std::to_string(c.by_timer));
  c.waiting.clear();
  c.gathered.clear();
  c.full = c.by_event = c.by_timer = c.passed = 0;
  c.gone = false;
  ::close(c.board);
  c.board = -1;
}
std::intptr_t libusb_get_device_list(Context*, Device*** devices) {
  static Device* list[] = {reinterpret_cast<Device*>(1), nullptr};
  *devices = list;
  return chip().settings.contains("serial") ? 1 : 0;
}
void libusb_free_device_list(Device**, int) {}
int libusb_get_device_descriptor(Device*, DeviceDescriptor* told) {
  *told = {};
  told->idVendor = 0x0403;
  told->idProduct = 0x6010;
  told->bcdDevice = static_cast<std::uint16_t>(chip().number("release", 0x0700));
  told->iSerialNumber = 3;
  return 0;
}
int libusb_get_max_packet_size(Device*, unsigned char) { return static_cast<int>(chip().number("packet", 512)); }
int libusb_open(Device*, Handle** handle) {
  *handle = reinterpret_cast<Handle*>(2);
  return static_cast<int>(chip().number("refuse", 0));
}
void libusb_close(Handle*) {}
int libusb_get_string_descriptor_ascii(Handle*, std::uint8_t index, unsigned char* text, int length) {
  const std::string& serial = chip().settings["serial"];
  const auto count = std::min(serial.size(), static_cast<std::size_t>(length));
  std::memcpy(text, serial.data(), count);
  return index == 3 ? static_cast<int>(count) : -1;
}
int libusb_set_auto_detach_kernel_driver(Handle*, int) { return 0; }
int libusb_claim_interface(Handle*, int interface) {
  chip().log("claim " + std::to_string(interface));
  return static_cast<int>(chip().number("claim", 0));
}
int libusb_release_interface(Handle*, int interface) {
  chip().log("release " + std::to_string(interface));
  return 0;
}
int libusb_control_transfer(Handle*, std::uint8_t type, std::uint8_t request, std::uint16_t value, std::uint16_t index,
                            unsigned char*, std::uint16_t, unsigned int) {
  Chip& c = chip();
  const std::scoped_lock lock(c.mutex);
  char line[64];
  std::snprintf(line, sizeof line, "%02X %02X %04X %04X", type, request, value, index);
  c.log(line);
  if (request == 0x09) {
    c.latency_ms = value;
  } else if (request == 0x06) {
    c.event = (value & 0x100) != 0 ? value & 0xFF : -1;
  } else if (request == 0x00 && value == 2) {  // the last request of the set-up
    connect_board();
  }
  return c.gone ? error_no_device : 0;
}
int libusb_bulk_transfer(Handle*, unsigned char, unsigned char* bytes, int length, int* done, unsigned int) {
  Chip& c = chip();
  int board = -1;
  {
    const std::scoped_lock lock(c.mutex);
    *done = 0;
    if (c.gone) {
      return error_no_device;
    }
    board = c.board;
  }
  const auto most = static_cast<std::size_t>(c.number("take", length));
  const ssize_t count = ::send(board, bytes, std::min(most, static_cast<std::size_t>(length)), MSG_NOSIGNAL);
  *done = static_cast<int>(std::max<ssize_t>(count, 0));
  return *done == length ? 0 : error_timeout;
}
Transfer* libusb_alloc_transfer(int) { return new Transfer{}; }
void libusb_free_transfer(Transfer* transfer) { delete transfer; }
int libusb_submit_transfer(Transfer* transfer) {
  Chip& c = chip();
  const std::scoped_lock lock(c.mutex);
  if (c.gone) {
    return error_no_device;
  }
  transfer->actual_length = 0;
  c.waiting.push_back(transfer);
  return 0;
}
int libusb_cancel_transfer(Transfer* transfer) {
  Chip& c = chip();
  const std::scoped_lock lock(c.mutex);
  std::erase(c.waiting, transfer);
  c.cancelled.push_back(transfer);
  return 0;
}
int libusb_handle_events_timeout(Context*, Interval* patience) {
  Chip& c = chip();
  const auto until =
      Clock::now() + std::chrono::seconds(patience->seconds) + std::chrono::microseconds(patience->microseconds);
  while (true) {
    Transfer* over = nullptr;
    int board = -1;
    {
      const std::scoped_lock lock(c.mutex);
      if (!c.cancelled.empty()) {
        over = c.cancelled.front();
        c.cancelled.pop_front();
        over->status = TransferStatus::cancelled;
      } else if (!c.waiting.empty() && (c.gone || serve(*c.waiting.front()))) {
        over = c.waiting.front();
        c.waiting.pop_front();
        over->status = c.gone ? TransferStatus::no_device : TransferStatus::completed;
      }
      board = c.board;
    }
    if (over != nullptr) {
      over->callback(over);
      return 0;
    }
    if (Clock::now() >= until) {
      return 0;
    }
    pollfd waiting{board, POLLIN, 0};
    ::poll(&waiting, board >= 0 ? 1u : 0u, 1);
  }
}
const char* libusb_error_name(int code) {
  switch (code) {
    case error_access: return "LIBUSB_ERROR_ACCESS";
    case error_busy: return "LIBUSB_ERROR_BUSY";
    case error_no_device: return "LIBUSB_ERROR_NO_DEVICE";
    default: return "LIBUSB_ERROR_OTHER";
  }
}

}  // extern "C"
