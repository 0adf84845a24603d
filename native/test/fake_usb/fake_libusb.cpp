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
// FAKE_USB_FAIL=n: the n-th of the calls since libusb_init, which is the first, fails. Each call reads it again. Events
// and closing never fail. A call without memory fails like one of libusb.
#include <algorithm>
#include <arpa/inet.h>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <poll.h>
#include <sstream>
#include <string>
#include <sys/socket.h>
#include <unistd.h>
#include <vector>

#include "layer0_driver/usb_library.hpp"

using namespace unitylink::usb;
using Clock = std::chrono::steady_clock;

namespace {

constexpr std::size_t gathered_most = 4096;  // the chip's buffer; when it is full, the board waits
constexpr std::size_t transfers_most = 16;

struct Chip {
  std::map<std::string, std::string> settings;
  std::mutex mutex;
  int board = -1;
  std::vector<std::uint8_t> gathered;  // bytes from the board for the PC
  std::vector<Transfer*> waiting;
  std::vector<Transfer*> cancelled;
  Clock::time_point last = Clock::now();
  std::size_t latency_ms = 16, passed = 0;
  int event = -1;
  std::size_t full = 0, by_event = 0, by_timer = 0;
  bool gone = false;
  std::atomic<long> calls = 0;  // since libusb_init
  std::atomic<int> held = 0;    // contexts, lists, handles, claims and transfers that were not given back

