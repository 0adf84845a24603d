// SPDX-License-Identifier: BSD-3-Clause
// The packets of servo_bus_pkg.vhd: what the master sends, and the reply of a servo.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace unitylink::device {

enum class ServoPacket : std::uint32_t { torques, goals, question };

// Words of a servo, in the order of their addresses.
enum class ServoField : std::uint32_t { drive, goal, position, speed, load, status, age, failures };
constexpr std::uint32_t servo_fields = 8;

inline std::uint16_t servo_check_with(std::uint32_t check, std::uint8_t byte) noexcept {
  check ^= static_cast<std::uint32_t>(byte) << 8;
  for (int bit = 0; bit < 8; ++bit) {
    check = (check & 0x8000u) != 0 ? check << 1 ^ 0x8005u : check << 1;
  }
  return static_cast<std::uint16_t>(check);
}

inline std::uint32_t with_sign(std::uint32_t value) noexcept {
  if ((value & 0x8000u) == 0) {
    return value;
  }
  return 0x8000u | std::min(0x10000u - value, 0x7FFFu);
}

inline std::uint32_t without_sign(std::uint32_t value, std::uint32_t sign_bit) noexcept {
  const std::uint32_t size = value & ((1u << sign_bit) - 1u);
  return (value >> sign_bit & 1u) != 0 ? (0u - size) & 0xFFFFu : size;
}

// A packet to all servos, item by item, or a question to one.
class ServoPacketText {
 public:
  ServoPacketText(bool feetech, ServoPacket packet, std::uint8_t id, std::uint32_t count) : feetech_(feetech) {
    const auto kind = static_cast<std::size_t>(packet);
    const std::array<std::uint8_t, 3> registers =
        feetech ? std::array<std::uint8_t, 3>{0x28, 0x2A, 0x38} : std::array<std::uint8_t, 3>{0x40, 0x74, 0x7E};
    const std::array<std::uint8_t, 3> sizes =
        feetech ? std::array<std::uint8_t, 3>{1, 2, 6} : std::array<std::uint8_t, 3>{1, 4, 10};
    const bool asks = packet == ServoPacket::question;
    const std::uint8_t to = asks ? id : 0xFE;
    const std::uint8_t instruction = asks ? 0x02 : 0x83;
    const std::uint32_t items = asks ? 0 : count * (sizes[kind] + 1u);
    if (feetech) {
      bytes_ = {0xFF, 0xFF, to, static_cast<std::uint8_t>(items + 4), instruction, registers[kind], sizes[kind]};
    } else {
      bytes_ = {0xFF, 0xFF,        0xFD, 0, to, static_cast<std::uint8_t>(items + 7), 0, instruction, registers[kind],
                0,    sizes[kind], 0};
    }
  }

  void add_torque(std::uint8_t id, bool on) {
    bytes_.push_back(id);
    bytes_.push_back(on ? 1 : 0);
  }
  void add_goal(std::uint8_t id, std::uint32_t goal) {
    const std::uint32_t sent = feetech_ ? with_sign(goal) : goal;
    bytes_.push_back(id);
    bytes_.push_back(static_cast<std::uint8_t>(sent));
    bytes_.push_back(static_cast<std::uint8_t>(sent >> 8));
    if (!feetech_) {
      bytes_.insert(bytes_.end(), 2, (sent & 0x8000u) != 0 ? 0xFF : 0);
    }
  }
  // The packet with its check.
  [[nodiscard]] std::vector<std::uint8_t> whole() const {
    std::vector<std::uint8_t> found = bytes_;
    std::uint32_t sum = 0;
    std::uint32_t check = 0;
    for (std::size_t place = 0; place < bytes_.size(); ++place) {
      sum += place > 1 ? bytes_[place] : 0u;
      check = servo_check_with(check, bytes_[place]);
    }
    if (feetech_) {
      found.push_back(static_cast<std::uint8_t>(~sum));
    } else {
      found.push_back(static_cast<std::uint8_t>(check));
      found.push_back(static_cast<std::uint8_t>(check >> 8));
    }
    return found;
  }

 private:
  bool feetech_;
  std::vector<std::uint8_t> bytes_;
};

// What servo_bus_receiver.vhd makes of the bytes of a reply.
class ServoReply {
 public:
  explicit ServoReply(bool feetech) : feetech_(feetech) {}

  void clear() noexcept {
    place_ = heard_ = extra_ = run_ = 0;
    wrong_ = false;
  }

