// SPDX-License-Identifier: BSD-3-Clause
// The model of quadrature_encoder.vhd.
#include "device/component/component.hpp"
#include "device/component/input_filter.hpp"

namespace unitylink::device {

namespace {

class QuadratureEncoder final : public Component {
 public:
  explicit QuadratureEncoder(const ComponentConfiguration& from)
      : Component(from, "1001", true), filter_(3, static_cast<std::uint32_t>(from.generic("stable_clocks", 2))) {}

 private:
  enum Register : std::uint32_t { position, index_position, index_count, impossible };
  enum Pin : std::uint32_t { a = 1, b = 2, index = 4 };  // bits of the levels

  [[nodiscard]] Clock next() const noexcept override { return std::min(filter_.next(), compare_); }

  void step(Clock edge) override {
    const std::uint32_t now = filter_.levels();
    const std::uint32_t changed = now ^ before_;
    if (is_written(position, edge)) {
      position_ = write_word(position);
    }
    if (is_written(impossible, edge)) {
      impossible_ = write_word(impossible);
    }
    if ((changed & (a | b)) == (a | b)) {
      ++impossible_;
    } else if ((changed & (a | b)) != 0) {
      const bool up = ((now & a) != 0) != ((before_ & b) != 0);
      position_ += up ? 1u : ~0u;
    }
    if ((now & ~before_ & index) != 0) {
      word(index_position, position_, edge);
      word(index_count, ++indices_, edge);
    }
    before_ = now;
    word(position, position_, edge);
    word(impossible, impossible_, edge);
    compare_ = filter_.step(edge) ? edge + 1 : never;
  }

  void driven(std::uint32_t pin, bool level, Clock edge) override { filter_.drive(pin, level, edge); }

  InputFilter filter_;
  std::uint32_t before_ = 0;  // the levels when they were last compared
  std::uint32_t position_ = 0;
  std::uint32_t indices_ = 0;
  std::uint32_t impossible_ = 0;
  Clock compare_ = never;  // the edge that compares the levels again
};

}  // namespace

std::unique_ptr<Component> make_quadrature_encoder(const ComponentConfiguration& from) {
  return std::make_unique<QuadratureEncoder>(from);
}

}  // namespace unitylink::device