  Chip() {  // all memory that events need
    gathered.reserve(gathered_most);
    waiting.reserve(transfers_most);
    cancelled.reserve(transfers_most);
  }
  long number(const char* key, long otherwise) {
    const auto found = settings.find(key);
    return found == settings.end() ? otherwise : std::strtol(found->second.c_str(), nullptr, 0);
  }
  template <class... Values>
  void log(const char* format, Values... values) {
    const auto place = settings.find("log");
    std::FILE* const file = place == settings.end() ? nullptr : std::fopen(place->second.c_str(), "a");
    if (file != nullptr) {
      std::fprintf(file, format, values...);
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
  std::uint8_t bytes[gathered_most];
  while (c.board >= 0 && c.gathered.size() < gathered_most) {
    const ssize_t count = ::recv(c.board, bytes, gathered_most - c.gathered.size(), MSG_DONTWAIT);
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
  std::copy_n(c.gathered.begin(), count, place + 2);
  c.gathered.erase(c.gathered.begin(), c.gathered.begin() + static_cast<std::ptrdiff_t>(count));
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

// Whether this call must fail.
bool fails() {
  const char* const nth = std::getenv("FAKE_USB_FAIL");
  return ++chip().calls == (nth != nullptr ? std::strtol(nth, nullptr, 0) : 0);
}

// Runs a call, and returns its code. `first`: the calls are counted from this one on.
template <class Call>
int guarded(const Call& call, bool first = false) noexcept {
  try {
    if (first) {
      chip().calls = 0;
    }
    return fails() ? error_io : call();
  } catch (const std::bad_alloc&) {
    return error_no_memory;
  }
}

}  // namespace

extern "C" {

// How much the program has not given back yet.
int fake_usb_held() { return chip().held; }

int libusb_init(Context** context) {
  return guarded(
      [&] {
        Chip& c = chip();
        const char* const told = std::getenv("FAKE_USB");
        std::istringstream words(told != nullptr ? told : "");
        for (std::string word; words >> word;) {
          c.settings[word.substr(0, word.find('='))] = word.substr(word.find('=') + 1);
        }
        *context = reinterpret_cast<Context*>(3);
        ++c.held;
        return 0;
      },
      true);
}
void libusb_exit(Context*) {
  Chip& c = chip();
  --c.held;
  c.log("full %zu event %zu timer %zu\n", c.full, c.by_event, c.by_timer);
  c.waiting.clear();
  c.gathered.clear();
  c.full = c.by_event = c.by_timer = c.passed = 0;
  c.gone = false;
  ::close(c.board);
  c.board = -1;
}
std::intptr_t libusb_get_device_list(Context*, Device*** devices) {
  return guarded([&] {
    static Device* list[] = {reinterpret_cast<Device*>(1), nullptr};
    *devices = list;
    ++chip().held;
    return chip().settings.contains("serial") ? 1 : 0;
  });
}
void libusb_free_device_list(Device**, int) { --chip().held; }
int libusb_get_device_descriptor(Device*, DeviceDescriptor* told) {
  return guarded([&] {
    *told = {};
    told->idVendor = 0x0403;
    told->idProduct = 0x6010;
    told->bcdDevice = static_cast<std::uint16_t>(chip().number("release", 0x0700));
    told->iSerialNumber = 3;
    return 0;
  });
}
int libusb_get_max_packet_size(Device*, unsigned char) { return static_cast<int>(chip().number("packet", 512)); }
int libusb_open(Device*, Handle** handle) {
  return guarded([&] {
    const auto code = static_cast<int>(chip().number("refuse", 0));
    *handle = reinterpret_cast<Handle*>(2);
    chip().held += code == 0 ? 1 : 0;
    return code;
  });
}
void libusb_close(Handle*) { --chip().held; }
int libusb_get_string_descriptor_ascii(Handle*, std::uint8_t index, unsigned char* text, int length) {
  return guarded([&] {
    const std::string& serial = chip().settings["serial"];
    const auto count = std::min(serial.size(), static_cast<std::size_t>(length));
    std::memcpy(text, serial.data(), count);
    return index == 3 ? static_cast<int>(count) : error_io;
  });
}
int libusb_set_auto_detach_kernel_driver(Handle*, int) { return 0; }
int libusb_claim_interface(Handle*, int interface) {
  return guarded([&] {
    chip().log("claim %d\n", interface);
    const auto code = static_cast<int>(chip().number("claim", 0));
    chip().held += code == 0 ? 1 : 0;
    return code;
  });
}
int libusb_release_interface(Handle*, int interface) {
  chip().log("release %d\n", interface);
  --chip().held;
  return 0;
}
int libusb_control_transfer(Handle*, std::uint8_t type, std::uint8_t request, std::uint16_t value, std::uint16_t index,
                            unsigned char*, std::uint16_t, unsigned int) {
  return guarded([&] {
    Chip& c = chip();
    const std::scoped_lock lock(c.mutex);
    c.log("%02X %02X %04X %04X\n", type, request, value, index);
    if (request == 0x09) {
      c.latency_ms = value;
    } else if (request == 0x06) {
      c.event = (value & 0x100) != 0 ? value & 0xFF : -1;
    } else if (request == 0x00 && value == 2) {  // the last request of the set-up
      connect_board();
    }
    return c.gone ? static_cast<int>(error_no_device) : 0;
  });
}
int libusb_bulk_transfer(Handle*, unsigned char, unsigned char* bytes, int length, int* done, unsigned int) {
  Chip& c = chip();
  int board = -1;
  {
    const std::scoped_lock lock(c.mutex);
    *done = 0;
    if (fails()) {
      return error_io;
    }
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
Transfer* libusb_alloc_transfer(int) {
  auto* const transfer = fails() ? nullptr : static_cast<Transfer*>(std::calloc(1, sizeof(Transfer)));
  chip().held += transfer != nullptr ? 1 : 0;
  return transfer;
}
void libusb_free_transfer(Transfer* transfer) {
  chip().held -= transfer != nullptr ? 1 : 0;
  std::free(transfer);
}
int libusb_submit_transfer(Transfer* transfer) {
  return guarded([&] {
    Chip& c = chip();
    const std::scoped_lock lock(c.mutex);
    if (c.gone) {
      return static_cast<int>(error_no_device);
    }
    transfer->actual_length = 0;
    c.waiting.push_back(transfer);
    return 0;
  });
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
        c.cancelled.erase(c.cancelled.begin());
        over->status = TransferStatus::cancelled;
      } else if (!c.waiting.empty() && (c.gone || serve(*c.waiting.front()))) {
        over = c.waiting.front();
        c.waiting.erase(c.waiting.begin());
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
    case error_io: return "LIBUSB_ERROR_IO";
    case error_no_memory: return "LIBUSB_ERROR_NO_MEM";
    default: return "LIBUSB_ERROR_OTHER";
  }
}

}  // extern "C"
