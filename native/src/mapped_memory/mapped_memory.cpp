// SPDX-License-Identifier: BSD-3-Clause
#include "mapped_memory/mapped_memory.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

namespace unitylink {
namespace {

Outcome cannot(const std::string& path, const char* what) {
  const int number = errno;
  const std::string text = path + ": " + what + ": " + std::strerror(number);
  switch (number) {
    case ENOENT:
    case ENXIO: return {Status::not_found, text};
    case EACCES:
    case EPERM: return {Status::permission, text + "; you need the right to read and write it (a udev rule, or a group)"};
    case EBUSY: return {Status::busy, text};
    default: return {Status::mismatch, text};
  }
}

}  // namespace

Outcome MappedMemory::open(const std::string& path, std::uint64_t offset, std::uint64_t bytes, std::unique_ptr<MappedMemory>& memory) {
  const int descriptor = ::open(path.c_str(), O_RDWR | O_CLOEXEC | O_SYNC);
  if (descriptor < 0) {
    return cannot(path, "cannot be opened");
  }
  // Only whole pages can be mapped; the window may begin within one.
  const auto page = static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  const std::uint64_t within = offset % page;
  const auto length = static_cast<std::size_t>(within + bytes);
  void* mapping = ::mmap(nullptr, length, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, static_cast<off_t>(offset - within));
  const Outcome failed = mapping == MAP_FAILED ? cannot(path, "cannot be mapped") : Outcome{};
  ::close(descriptor);
  if (!failed.ok()) {
    return failed;
  }
  auto* base = reinterpret_cast<volatile std::uint32_t*>(static_cast<char*>(mapping) + within);
  memory.reset(new MappedMemory(mapping, length, base, static_cast<std::size_t>(bytes / sizeof(std::uint32_t))));
  return {};
}

Outcome MappedMemory::check(std::uint32_t address) const {
  if (base_ != nullptr && address < words_) [[likely]] {
    return {};
  }
  if (base_ == nullptr) {
    return {Status::closed, "the link is closed"};
  }
  char text[96];
  std::snprintf(text, sizeof text, "0x%04X is beyond the mapped memory, which has words 0 to 0x%04zX", address, words_ - 1);
  Outcome outcome{Status::bus_error, text};
  outcome.has_address = true;
  outcome.address = address;
  return outcome;
}

Outcome MappedMemory::read(std::uint32_t address, std::uint32_t& value) const {
  Outcome outcome = check(address);
  if (outcome.ok()) {
    value = base_[address];
  }
  return outcome;
}

Outcome MappedMemory::write(std::uint32_t address, std::uint32_t value) {
  Outcome outcome = check(address);
  if (outcome.ok()) {
    base_[address] = value;
  }
  return outcome;
}

Outcome MappedMemory::read_many(std::span<const std::uint32_t> addresses, std::span<std::uint32_t> values) const {
  for (const std::uint32_t address : addresses) {  // all or nothing: reading may do something
    if (Outcome outcome = check(address); !outcome.ok()) {
      return outcome;
    }
  }
  for (std::size_t index = 0; index < addresses.size(); ++index) {
    values[index] = base_[addresses[index]];
  }
  return {};
}

Outcome MappedMemory::read_settled(std::span<const std::uint32_t> addresses, std::span<std::uint32_t> values, std::size_t passes,
                                   bool& settled) const {
  Outcome outcome = read_many(addresses, values);
  settled = addresses.size() < 2;
  for (std::size_t pass = 1; outcome.ok() && !settled && pass < passes; ++pass) {
    settled = true;
    for (std::size_t index = 0; index < addresses.size(); ++index) {
      const std::uint32_t now = base_[addresses[index]];
      settled = settled && now == values[index];
      values[index] = now;
    }
  }
  return outcome;
}

void MappedMemory::close() noexcept {
  if (base_ != nullptr) {
    base_ = nullptr;
    ::munmap(mapping_, length_);
  }
}

}  // namespace unitylink
