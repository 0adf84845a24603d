// SPDX-License-Identifier: BSD-3-Clause
#include "device/component/bus_servo.hpp"

#include <algorithm>

namespace unitylink::device {

namespace {

constexpr std::uint8_t all_servos = 0xFE;
constexpr std::uint8_t write_to_many = 0x83;
constexpr std::uint8_t question = 0x02;
constexpr std::uint8_t status = 0x55;
constexpr std::size_t alarm_register = 255;
constexpr std::uint32_t bits_of_byte = 10;

std::uint32_t sum_of(const std::vector<std::uint8_t>& bytes, std::size_t count) noexcept {
  std::uint32_t sum = 0;
  for (std::size_t place = 2; place < count; ++place) {
    sum += bytes[place];
  }
  return ~sum & 0xFFu;
}

// The CRC-16 with the polynomial 8005.
std::uint32_t crc_of(const std::vector<std::uint8_t>& bytes, std::size_t count) noexcept {
  std::uint32_t crc = 0;
  for (std::size_t place = 0; place < count; ++place) {
    crc ^= static_cast<std::uint32_t>(bytes[place]) << 8;
    for (int bit = 0; bit < 8; ++bit) {
      crc = ((crc & 0x8000u) != 0 ? crc << 1 ^ 0x8005u : crc << 1) & 0xFFFFu;
    }
  }
  return crc;
}

}  // namespace

BusServo::BusServo(Pins& pins, std::uint32_t component, const ServoLines& lines, Clock now)
    : pins_(pins), component_(component), lines_(lines) {
  pins.output(component, lines.out, now)->watch([this](bool level, Clock state) { line(level, state); });
  pins.output(component, lines.enable, now)->watch([this](bool level, Clock state) { enable(level, state); });
}

void BusServo::line(bool level, Clock state) {
  read_until(static_cast<double>(state));
  if (begun_ < 0 && !level) {
    begun_ = static_cast<double>(state);
    place_ = 0;
  }
  level_ = level;
}

// The bits whose middle is before `time` have the level of the line.
void BusServo::read_until(double time) {
  while (begun_ >= 0 && begun_ + (place_ + 0.5) * lines_.bit < time) {
    if (place_ >= 1 && place_ <= 8) {
      byte_ = byte_ >> 1 | (level_ ? 0x80u : 0u);
    }
    if (++place_ == bits_of_byte) {
      packet_.push_back(static_cast<std::uint8_t>(byte_));
      begun_ = -1;
    }
  }
}

void BusServo::enable(bool level, Clock state) {
  if (level) {
    packet_.clear();
  } else {
    read_until(static_cast<double>(state));
    heard(state);
  }
}

void BusServo::heard(Clock ended) {
  const std::size_t count = packet_.size();
  const std::size_t first = lines_.feetech ? 4 : 7;  // the place of the instruction
  const std::size_t check = lines_.feetech ? 1 : 2;
  if (!plugged || count < first + check + 1) {
    return;
  }
  const std::uint32_t found = packet_[count - check] | (lines_.feetech ? 0u : packet_[count - 1] * 256u);
  const std::uint32_t right = lines_.feetech ? sum_of(packet_, count - 1) : crc_of(packet_, count - 2);
  const std::uint8_t to = packet_[lines_.feetech ? 2 : 4];
  packet_.resize(count - check);
  if (found != right) {
    return;
  }
  if (to == all_servos && packet_[first] == write_to_many) {
    write(first);
  } else if (to == lines_.id && packet_[first] == question) {
    answer(first, ended);
  }
}

// The register, the number of bytes, and then an id and bytes for each servo. Dynamixel has two bytes for each number.
void BusServo::write(std::size_t first) {
  const std::size_t width = lines_.feetech ? 1 : 2;
  if (packet_.size() < first + 1 + 2 * width) {
    return;
  }
  const std::size_t at = packet_[first + 1];
  const std::size_t size = packet_[first + 1 + width];
  for (std::size_t place = first + 1 + 2 * width; place + size < packet_.size(); place += size + 1) {
    if (packet_[place] == lines_.id && at + size <= registers.size()) {
      std::copy_n(packet_.begin() + static_cast<std::ptrdiff_t>(place) + 1, size,
                  registers.begin() + static_cast<std::ptrdiff_t>(at));
    }
  }
}

void BusServo::answer(std::size_t first, Clock ended) {
  const std::size_t width = lines_.feetech ? 1 : 2;
  if (packet_.size() < first + 1 + 2 * width) {
    return;
  }
  const std::size_t from = packet_[first + 1];
  const std::size_t size = packet_[first + 1 + width];
  std::vector<std::uint8_t> reply{0xFF, 0xFF};
  if (lines_.feetech) {
    reply.insert(reply.end(), {lines_.id, static_cast<std::uint8_t>(size + 2), registers[alarm_register]});
  } else {
    reply.insert(reply.end(),
                 {0xFD, 0, lines_.id, static_cast<std::uint8_t>(size + 4), 0, status, registers[alarm_register]});
  }
  for (std::size_t place = from; place < std::min(from + size, registers.size()); ++place) {
    reply.push_back(registers[place]);
    const std::size_t end = reply.size();
    if (!lines_.feetech && reply[end - 3] == 0xFF && reply[end - 2] == 0xFF && reply[end - 1] == 0xFD) {
      reply.push_back(0xFD);  // so that nobody takes it for a header
      ++reply[5];
    }
  }
  if (lines_.feetech) {
    reply.push_back(static_cast<std::uint8_t>(sum_of(reply, reply.size())));
  } else {
    const std::uint32_t crc = crc_of(reply, reply.size());
    reply.push_back(static_cast<std::uint8_t>(crc));
    reply.push_back(static_cast<std::uint8_t>(crc >> 8));
  }
  const double start = static_cast<double>(ended) + lines_.answer;
  bool before = true;
  for (std::size_t number = 0; number < reply.size() * bits_of_byte; ++number) {
    const std::size_t place = number % bits_of_byte;
    const bool level = place == 9 || (place > 0 && (reply[number / bits_of_byte] >> (place - 1) & 1u) != 0);
    if (level != before) {
      const double at = start + static_cast<double>(number) * lines_.bit;
      pins_.drive_at(component_, lines_.in, level, static_cast<Clock>(at));
    }
    before = level;
  }
}

}  // namespace unitylink::device