  // True: this byte ends a good reply.
  bool take(std::uint8_t data, bool broken, std::uint8_t id) noexcept {
    const std::uint32_t place = place_;
    const bool stuffed = !feetech_ && run_ == 3 && place > 7 && place <= check_place();
    const bool once_more = feetech_ && place == 2 && data == 0xFF;
    heard_ = (heard_ + 1) % 64;
    place_ = (place + 1) % 32;
    const std::uint32_t run = run_;
    run_ = data == 0xFF ? (run == 0 ? 1 : 2) : data == 0xFD && run == 2 ? 3 : 0;
    bool fits = true;
    if (stuffed) {
      fits = data == 0xFD && extra_ != 0;
      place_ = place;
      extra_ = (extra_ - 1) & 3u;
      run_ = 0;
    } else if (place <= header_last()) {
      place_ = header(place, data);
    } else if (place < error_place()) {
      if (once_more) {
        place_ = place;
      } else {
        fits = is_head(place, data, id);
      }
    } else if (place == error_place()) {
      alarm_ = wrong_ ? alarm_ : data;
    } else if (place < check_place()) {
      keep(place - error_place() - 1, data);
    } else {
      fits = data == static_cast<std::uint8_t>(place == check_place() ? check() : check() >> 8);
    }
    if (place == header_last() || once_more) {
      sum_ = 0;
      check_ = header_check;
    } else if (place > header_last() && (place < check_place() || stuffed)) {
      sum_ += data;
      check_ = servo_check_with(check_, data);
    }
    if (!fits || broken) {
      wrong_ = true;
    } else if (place == check_place() + (feetech_ ? 0 : 1) && !wrong_ && extra_ == 0 && !stuffed) {
      return true;
    }
    return false;
  }

  [[nodiscard]] std::uint32_t heard() const noexcept { return heard_; }
  [[nodiscard]] std::uint32_t alarm() const noexcept { return alarm_; }
  [[nodiscard]] std::uint32_t word(ServoField field) const noexcept { return words_[static_cast<std::size_t>(field)]; }

 private:
  static constexpr std::uint32_t heard_most = 63;
  static constexpr std::uint16_t header_check = 0x0C0E;

  [[nodiscard]] std::uint32_t header_last() const noexcept { return feetech_ ? 1 : 2; }
  [[nodiscard]] std::uint32_t error_place() const noexcept { return feetech_ ? 4 : 8; }
  [[nodiscard]] std::uint32_t check_place() const noexcept { return feetech_ ? 11 : 19; }
  [[nodiscard]] std::uint32_t check() const noexcept { return feetech_ ? ~sum_ & 0xFFu : check_; }

  [[nodiscard]] std::uint32_t header(std::uint32_t place, std::uint8_t data) const noexcept {
    if (feetech_ || place < 2) {
      return data == 0xFF ? place + 1 : 0;
    }
    return data == 0xFF ? 2 : data == 0xFD ? 3 : 0;
  }

  bool is_head(std::uint32_t place, std::uint8_t data, std::uint8_t id) noexcept {
    if (feetech_) {
      return data == (place == 2 ? id : 8);
    }
    switch (place) {
      case 4: return data == id;
      case 5: extra_ = (data - 14u) & 3u; return data >= 14 && data <= 17;
      case 7: return data == 0x55;
      default: return data == 0;
    }
  }

  void keep(std::uint32_t index, std::uint8_t data) noexcept {
    if ((index & 1u) == 0) {
      low_ = data;
      return;
    }
    const auto field = static_cast<std::size_t>(field_of(index / 2));
    if (field == 0 || wrong_) {
      return;
    }
    const std::uint32_t word = static_cast<std::uint32_t>(data) << 8 | low_;
    const bool is_load = field == static_cast<std::size_t>(ServoField::load);
    words_[field] = feetech_ ? without_sign(word, is_load ? 10 : 15) : word;
  }

  // `drive` stands for words that are not kept.
  [[nodiscard]] ServoField field_of(std::uint32_t word) const noexcept {
    using Fields = std::array<ServoField, 5>;
    static constexpr Fields feetech{ServoField::position, ServoField::speed, ServoField::load, ServoField::drive,
                                    ServoField::drive};
    static constexpr Fields dynamixel{ServoField::load, ServoField::speed, ServoField::drive, ServoField::position,
                                      ServoField::drive};
    return (feetech_ ? feetech : dynamixel)[word];
  }

  bool feetech_;
  std::uint32_t place_ = 0;
  std::uint32_t heard_ = 0;
  std::uint32_t extra_ = 0;
  std::uint32_t run_ = 0;
  bool wrong_ = false;
  std::uint32_t sum_ = 0;
  std::uint32_t check_ = 0;
  std::uint32_t low_ = 0;
  std::uint32_t alarm_ = 0;
  std::array<std::uint32_t, servo_fields> words_{};
};

}  // namespace unitylink::device
