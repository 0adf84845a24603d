// SPDX-License-Identifier: BSD-3-Clause
// Registers that are memory of this machine. This driver sends no bytes: MappedEngine (layer2_message) accesses the
// memory.
//   mmap:/dev/uio0     mmap:/dev/mem?offset=0x43C00000&size=65536     mmap:registers.bin
// Options, with their defaults:
//   offset=         (0) in bytes
//   size=           in bytes; by default all of a file, a BAR or a map of a UIO device
//   address_bytes=  by default as many as the window needs
//   base_hz=        (1000)
#include <bit>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sys/stat.h>
#include <unistd.h>

#include "layer0_driver/driver.hpp"
#include "layer0_driver/mapped_memory.hpp"
#include "unitylink/protocol.hpp"

namespace unitylink {
namespace {

constexpr std::uint64_t word_bytes = 4;
constexpr std::uint64_t window_bytes_most = word_bytes << 32;

class MmapDriver final : public Driver {
 public:
  explicit MmapDriver(std::unique_ptr<MappedMemory> memory) noexcept : memory_(std::move(memory)) {}

  [[nodiscard]] MappedMemory* memory() noexcept override { return memory_.get(); }
  [[nodiscard]] Transfer send(std::span<const std::uint8_t>) noexcept override { return {0, Status::closed}; }
  [[nodiscard]] Transfer receive(std::span<std::uint8_t>) noexcept override { return {0, Status::closed}; }
  void close() noexcept override { memory_->close(); }
  void disown() noexcept override { memory_->close(); }
  [[nodiscard]] int descriptor() const noexcept override { return -1; }
  [[nodiscard]] std::string reason() const override { return "memory has no bytes to send"; }

 private:
  std::unique_ptr<MappedMemory> memory_;
};

// Without this option in the URL, `value` is not changed.
Outcome number_of(const Url& url, const char* name, std::uint64_t& value) {
  const std::string* const text = url.option(name);
  const bool whole = text == nullptr || parse_number(*text, ~std::uint64_t{0} >> 1, value);
  return whole ? Outcome{} : wrong_url(url, std::string(name) + "=" + *text + " is not a whole number from 0 on");
}

// The size of a regular file. A device has no size here: `known` is false.
Outcome file_bytes(const std::string& path, std::uint64_t& bytes, bool& known) {
  struct stat status{};
  if (::stat(path.c_str(), &status) != 0) {
    const int error = errno;
    return error == ENOENT || error == ENOTDIR ? Outcome{Status::not_found, path + ": there is no such device or file"}
           : error == EACCES                   ? Outcome{Status::permission, path + ": " + std::strerror(error)}
                                               : Outcome{Status::not_found, path + ": " + std::strerror(error)};
  }
  known = S_ISREG(status.st_mode);
  bytes = known ? static_cast<std::uint64_t>(status.st_size) : 0;
  return {};
}

// The size of map n of a UIO device. (An offset of n pages selects map n.) False: the device does not report it.
bool uio_bytes(const std::string& path, std::uint64_t map, std::uint64_t& bytes) {
  std::ifstream told("/sys/class/uio/" + path.substr(std::strlen("/dev/")) + "/maps/map" + std::to_string(map) +
                     "/size");
  std::string text;
  return std::getline(told, text) && parse_number(text, window_bytes_most, bytes);
}

// The number of bytes from `offset` on, if the system knows it.
Outcome size_of(const Url& url, std::uint64_t offset, std::uint64_t& size) {
  std::uint64_t bytes = 0;
  bool known = false;
  if (Outcome outcome = file_bytes(url.path, bytes, known); !outcome.ok()) {
    return outcome;
  }
  if (url.path.starts_with("/dev/uio")) {
    const std::uint64_t map = offset / static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
    return uio_bytes(url.path, map, size)
               ? Outcome{}
               : wrong_url(url, url.path + " does not report the size of map " + std::to_string(map) + ": add size=");
  }
  if (!known) {
    return wrong_url(url, url.path + " does not report its size: add size= in bytes");
  }
  if (bytes <= offset) {
    return wrong_url(url,
                     url.path + " has " + std::to_string(bytes) + " bytes, and offset is " + std::to_string(offset));
  }
  size = bytes - offset;
  return {};
}

Outcome window_of(const Url& url, MappedWindow& window) {
  window.path = url.path;
  for (const auto& [name, value] : {std::pair{"offset", &window.offset}, std::pair{"size", &window.bytes}}) {
    if (Outcome outcome = number_of(url, name, *value); !outcome.ok()) {
      return outcome;
    }
  }
  const bool size_given = url.option("size") != nullptr;
  if (!size_given) {  // then the window ends where the file ends
    if (Outcome outcome = size_of(url, window.offset, window.bytes); !outcome.ok()) {
      return outcome;
    }
  }
  for (const auto& [name, value] : {std::pair{"offset", window.offset}, std::pair{"size", window.bytes}}) {
    if (value % word_bytes != 0) {
      return wrong_url(url,
                       std::string(name) + " " + std::to_string(value) + " is no multiple of 4: words are 32 bits");
    }
  }
  if (window.bytes == 0 || window.bytes > window_bytes_most) {
    return wrong_url(url, "size is " + std::to_string(window.bytes) + " bytes; a window has 4 bytes to 16 GiB");
  }
  std::uint64_t there = 0;
  bool known = false;
  if (size_given) {
    if (Outcome outcome = file_bytes(url.path, there, known); !outcome.ok()) {
      return outcome;
    }
  }
  // an access beyond the end of a file would end the program
  if (const std::uint64_t end = window.offset + window.bytes; known && end > there) {
    return wrong_url(
        url, "the window ends at byte " + std::to_string(end) + ", and " + url.path + " has " + std::to_string(there));
  }
  const auto bits = static_cast<std::uint64_t>(std::bit_width(window.bytes / word_bytes - 1));
  std::uint64_t address_bytes = bits <= 8 ? 1 : (bits + 7) / 8;
  std::uint64_t base_hz = protocol::limits::base_hz_default;
  for (const auto& [name, value] : {std::pair{"address_bytes", &address_bytes}, std::pair{"base_hz", &base_hz}}) {
    if (Outcome outcome = number_of(url, name, *value); !outcome.ok()) {
      return outcome;
    }
  }
  if (address_bytes < 1 || address_bytes > 4) {
    return wrong_url(url, "address_bytes is " + std::to_string(address_bytes) + "; choose 1 to 4");
  }
  if (base_hz < 1 || base_hz > 0xFFFFFFFFu) {
    return wrong_url(url, "base_hz is " + std::to_string(base_hz) + "; choose 1 to 4294967295");
  }
  window.address_bytes = static_cast<std::uint32_t>(address_bytes);
  window.base_hz = static_cast<std::uint32_t>(base_hz);
  return {};
}

}  // namespace

Outcome open_mmap(const Url& url, const Patience&, std::unique_ptr<Driver>& driver) {
  MappedWindow window;
  if (Outcome outcome = window_of(url, window); !outcome.ok()) {
    return outcome;
  }
  std::unique_ptr<MappedMemory> memory;
  if (Outcome outcome = MappedMemory::open(window, memory); !outcome.ok()) {
    return outcome;
  }
  driver = std::make_unique<MmapDriver>(std::move(memory));
  return {};
}

}  // namespace unitylink
