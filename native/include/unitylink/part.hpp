// SPDX-License-Identifier: BSD-3-Clause
//
// A part of a robot, or a group: values that are read together, written together, and exchanged in a control loop.
// `Inputs` and `Outputs` are generated structs. C++20; nothing here allocates.
#pragma once

#include <unitylink/cycle.h>

#include "unitylink/objects.hpp"

namespace unitylink {

// The raw numbers of a struct's values, in order.
template <class Values>
using Raws = std::array<std::uint64_t, Values::ul_values.count == 0 ? 1 : Values::ul_values.count>;

template <class Values>
ul_status encode_all(const ul_objects& objects, std::uint32_t first, const Values& values, Raws<Values>& raws,
                     ul_failure& failure) {
  std::uint32_t i = 0;
  return Values::ul_each(values, [&](const auto& value) {
    const ul_value* facts = ul_of_set(&objects, first, &Values::ul_values, i);
    return encode(*facts, value, raws[i++], failure);
  });
}

template <class Values>
ul_status decode_all(const ul_objects& objects, std::uint32_t first, const Raws<Values>& raws, Values& values,
                     ul_failure& failure) {
  std::uint32_t i = 0;
  return Values::ul_each(values, [&](auto& value) {
    const ul_value* facts = ul_of_set(&objects, first, &Values::ul_values, i);
    return decode(*facts, raws[i++], value, failure);
  });
}

// The body of a control loop: exchange() writes all outputs, then reads all inputs, in one message each way where the
// device can. Call open() before the loop. It names the words to the device once, and only it allocates.
template <class Inputs, class Outputs>
class Cycle {
 public:
  Cycle(ul_objects& objects, std::uint32_t first, const char* path) noexcept : inputs_(Inputs::ul_values) {
    outputs_.path = inputs_.path = path;
    cycle_ = {&objects, first, &outputs_, &inputs_, addresses_.data(), words_.data(), layout_.data(), 0, 0,
              0,        0,     false,     false};
  }
  Cycle(const Cycle&) = delete;
  Cycle& operator=(const Cycle&) = delete;
  ~Cycle() { ul_cycle_close(&cycle_); }

  // Twice does nothing. UL_MISMATCH: the values are behind several links.
  result<> open() {
    ul_failure failure{};
    if (!opened_ && ul_cycle_open(&cycle_, &failure) != UL_OK) return Error(failure);
    opened_ = true;
    return {};
  }
  // Nothing is sent if an output is out of its limits.
  result<Inputs> exchange(const Outputs& outputs) {
    if (!opened_) {
      if (const result<> ready = open(); !ready) return ready.error();
    }
    Raws<Outputs> out{};
    Raws<Inputs> in{};
    Inputs inputs{};
    ul_failure failure{};
    if (encode_all(*cycle_.objects, cycle_.first, outputs, out, failure) != UL_OK) return Error(failure);
    if (ul_cycle_exchange(&cycle_, out.data(), in.data(), &failure) != UL_OK) return Error(failure);
    if (decode_all(*cycle_.objects, cycle_.first, in, inputs, failure) != UL_OK) return Error(failure);
    return inputs;
  }

 private:
  static constexpr std::size_t words = Inputs::ul_values.words + Outputs::ul_values.words;
  ul_set outputs_ = Outputs::ul_values, inputs_;
  std::array<std::uint32_t, words> addresses_{}, words_{};
  std::array<ul_exchange_word, words> layout_{};
  ul_cycle cycle_{};
  bool opened_ = false;
};

template <class Inputs, class Outputs>
class Part {
 public:
  Part(ul_objects& objects, std::uint32_t first, const char* path) noexcept
      : part_objects_(&objects), part_first_(first), part_path_(path) {}

  // Reads all inputs. `consistent`: all of a link are of one moment, or it is an error (UL_MISMATCH).
  result<Inputs> snapshot(bool consistent = false) const
    requires(Inputs::ul_values.count > 0)
  {
    std::array<std::uint32_t, 2 * Inputs::ul_values.words> room;
    Raws<Inputs> raws{};
    Inputs inputs{};
    ul_failure failure{};
    ul_set set = Inputs::ul_values;
    set.path = part_path_;
    if (ul_set_read(part_objects_, part_first_, &set, consistent, room.data(), raws.data(), &failure) != UL_OK)
      return Error(failure);
    if (decode_all(*part_objects_, part_first_, raws, inputs, failure) != UL_OK) return Error(failure);
    return inputs;
  }
  // Writes all outputs together. Nothing is sent if one is out of its limits.
  result<> write(const Outputs& outputs) const
    requires(Outputs::ul_values.count > 0)
  {
    std::array<std::uint32_t, 2 * Outputs::ul_values.words> room;
    Raws<Outputs> raws{};
    ul_failure failure{};
    ul_set set = Outputs::ul_values;
    set.path = part_path_;
    if (encode_all(*part_objects_, part_first_, outputs, raws, failure) != UL_OK) return Error(failure);
    if (ul_set_write(part_objects_, part_first_, &set, raws.data(), room.data(), &failure) != UL_OK)
      return Error(failure);
    return {};
  }
  // The body of a control loop with all outputs and inputs.
  Cycle<Inputs, Outputs> cycle() const { return Cycle<Inputs, Outputs>(*part_objects_, part_first_, part_path_); }

 private:
  ul_objects* part_objects_;
  std::uint32_t part_first_;
  const char* part_path_;
};

}  // namespace unitylink
