// SPDX-License-Identifier: BSD-3-Clause
#include "layer0_driver/mapped_memory.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>
#include <utility>

#include "layer0_driver/descriptor.hpp"

namespace unitylink {
namespace {

Outcome cannot(const std::string& path, const char* what) {
  const int number = errno;
  const std::string text = path + ": " + what + ": " + std::strerror(number);
  switch (number) {
    case ENOENT:
    case ENXIO: return {Status::not_found, text};
    case EACCES:
    case EPERM:
      return {Status::permission, text + "; you need the right to read and write it (a udev rule, or a group)"};
    case EBUSY: return {Status::busy, text};
    default: return {Status::mismatch, text};
  }
}

}  // namespace

Outcome MappedMemory::open(const MappedWindow& window, std::unique_ptr<MappedMemory>& memory) {
  const std::string& path = window.path;
  const Descriptor file(::open(path.c_str(), O_RDWR | O_CLOEXEC | O_SYNC));
  if (!file.open()) {
    return cannot(path, "cannot be opened");
  }
  // Only whole pages can be mapped, but the window may begin inside a page.
  const auto page = static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  const std::uint64_t within = window.offset % page;
  std::unique_ptr<MappedMemory> made(new MappedMemory(window, static_cast<std::size_t>(within + window.bytes)));
  void* const mapping = ::mmap(nullptr, made->length_, PROT_READ | PROT_WRITE, MAP_SHARED, file.get(),
                               static_cast<off_t>(window.offset - within));
  if (mapping == MAP_FAILED) {
    return cannot(path, "cannot be mapped");
  }
  made->mapping_ = mapping;
  made->base_ = reinterpret_cast<volatile std::uint32_t*>(static_cast<char*>(mapping) + within);
  made->words_ = window.bytes / sizeof(std::uint32_t);
  memory = std::move(made);
  return {};
}

std::string MappedMemory::beyond(std::uint32_t address) const {
  char text[96];
  std::snprintf(text, sizeof text, "0x%04X is beyond the mapped memory, which has words 0 to 0x%04llX", address,
                static_cast<unsigned long long>(window_.bytes / sizeof(std::uint32_t) - 1));
  return text;
}

void MappedMemory::load(std::span<const std::uint32_t> addresses, std::span<std::uint32_t> values) const noexcept {
  for (std::size_t index = 0; index < addresses.size(); ++index) {
    values[index] = base_[addresses[index]];
  }
}

bool MappedMemory::settle(std::span<const std::uint32_t> addresses, std::span<std::uint32_t> values,
                          std::size_t passes) const noexcept {
  bool settled = addresses.size() < 2;
  for (std::size_t pass = 1; !settled && pass < passes; ++pass) {
    settled = true;
    for (std::size_t index = 0; index < addresses.size(); ++index) {
      const std::uint32_t now = base_[addresses[index]];
      settled = settled && now == values[index];
      values[index] = now;
    }
  }
  return settled;
}

void MappedMemory::close() noexcept {
  if (base_ != nullptr) {
    base_ = nullptr;
    words_ = 0;
    ::munmap(mapping_, length_);
  }
}

}  // namespace unitylink
