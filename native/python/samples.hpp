// SPDX-License-Identifier: BSD-3-Clause
// Publishes as messages for a network: from the ring of a link to a `put`, with no object of Python for a row or a
// value. Making those took longer than the put of Zenoh.
#pragma once

#include <nanobind/nanobind.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "layer2_message/link.hpp"

namespace unitylink::python {

// Where rows of words go as messages, and how their values lie in a message.
class SampleOutput {
 public:
  // `fields` are tuples of schema.Field.piece, in the order of the `words` of a row. None: the words themselves,
  // little-endian. `put` gets each message as a bytearray, which is used again if `put` does not keep it.
  SampleOutput(nanobind::callable put, std::size_t words, const nanobind::object& fields);

  [[nodiscard]] std::size_t words() const noexcept { return words_; }
  [[nodiscard]] std::size_t row_bytes() const noexcept { return row_bytes_; }

  // Puts a message for each row, in their order. `first` is the sequence of the first one. The time of a message is
  // that in `times_s`, in ns, and `since_ns` later. Passes on what `put` throws; the rest is not put then.
  void send(std::uint32_t first, std::span<const double> times_s, std::int64_t since_ns, const std::uint32_t* rows);

 private:
  enum class Kind : std::uint8_t { copy, whole, truth, number, real };

  // One field, or `count` neighbours of the same kind.
  struct Piece {
    Kind kind = Kind::copy;
    std::size_t words = 0;  // of one
    std::size_t bytes = 0;  // of one, in the message
    unsigned data_bits = 32;
    unsigned width = 32;
    std::uint64_t mask = 0;
    std::uint64_t sign = 0;
    bool scaled = false;  // then the value is (number * factor + added) / divisor
    double factor = 1;
    double added = 0;
    double divisor = 1;
    std::size_t count = 1;
    bool operator==(const Piece&) const = default;
  };

  [[nodiscard]] static Piece piece_of(const nanobind::tuple& field);
  [[nodiscard]] static std::uint64_t value_of(const Piece& piece, const std::uint32_t* row) noexcept;
  void write(std::uint8_t* to, const std::uint32_t* row) const noexcept;

  nanobind::callable put_;
  std::size_t words_;
  std::size_t row_bytes_ = 0;
  std::vector<Piece> pieces_;
  nanobind::object message_;  // the last one
};

// The way of a subscription's publishes to the outputs that are set. Python's GIL guards it.
class PublishPath {
 public:
  // `failed` gets what an output throws.
  explicit PublishPath(nanobind::callable failed) : failed_(std::move(failed)) {}

  // Takes all publishes that wait, and puts them by each output. One that fails does not keep the others from theirs.
  void take(Link& link, std::uint32_t id);

  [[nodiscard]] std::uint64_t published() const noexcept { return published_; }
  [[nodiscard]] nanobind::tuple outputs() const { return outputs_; }
  void set_outputs(nanobind::tuple outputs) { outputs_ = std::move(outputs); }

 private:
  nanobind::callable failed_;
  nanobind::tuple outputs_;
  std::uint64_t published_ = 0;  // that have come
  Drained room_;                 // its memory is used again
};

}  // namespace unitylink::python
