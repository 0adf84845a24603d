// SPDX-License-Identifier: BSD-3-Clause
// Layer 1 for Python: the decoder and the encoder alone. Events are tuples. layer1_stream.py gives them types.
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>

#include <string>
#include <vector>

#include "bindings.hpp"
#include "layer1_stream/classic_decoder.hpp"
#include "layer1_stream/classic_encoder.hpp"
#include "layer1_stream/configuration.hpp"

namespace nb = nanobind;

namespace unitylink::python {
namespace {

Crc8 sum_of(std::optional<std::uint8_t> polynomial) { return polynomial ? Crc8(*polynomial) : Crc8::exclusive_or(); }

nb::bytes bytes_of(std::span<const std::uint8_t> data) { return nb::bytes(data.data(), data.size()); }

std::string_view name_of(MessageKind kind) {
  switch (kind) {
    case MessageKind::reply: return "reply";
    case MessageKind::application_error: return "application_error";
    case MessageKind::datalink_error: return "datalink_error";
    case MessageKind::busy: return "busy";
    case MessageKind::bad_checksum: return "bad_checksum";
    case MessageKind::malformed: return "malformed";
  }
  return "malformed";
}

struct Collector {
  nb::list events;
  void on_message(const Message& message) {
    const std::string head = message.head == 0 ? std::string() : std::string(1, message.head);
    events.append(nb::make_tuple(name_of(message.kind), head, message.letters, bytes_of(message.data), message.error,
                                 message.code, message.fields));
  }
  void on_publish(const Publish& publish) {
    nb::list words;
    for (const std::uint32_t word : publish.words) {
      words.append(word);
    }
    events.append(nb::make_tuple("publish", publish.checked, publish.group, publish.count, nb::tuple(words)));
  }
  void on_garbage(std::size_t bytes) { events.append(nb::make_tuple("garbage", bytes)); }
};

class StreamDecoder {
 public:
  StreamDecoder(std::uint32_t data_bytes, std::optional<std::uint8_t> polynomial) : decoder_(sum_of(polynomial)) {
    decoder_.set_data_bytes(data_bytes);
  }
  nb::list feed(nb::bytes data) {
    Collector collector;
    decoder_.feed(std::span(static_cast<const std::uint8_t*>(data.data()), data.size()), collector);
    return collector.events;
  }

 private:
  ClassicDecoder decoder_;
};

nb::bytes encode(std::string_view command, nb::bytes data, bool checked, std::optional<std::uint8_t> polynomial) {
  const Crc8 sum = sum_of(polynomial);
  std::vector<std::uint8_t> room(encoded_bytes(command.size(), data.size(), checked));
  ClassicEncoder encoder(room, sum, checked);
  encoder.command(command);
  for (std::size_t index = 0; index < data.size(); ++index) {
    encoder.byte(static_cast<const std::uint8_t*>(data.data())[index]);
  }
  return nb::bytes(room.data(), encoder.finish());
}

nb::object configuration(std::string_view fields, std::optional<std::uint8_t> polynomial) {
  const auto told = parse_configuration(fields, sum_of(polynomial), std::nullopt);
  if (!told) {
    return nb::none();
  }
  return nb::make_tuple(told->address_bytes, told->data_bytes, told->read_many, told->publish_mode, told->base_hz,
                        told->groups, told->group_size, told->rate_bytes);
}

}  // namespace

void bind_stream(nb::module_& module) {
  using namespace nb::literals;
  nb::class_<StreamDecoder>(module, "NativeDecoder")
      .def(nb::init<std::uint32_t, std::optional<std::uint8_t>>(), "data_bytes"_a, "polynomial"_a.none())
      .def("feed", &StreamDecoder::feed, "data"_a);
  module.def("encode_request", &encode, "command"_a, "data"_a, "checked"_a, "polynomial"_a.none());
  module.def("parse_configuration", &configuration, "fields"_a, "polynomial"_a.none());
}

}  // namespace unitylink::python
