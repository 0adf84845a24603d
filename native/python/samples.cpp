// SPDX-License-Identifier: BSD-3-Clause
#include "samples.hpp"

#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>

#include <bit>
#include <chrono>
#include <cmath>
#include <cstring>
#include <string>
#include <tuple>
#include <utility>

#include "bindings.hpp"

namespace nb = nanobind;

namespace unitylink::python {
namespace {

using Times = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Rows = nb::ndarray<const std::uint32_t, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

constexpr std::size_t head_bytes = 12;        // a number of 32 bits, and the time as an integer of 64 bits in ns
constexpr std::int64_t close_ns = 1'000'000;  // between the clock of a link and that of the system: they are the same
constexpr std::size_t word_bytes = 4;
constexpr unsigned word_bits = 32;

void put_little(std::uint8_t* to, std::uint64_t value, std::size_t bytes) noexcept {
  if constexpr (std::endian::native == std::endian::little) {
    std::memcpy(to, &value, bytes);
  } else {
    for (std::size_t place = 0; place < bytes; ++place) {
      to[place] = static_cast<std::uint8_t>(value >> 8 * place);
    }
  }
}

double of_float(std::uint64_t raw, unsigned width) noexcept {
  return width == 32 ? static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(raw)))
                     : std::bit_cast<double>(raw);
}

// Numbers of a word each, as value_of computes them: a loop that the compiler unrolls.
template <class Number>
void scale(std::uint8_t* to, const std::uint32_t* row, std::size_t count, unsigned unused_bits, double factor,
           double added, double divisor) noexcept {
  for (std::size_t index = 0; index < count; ++index) {
    const auto number = static_cast<Number>(static_cast<Number>(row[index] << unused_bits) >> unused_bits);
    const double product = static_cast<double>(number) * factor;
    const double value = (product + added) / divisor;
    put_little(to + sizeof value * index, std::bit_cast<std::uint64_t>(value), sizeof value);
  }
}

