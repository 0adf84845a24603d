// SPDX-License-Identifier: BSD-3-Clause
#include "layer0_driver/capture.hpp"

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "layer0_driver/descriptor.hpp"

namespace unitylink {
namespace {

constexpr std::size_t buffer_bytes = 1u << 18;
constexpr std::uint64_t flush_period_ns = 250'000'000;
constexpr std::size_t packet_overhead = 28 + 12 + 4;  // head, options, and the length at the end

constexpr std::uint32_t section_header = 0x0A0D0D0A, interface_description = 1, enhanced_packet = 6;
constexpr std::uint32_t byte_order_magic = 0x1A2B3C4D;
constexpr std::uint16_t link_type_user0 = 147;
constexpr std::uint16_t option_end = 0, option_comment = 1, option_application = 4, option_time_resolution = 9,
                        option_flags = 2;

constexpr std::size_t padded(std::size_t bytes) noexcept { return (bytes + 3) / 4 * 4; }

using Bytes = std::vector<std::uint8_t>;

template <class Integer>
void put(Bytes& to, Integer value) {
  for (unsigned shift = 0; shift < 8 * sizeof value; shift += 8) {
    to.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> shift));
  }
}

void put_option(Bytes& to, std::uint16_t code, std::string_view value) {
  put(to, code);
  put(to, static_cast<std::uint16_t>(value.size()));
  to.insert(to.end(), value.begin(), value.end());
  to.resize(padded(to.size()));
}

// Appends a block of this type with this body.
void put_block(Bytes& to, std::uint32_t type, const Bytes& body) {
  const auto length = static_cast<std::uint32_t>(body.size() + 12);
  put(to, type);
  put(to, length);
  to.insert(to.end(), body.begin(), body.end());
  put(to, length);
}

Bytes head(std::string_view comment) {
  Bytes file, body;
  put(body, byte_order_magic);
  put(body, std::uint16_t{1});  // version 1.0
  put(body, std::uint16_t{0});
  put(body, ~std::uint64_t{0});  // the length of the section is not given
  put_option(body, option_comment, comment.substr(0, 1024));
  put_option(body, option_application, "unitylink");
  put_option(body, option_end, {});
  put_block(file, section_header, body);
  body.clear();
  put(body, link_type_user0);
  put(body, std::uint16_t{0});
  put(body, std::uint32_t{0});                       // no limit: packets are stored whole
  put_option(body, option_time_resolution, "\x09");  // nanoseconds
  put_option(body, option_end, {});
  put_block(file, interface_description, body);
  return file;
}

}  // namespace

std::uint64_t Capture::now_ns() noexcept {
  return static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
          .count());
}

Outcome Capture::create(const std::string& path, std::string_view comment, std::unique_ptr<Capture>& capture) {
  // The same rule as output_file.py: a capture never replaces a file, and never follows a link to one. An existing pipe
  // or device is opened.
  struct stat there{};
  const bool stream = ::stat(path.c_str(), &there) == 0 && (S_ISFIFO(there.st_mode) || S_ISCHR(there.st_mode));
  const int descriptor =
      ::open(path.c_str(), stream ? O_WRONLY | O_CLOEXEC : O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor < 0 && errno == EEXIST) {
    return {Status::permission, "trace=" + path + ": this file exists already; name another one, or remove it"};
  }
  if (descriptor < 0) {
    const Status status = errno == EACCES || errno == EPERM || errno == EROFS ? Status::permission : Status::not_found;
    return {status, "trace=" + path + ": " + std::strerror(errno) + "; name a file in a folder that can be written"};
  }
  Descriptor opened(descriptor);
  capture.reset(new Capture(descriptor, path, !stream));
  opened.release();  // the capture owns it now
  capture->buffer_ = head(comment);
  capture->buffer_.reserve(buffer_bytes);
  capture->flush();  // so a full disk is reported now
  if (capture->error_ != 0) {
    return {Status::not_found, "trace=" + path + ": " + std::strerror(capture->error_)};
  }
  return {};
}

Capture::Capture(int descriptor, std::string path, bool made)
    : descriptor_(descriptor), path_(std::move(path)), made_(made) {}

Capture::~Capture() { close(); }

void Capture::add(std::uint64_t time_ns, Direction direction, std::span<const std::uint8_t> bytes) noexcept {
  const std::scoped_lock lock(mutex_);
  while (!bytes.empty() && descriptor_ >= 0 && error_ == 0) {
    const std::span<const std::uint8_t> piece = bytes.first(std::min(bytes.size(), buffer_bytes / 2));
    bytes = bytes.subspan(piece.size());
    empty_ = false;
    const std::size_t length = padded(piece.size()) + packet_overhead;
    if (buffer_.size() + length > buffer_bytes) {
      flush();
    }
    const auto count = static_cast<std::uint32_t>(piece.size());
    const std::array<std::uint32_t, 7> before = {enhanced_packet,
                                                 static_cast<std::uint32_t>(length),
                                                 0,
                                                 static_cast<std::uint32_t>(time_ns >> 32),
                                                 static_cast<std::uint32_t>(time_ns),
                                                 count,
                                                 count};
    const std::array<std::uint32_t, 4> behind = {option_flags | 4u << 16, static_cast<std::uint32_t>(direction),
                                                 option_end, static_cast<std::uint32_t>(length)};
    // The reserved memory is enough, so this allocates nothing. The file has the byte order of this machine; the
    // section header shows which.
    const std::size_t at = buffer_.size();
    buffer_.resize(at + length);
    std::memcpy(buffer_.data() + at, before.data(), sizeof before);
    std::memcpy(buffer_.data() + at + sizeof before, piece.data(), piece.size());
    std::memcpy(buffer_.data() + at + length - sizeof behind, behind.data(), sizeof behind);
  }
  if (time_ns - flushed_ns_ > flush_period_ns) {
    flush();
    flushed_ns_ = time_ns;
  }
}

void Capture::flush() noexcept {
  std::span<const std::uint8_t> rest(buffer_);
  while (!rest.empty() && error_ == 0) {
    const ssize_t count = ::write(descriptor_, rest.data(), rest.size());
    if (count > 0) {
      rest = rest.subspan(static_cast<std::size_t>(count));
    } else if (errno != EINTR) {
      error_ = count == 0 ? EIO : errno;
      const off_t whole = ::lseek(descriptor_, 0, SEEK_CUR) - static_cast<off_t>(buffer_.size() - rest.size());
      static_cast<void>(!::ftruncate(descriptor_, whole));  // the file must not end with half a packet
    }
  }
  buffer_.clear();
}

void Capture::close() noexcept {
  const std::scoped_lock lock(mutex_);
  if (descriptor_ >= 0) {
    flush();
    if (::close(descriptor_) != 0 && error_ == 0) {
      error_ = errno;
    }
    descriptor_ = -1;
  }
}

bool Capture::empty() const noexcept {
  const std::scoped_lock lock(mutex_);
  return empty_;
}

void Capture::discard() noexcept {
  close();
  if (made_) {
    ::unlink(path_.c_str());
  }
}

void Capture::disown() noexcept {
  new (&mutex_) std::mutex;  // the old one may be locked by a thread that does not exist in this process
  buffer_.clear();
  close();
}

std::string Capture::failure() const {
  const std::scoped_lock lock(mutex_);
  return error_ == 0 ? "" : "trace=" + path_ + " ends early: " + std::strerror(error_);
}

}  // namespace unitylink
