// SPDX-License-Identifier: BSD-3-Clause
// The models of components for Python: what a spec says of one, and a model alone, on which stimuli are played.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bindings.hpp"
#include "device/component/component.hpp"
#include "device/component/modulator.hpp"

namespace nb = nanobind;

namespace unitylink::python {

using namespace unitylink::device;

ComponentConfiguration component_configuration_of(nb::handle from, std::uint32_t data_bits) {
  ComponentConfiguration result;
  result.path = nb::cast<std::string>(from.attr("path"));
  result.entity = nb::cast<std::string>(from.attr("entity"));
  result.base = nb::cast<std::uint32_t>(from.attr("base"));
  result.words = nb::cast<std::uint32_t>(from.attr("words"));
  result.data_bits = data_bits;
  for (nb::handle generic : nb::object(from.attr("generics"))) {
    const bool is_text = nb::isinstance<nb::str>(generic[1]);
    result.generics.push_back({nb::cast<std::string>(generic[0]), is_text ? 0 : nb::cast<std::int64_t>(generic[1]),
                               is_text ? nb::cast<std::string>(generic[1]) : std::string()});
  }
  for (nb::handle pin : nb::object(from.attr("pins"))) {
    const auto bits = nb::cast<std::uint32_t>(pin[2]);
    result.pins.push_back({nb::cast<std::string>(pin[0]), nb::cast<std::string>(pin[1]) == "in", bits == 0 ? 1 : bits});
  }
  for (nb::handle group : nb::object(from.attr("event_groups"))) {
    result.event_groups.push_back(nb::cast<std::optional<std::uint32_t>>(group));
  }
  for (nb::handle wire : nb::object(from.attr("wires"))) {
    result.wires.push_back({nb::cast<std::string>(wire[0]), nb::cast<std::string>(wire[1]) == "in"});
  }
  for (nb::handle lead : nb::object(from.attr("connections"))) {
    result.connections.push_back(
        {nb::cast<std::uint32_t>(lead[0]), nb::cast<std::uint32_t>(lead[1]), nb::cast<std::uint32_t>(lead[2])});
  }
  if (const nb::object node = from.attr("node"); !node.is_none()) {
    result.node = nb::cast<std::uint32_t>(node);
  }
  for (nb::handle word : nb::object(from.attr("carried"))) {
    result.carried.push_back(
        {nb::cast<std::uint32_t>(word[0]), nb::cast<std::uint32_t>(word[1]), nb::cast<bool>(word[2])});
  }
  for (nb::handle word : nb::object(from.attr("constants"))) {
    result.constants.push_back(
        {nb::cast<std::uint32_t>(word[0]), nb::cast<std::uint32_t>(word[1]), nb::cast<std::uint32_t>(word[2])});
  }
  return result;
}

namespace {

using Stimulus = std::tuple<Clock, char, std::uint32_t, std::uint32_t>;
using Seen = std::tuple<Clock, char, std::uint32_t, std::uint32_t>;

// Plays stimuli in the order of time: (clock, what, number, value). `p` drives an input pin, `r` reads, `w` writes, `c`
// opens (1) and closes (0) a block. Returns (state, what, number, value): `o` an output pin, `a` the answer of a read
// or write (number 1: err), `e` an event that became high. The bits of wires are pins, too, behind the others.
//
// `m` leads the modulator at an input: number is the input and 256 times the clocks that it takes, value the level. The
// clock of the modulators is the first output. With `draws` the model takes their bits by itself, and nobody watches
// this clock. Else they are driven, and `p` is what was driven.
//
// With `late` nobody waits for a pin, so the model may compute its changes when it is asked for something else.
std::vector<Seen> play(Component& model, const std::vector<Stimulus>& stimuli, Clock end, bool draws, bool late) {
  std::vector<Seen> seen;
  std::map<std::uint32_t, Modulator> modulators;
  const auto modulator = [&](std::uint32_t pin, Clock at) -> Modulator& {
    const auto [found, is_new] = modulators.try_emplace(pin);
    model.output_at(0, at);  // the bits until now
    if (is_new && draws && !model.draw_bits(pin, &found->second, at)) {
      throw nb::value_error("this model draws no bits");
    }
    if (is_new && !draws) {
      model.outputs().at(0).watch([&seen, &model, pin, &one = found->second](bool high, Clock state) {
        if (high) {
          const bool bit = one.bit(state);
          seen.emplace_back(state, 'p', pin, bit);
          model.drive(pin, bit, state);
        }
      });
    }
    return found->second;
  };
  for (std::uint32_t pin = draws ? 1 : 0; pin < model.outputs().size(); ++pin) {
    if (model.outputs()[pin].level()) {
      seen.emplace_back(0, 'o', pin, 1);
    }
    model.outputs()[pin].watch([&seen, pin](bool level, Clock state) { seen.emplace_back(state, 'o', pin, level); },
                               !late);
  }
  const auto pins = static_cast<std::uint32_t>(model.outputs().size());
  for (std::uint32_t wire = 0; wire < model.wires_out(); ++wire) {
    std::uint64_t shown = 0;
    const auto tell = [&seen, shown, first = pins + wire * wire_bits](const WireValue& value, Clock state) mutable {
      const std::uint64_t now = value.word();
      for (std::uint32_t bit = 0; bit < wire_bits; ++bit) {
        if (((now ^ shown) >> bit & 1u) != 0) {
          seen.emplace_back(state, 'o', first + bit, static_cast<std::uint32_t>(now >> bit & 1u));
        }
      }
      shown = now;
    };
    model.watch_wire(wire, tell);
  }
  std::vector<std::uint64_t> wires_in(model.wires_in());
  model.send_events_to([&seen](std::uint32_t group, bool high, Clock state) {
    if (high) {
      seen.emplace_back(state, 'e', group, 1);
    }
  });
  for (const auto& [at, what, number, value] : stimuli) {
    switch (what) {
      case 'p':
        if (number < model.inputs()) {
          model.drive(number, value != 0, at);
        } else {
          const std::uint32_t wire = (number - model.inputs()) / wire_bits;
          const std::uint64_t bit = std::uint64_t{1} << ((number - model.inputs()) % wire_bits);
          wires_in.at(wire) = value != 0 ? wires_in.at(wire) | bit : wires_in.at(wire) & ~bit;
          model.lead(wire, WireValue::of(wires_in.at(wire)), at);
        }
        break;
      case 'm': modulator(number & 0xFFu, at).lead(static_cast<std::int32_t>(value), at, at + (number >> 8)); break;
      case 'c': model.block(value != 0, at); break;
      case 'w': {
        const bool ok = model.write(number, value, at) == BusStatus::ok;
        seen.emplace_back(model.free_at() - 1, 'a', ok ? 0 : 1, 0);
        break;
      }
      default: {
        const BusReply reply = model.read(number, at);
        seen.emplace_back(model.free_at() - 1, 'a', reply.status == BusStatus::ok ? 0 : 1, reply.value);
      }
    }
  }
  model.advance(end);
  for (std::uint32_t pin = 0; late && pin < model.outputs().size(); ++pin) {
    model.output_at(pin, end);
  }
  for (const auto& [pin, one] : modulators) {
    model.draw_bits(pin, nullptr, end);
  }
  for (OutputPin& pin : model.outputs()) {
    pin.watch({});
  }
  for (std::uint32_t wire = 0; wire < model.wires_out(); ++wire) {
    model.watch_wire(wire, {});
  }
  model.send_events_to({});
  return seen;
}

struct ComponentModel {
  std::unique_ptr<Component> model;
};

}  // namespace

void bind_component(nb::module_& module) {
  nb::class_<ComponentModel>(module, "ComponentModel", "The model of one component, on a clock that the caller owns.")
      .def(
          "__init__",
          [](ComponentModel* self, nb::handle configuration, std::uint32_t data_bits) {
            auto model = make_component(component_configuration_of(configuration, data_bits));
            if (!model) {
              throw nb::value_error("there is no model of this entity");
            }
            new (self) ComponentModel{std::move(model)};
          },
          nb::arg("configuration"), nb::arg("data_bits") = 32)
      .def(
          "play",
          [](ComponentModel& self,
             const std::vector<std::tuple<Clock, std::string, std::uint32_t, std::uint32_t>>& told, Clock end,
             bool draws, bool late) {
            std::vector<Stimulus> stimuli;
            stimuli.reserve(told.size());
            for (const auto& [at, what, number, value] : told) {
              stimuli.emplace_back(at, what.at(0), number, value);
            }
            std::vector<std::tuple<Clock, std::string, std::uint32_t, std::uint32_t>> result;
            for (const auto& [at, what, number, value] : play(*self.model, stimuli, end, draws, late)) {
              result.emplace_back(at, std::string(1, what), number, value);
            }
            return result;
          },
          nb::arg("stimuli"), nb::arg("end"), nb::arg("draws") = false, nb::arg("late") = false,
          "Plays (clock, what, number, value); gives what pins, bus and events do.");
  module.def(
      "has_component_model",
      [](const std::string& entity) {
        ComponentConfiguration one;
        one.entity = entity;
        return make_component(one) != nullptr;
      },
      nb::arg("entity"));
}

}  // namespace unitylink::python