std::int64_t system_ns() noexcept {
  return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

SampleOutput::SampleOutput(nb::callable put, std::size_t words, const nb::object& fields)
    : put_(std::move(put)), words_(words) {
  if (fields.is_none()) {
    pieces_ = {{.words = 1, .bytes = word_bytes, .count = words}};
    row_bytes_ = word_bytes * words;
    return;
  }
  std::size_t taken = 0;
  for (const nb::handle field : fields) {
    Piece piece = piece_of(nb::cast<nb::tuple>(field));
    taken += piece.words;
    row_bytes_ += piece.bytes;
    if (!pieces_.empty()) {
      piece.count = pieces_.back().count;
      if (piece == pieces_.back()) {
        ++pieces_.back().count;
        continue;
      }
      piece.count = 1;
    }
    pieces_.push_back(piece);
  }
  if (taken != words) {
    throw nb::value_error(
        ("fields of " + std::to_string(taken) + " words for rows of " + std::to_string(words)).c_str());
  }
}

SampleOutput::Piece SampleOutput::piece_of(const nb::tuple& field) {
  const auto name = nb::cast<std::string>(field[0]);
  Piece piece{.words = nb::cast<std::size_t>(field[1]),
              .bytes = nb::cast<std::size_t>(field[5]),
              .data_bits = nb::cast<unsigned>(field[2]),
              .width = nb::cast<unsigned>(field[3])};
  const bool negative = nb::cast<bool>(field[4]);
  if (piece.width == 0 || piece.width > 64 || piece.data_bits == 0 || piece.data_bits > 32 || piece.bytes > 8 ||
      piece.words != (piece.width + piece.data_bits - 1) / piece.data_bits) {
    throw nb::value_error("no field has such a size");
  }
  piece.mask = ~0ULL >> (64 - piece.width);
  piece.sign = negative ? 1ULL << (piece.width - 1) : 0;
  piece.kind = name == "float" ? Kind::real : name == "bool" ? Kind::truth : Kind::whole;
  if (!field[6].is_none()) {
    const auto [factor, added, divisor] = nb::cast<std::tuple<double, double, double>>(field[6]);
    piece.factor = factor;
    piece.added = added;
    piece.divisor = divisor;
    piece.scaled = true;
    piece.kind = name == "float" ? Kind::real : Kind::number;
  } else if (piece.kind == Kind::whole && piece.data_bits == 32 && piece.width == 32 && piece.bytes == word_bytes) {
    piece.kind = Kind::copy;
  }
  if ((piece.kind == Kind::real || piece.kind == Kind::number) && piece.bytes != sizeof(double)) {
    throw nb::value_error("a number with a scale or a point has 8 bytes");
  }
  if (piece.kind == Kind::real && piece.width != 32 && piece.width != 64) {
    throw nb::value_error("a float has 32 or 64 bits");
  }
  return piece;
}

void SampleOutput::write(std::uint8_t* to, const std::uint32_t* row) const noexcept {
  for (const Piece& piece : pieces_) {
    if (piece.kind == Kind::copy && std::endian::native == std::endian::little) {
      std::memcpy(to, row, piece.bytes * piece.count);
      to += piece.bytes * piece.count;
      row += piece.count;
      continue;
    }
    if (piece.kind == Kind::number && piece.width <= word_bits && piece.words == 1) {
      const auto act = piece.sign != 0 ? &scale<std::int32_t> : &scale<std::uint32_t>;
      act(to, row, piece.count, word_bits - piece.width, piece.factor, piece.added, piece.divisor);
      to += piece.bytes * piece.count;
      row += piece.count;
      continue;
    }
    for (std::size_t field = 0; field < piece.count; ++field) {
      const std::uint64_t value = value_of(piece, row);
      if (piece.bytes == sizeof value) {  // the compiler knows the size
        put_little(to, value, sizeof value);
      } else {
        put_little(to, value, piece.bytes);
      }
      to += piece.bytes;
      row += piece.words;
    }
  }
}

// As Codec.decode_array computes it.
std::uint64_t SampleOutput::value_of(const Piece& piece, const std::uint32_t* row) noexcept {
  std::uint64_t raw = row[0];
  for (std::size_t word = 1; word < piece.words; ++word) {
    raw |= static_cast<std::uint64_t>(row[word]) << piece.data_bits * word;
  }
  raw &= piece.mask;
  const std::uint64_t number = (raw ^ piece.sign) - piece.sign;
  double value = 0;
  switch (piece.kind) {
    case Kind::truth: return raw != 0 ? 1 : 0;
    case Kind::number:
      value = piece.sign != 0 ? static_cast<double>(static_cast<std::int64_t>(number)) : static_cast<double>(number);
      break;
    case Kind::real: value = of_float(raw, piece.width); break;
    default: return number;
  }
  if (piece.scaled) {
    const double product = value * piece.factor;
    value = (product + piece.added) / piece.divisor;
  }
  return std::bit_cast<std::uint64_t>(value);
}

void SampleOutput::send(std::uint32_t first, std::span<const double> times_s, std::int64_t since_ns,
                        const std::uint32_t* rows) {
  nb::object message = std::move(message_);  // `put` releases the GIL, so another thread may come here
  auto* bytes = message.is_valid() ? reinterpret_cast<std::uint8_t*>(PyByteArray_AsString(message.ptr())) : nullptr;
  for (std::size_t index = 0; index < times_s.size(); ++index) {
    const double ns = times_s[index] * 1e9;
    if (!(std::abs(ns) < 9e18)) {
      throw nb::value_error("a publish has no time");
    }
    if (!message.is_valid() || Py_REFCNT(message.ptr()) != 1) {  // `put` has kept it
      message = nb::steal(PyByteArray_FromStringAndSize(nullptr, static_cast<Py_ssize_t>(head_bytes + row_bytes_)));
      if (!message.is_valid()) {
        throw nb::python_error();
      }
      bytes = reinterpret_cast<std::uint8_t*>(PyByteArray_AsString(message.ptr()));
    }
    put_little(bytes, first + static_cast<std::uint32_t>(index), 4);
    put_little(bytes + 4, static_cast<std::uint64_t>(static_cast<std::int64_t>(ns) + since_ns), 8);
    write(bytes + head_bytes, rows + index * words_);
    put_(message);
  }
  message_ = std::move(message);
}

namespace {

void send_rows(SampleOutput& output, std::uint32_t first, const Times& times_s, std::int64_t since_ns,
               const Rows& rows) {
  if (rows.shape(0) != times_s.shape(0) || rows.shape(1) != output.words()) {
    throw nb::value_error(("expected " + std::to_string(times_s.shape(0)) + " rows of " +
                           std::to_string(output.words()) + " words, got " + std::to_string(rows.shape(0)) + " of " +
                           std::to_string(rows.shape(1)))
                              .c_str());
  }
  output.send(first, {times_s.data(), times_s.shape(0)}, since_ns, rows.data());
}

}  // namespace

void PublishPath::take(Link& link, std::uint32_t id) {
  Drained drained = std::move(room_);  // as the message above
  std::int64_t since_ns = 0;
  {
    GilRelease release;
    link.drain(id, drained);
    if (drained.count != 0) {
      since_ns = system_ns() - static_cast<std::int64_t>(link.now_ns());
    }
  }
  if (std::abs(since_ns) < close_ns) {
    since_ns = 0;
  }
  const auto first = static_cast<std::uint32_t>(published_ + drained.before);
  published_ += drained.count;
  const nb::tuple outputs = outputs_;  // others may be set meanwhile
  for (const nb::handle one : outputs) {
    try {
      auto& output = nb::cast<SampleOutput&>(one);
      if (drained.count != 0 && output.words() != drained.words) {
        throw nb::value_error("an output for rows of another size");
      }
      output.send(first, {drained.times_s.data(), drained.count}, since_ns, drained.values.data());
    } catch (nb::python_error& error) {
      failed_(error.value());
    } catch (const std::exception& error) {
      failed_(nb::str(error.what()));
    }
  }
  room_ = std::move(drained);
}

void bind_samples(nb::module_& module) {
  using namespace nb::literals;
  nb::class_<SampleOutput>(module, "SampleOutput")
      .def(nb::init<nb::callable, std::size_t, const nb::object&>(), "put"_a, "words"_a, "fields"_a.none() = nb::none())
      .def_prop_ro("row_bytes", &SampleOutput::row_bytes)
      .def("send", &send_rows, "first"_a, "times_s"_a, "since_ns"_a, "rows"_a);
  nb::class_<PublishPath>(module, "PublishPath")
      .def(nb::init<nb::callable>(), "failed"_a)
      .def_prop_rw("outputs", &PublishPath::outputs, &PublishPath::set_outputs)
      .def_prop_ro("published", &PublishPath::published)
      .def("take", &PublishPath::take, "link"_a, "id"_a);
}

}  // namespace unitylink::python
