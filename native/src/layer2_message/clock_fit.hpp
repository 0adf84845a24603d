// SPDX-License-Identifier: BSD-3-Clause
// Converts the device's clock to the host's time. Offset and drift are fitted to readings of the clock. Sans I/O.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace unitylink {

// A reading is the device's count of clocks at some moment between sending a request and receiving its answer. The
// middle of the two is wrong by at most half their distance. So readings with a quick answer have more weight.
class ClockFit {
 public:
  // Until better readings exist, a clock takes 1 / clock_hz.
  void set_nominal_hz(double clock_hz) noexcept { nominal_ns_ = clock_hz > 0 ? 1e9 / clock_hz : 0; }

  void clear() noexcept { count_ = 0; }

  void add(std::uint64_t clocks, std::uint64_t sent_ns, std::uint64_t received_ns) noexcept {
    if (count_ > 0 && clocks < last().clocks) {
      clear();  // the device was reset
    }
    readings_[count_ % kept] = {clocks, sent_ns + (received_ns - sent_ns) / 2,
                                std::max<std::uint64_t>(1, (received_ns - sent_ns) / 2)};
    ++count_;
    fit();
  }

  static constexpr std::size_t kept = 32;
  [[nodiscard]] std::size_t readings() const noexcept { return std::min(count_, kept); }
  [[nodiscard]] bool valid() const noexcept { return count_ > 0 && period_ns_ > 0; }
  // The real duration of one clock of the device, and how much it exceeds the nominal duration, in parts per million.
  [[nodiscard]] double period_ns() const noexcept { return period_ns_; }
  [[nodiscard]] double drift_ppm() const noexcept { return nominal_ns_ > 0 ? (period_ns_ / nominal_ns_ - 1) * 1e6 : 0; }
  // The largest error of a converted time: half of the quickest round trip.
  [[nodiscard]] double uncertainty_ns() const noexcept { return uncertainty_ns_; }

  // The host's time at which the low 32 bits of the device's count were `low`: the time nearest to `near_ns`.
  [[nodiscard]] std::uint64_t host_ns(std::uint32_t low, std::uint64_t near_ns) const noexcept {
    const double expected =
        static_cast<double>(origin_clocks_ & 0xFFFFFFFF) +
        (static_cast<double>(static_cast<std::int64_t>(near_ns - origin_ns_)) - offset_ns_) / period_ns_;
    const auto nearest = static_cast<std::int64_t>(expected);
    const auto difference = static_cast<std::int32_t>(low - static_cast<std::uint32_t>(nearest));
    const double clocks = static_cast<double>(nearest + difference) - static_cast<double>(origin_clocks_ & 0xFFFFFFFF);
    return origin_ns_ + static_cast<std::uint64_t>(static_cast<std::int64_t>(offset_ns_ + clocks * period_ns_));
  }

 private:
  static constexpr double drift_max = 0.05;  // a larger fitted drift is noise

  struct Reading {
    std::uint64_t clocks = 0;
    std::uint64_t host_ns = 0;
    std::uint64_t half_ns = 0;
  };

  [[nodiscard]] const Reading& last() const noexcept { return readings_[(count_ - 1) % kept]; }

  // A straight line by least squares. The weight of each reading is the square of its certainty.
  void fit() noexcept {
    const std::size_t have = std::min(count_, kept);
    origin_clocks_ = last().clocks;
    origin_ns_ = last().host_ns;
    double weights = 0, x = 0, y = 0, xx = 0, xy = 0;
    uncertainty_ns_ = static_cast<double>(last().half_ns);
    for (std::size_t index = 0; index < have; ++index) {
      const Reading& reading = readings_[index];
      const double half = static_cast<double>(reading.half_ns);
      const double weight = 1 / (half * half);
      const double at = -static_cast<double>(origin_clocks_ - reading.clocks);
      const double time = -static_cast<double>(origin_ns_ - reading.host_ns);
      uncertainty_ns_ = std::min(uncertainty_ns_, half);
      weights += weight;
      x += weight * at;
      y += weight * time;
      xx += weight * at * at;
      xy += weight * at * time;
    }
    x /= weights;
    y /= weights;
    const double spread = xx / weights - x * x;
    const double slope = spread > 0 ? (xy / weights - x * y) / spread : nominal_ns_;
    const bool believable = nominal_ns_ <= 0 ? slope > 0 : std::abs(slope / nominal_ns_ - 1) < drift_max;
    period_ns_ = have >= 2 && believable && spread > 0 ? slope : nominal_ns_;
    offset_ns_ = y - period_ns_ * x;
  }

  std::array<Reading, kept> readings_;
  std::size_t count_ = 0;
  double nominal_ns_ = 0;
  double period_ns_ = 0;
  double offset_ns_ = 0;  // offset at the origin of the line, which is the last reading
  double uncertainty_ns_ = 0;
  std::uint64_t origin_clocks_ = 0;
  std::uint64_t origin_ns_ = 0;
};

}  // namespace unitylink
