// SPDX-License-Identifier: BSD-3-Clause
// The model of a component: its registers on the bus, its pins and its events. It is clock-true against the VHDL.
//
// Time. Clock n is the rising edge n, and the state n is that of all registers just before this edge. An access `at` n
// has stb sampled by edge n, and a pin driven `at` n is sampled by edge n. What an edge n changes is seen in state n
// + 1.
//
// A model does not run every clock. It says when its next edge is that changes something (`next`), and the base class
// calls `step` for this edge and for each edge with `is_written`. So write a model like this:
//
//   class Lamp final : public Component {                      // components/lamp/lamp.cpp
//    public:
//     explicit Lamp(const ComponentConfiguration& from) : Component(from, "1", false) {}
//    private:
//     void stored(std::uint32_t, Clock edge) override { word(0, write_word(0) & 1, edge); output(0, write_word(0) & 1,
//     edge); }
//   };
//   std::unique_ptr<Component> make_lamp(const ComponentConfiguration& from) { return std::make_unique<Lamp>(from); }
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "device/bus.hpp"
#include "device/component/component_configuration.hpp"
#include "device/component/output_pin.hpp"

namespace unitylink::device {

class Modulator;

// A wire from component to component, as wire_pkg.vhd has it.
struct WireValue {
  std::uint32_t value = 0;
  bool valid = false;

  [[nodiscard]] std::uint64_t word() const noexcept { return value | std::uint64_t{valid ? 1u : 0u} << 32; }
  [[nodiscard]] static WireValue of(std::uint64_t word) noexcept {
    return {static_cast<std::uint32_t>(word), (word >> 32 & 1u) != 0};
  }
};
constexpr std::uint32_t wire_bits = 33;

class Component : public Bus {
 public:
  // Accesses and pins that come while an earlier one is under way wait for it, as on the bus: an access takes 2 clocks.
  BusReply read(std::uint32_t address, Clock at) final;
  BusStatus write(std::uint32_t address, std::uint32_t value, Clock at) final;
  void block(bool held, Clock at) final;
  // The FPGA's own side: a word may be looked at, but nothing but the component sets it.
  BusReply get(std::uint32_t address, Clock at) final;
  BusStatus set(std::uint32_t, std::uint32_t, Clock) final { return BusStatus::error; }

  void drive(std::uint32_t pin, bool level, Clock at);  // an input pin, by its place among the inputs
  [[nodiscard]] std::uint32_t inputs() const noexcept { return inputs_; }  // how many
  [[nodiscard]] std::vector<OutputPin>& outputs() noexcept { return outputs_; }
  // An output as it is in this state, by its place. nullptr: there is no such one.
  [[nodiscard]] OutputPin* output_at(std::uint32_t pin, Clock state);
  // From `at` on the component takes the bits of an input from `source` by itself, without a change of the pin for
  // each. nullptr ends that. False: it cannot, so the bits must be driven.
  bool draw_bits(std::uint32_t pin, Modulator* source, Clock at);
  // A wire from an output of this component to an input of another one.
  void connect(std::uint32_t output, Component& sink, std::uint32_t input);
  // An input has this value from state `state` on. Values come in the order of their time.
  void lead(std::uint32_t input, WireValue value, Clock state);
  using WireWatcher = std::function<void(const WireValue& value, Clock state)>;
  void watch_wire(std::uint32_t output, WireWatcher watcher);
  [[nodiscard]] std::uint32_t wires_in() const noexcept { return wires_in_; }
  [[nodiscard]] std::uint32_t wires_out() const noexcept { return static_cast<std::uint32_t>(wires_.size()); }
  void send_events_to(EventSink sink) { sink_ = std::move(sink); }

  // The state in which the bus may begin another access. The answer of the last one came in the state before.
  [[nodiscard]] Clock free_at() const noexcept { return free_at_; }

  // Does anybody wait for its events or watch an output? Then it must be advanced in time.
  [[nodiscard]] bool is_heard() const noexcept;
  // The next clock at which an event or a watched output may change without an access. Others are computed when
  // somebody looks, or when much work has piled up. So an idle component costs nothing.
  [[nodiscard]] Clock next_clock() const noexcept final;
  void advance(Clock state) final;  // to this state

 protected:
  // `writable` has one character for each address, as for register_slave: 1 may be written, - is a hole. With
  // `snapshot`, reads are of the moment when cyc rose.
  Component(const ComponentConfiguration& configuration, std::string writable, bool snapshot);

  // The next edge at which something changes while nothing comes from outside. never: it waits.
  [[nodiscard]] virtual Clock next() const noexcept { return never; }
  // Edge `edge` happens. Edges between two calls change nothing.
  virtual void step(Clock /*edge*/) {}
  // Every edge before `state` is to have happened: for a model that computes many edges at once, between two of `next`.
  virtual void arrive(Clock /*state*/) {}
  // A model that nobody hears is advanced after so many clocks, 42 ms at 50 MHz. Else the next look has all of its
  // work.
  static constexpr Clock lag_most = Clock{1} << 21;
  // An access is on the bus from edge `edge` on. Returns the edge that takes it, which is a later one if the component
  // is busy. Everything before that edge has then happened.
  virtual Clock admitted(std::uint32_t /*address*/, bool /*writes*/, Clock edge) { return edge; }
  // Does a write of this value end with an error?
  [[nodiscard]] virtual bool refuses(std::uint32_t /*address*/, std::uint32_t /*value*/) const { return false; }
  // A write is taken by edge `edge`. Returns the edge that answers it, which is the same one unless the
  // component lets the bus wait. Such a component has a snapshot of its own, which any write thaws as a whole.
  virtual Clock offered(std::uint32_t /*address*/, std::uint32_t /*value*/, Clock edge) { return edge; }
  // At `edge` write_word(address) got a value. In the next edge, is_written(address) is true.
  virtual void stored(std::uint32_t /*address*/, Clock /*edge*/) {}
  // A word that changes with time is about to be read in state `state`. So it need not be set at each of its changes.
  virtual void look(std::uint32_t /*address*/, Clock /*state*/) {}
  // A wire to an input has another value, which edge `edge` is the first to sample. If that changes something by
  // itself, `next` is this edge.
  virtual void wired(std::uint32_t /*input*/, const WireValue& /*value*/, Clock /*edge*/) {}
  // An output is about to be looked at in state `state`. So one that nobody watches need not be set at each change.
  virtual void show(std::uint32_t /*pin*/, Clock /*state*/) {}
  virtual bool drawn(std::uint32_t /*pin*/, Modulator* /*source*/, Clock /*edge*/) { return false; }
  // An input pin has another level, which edge `edge` is the first to sample.
  virtual void driven(std::uint32_t /*pin*/, bool /*level*/, Clock /*edge*/) {}

  [[nodiscard]] std::uint32_t write_word(std::uint32_t address) const noexcept { return write_words_[address]; }
  [[nodiscard]] bool is_written(std::uint32_t address, Clock edge) const noexcept {
    return edge == written_edge_ && address == written_;
  }
  // All words are live until the block ends: a write has thawed a snapshot that is one as a whole.
  void thaw() noexcept { std::fill(thawed_.begin(), thawed_.end(), 1); }
  // Accesses before this state wait for it.
  void wait_until(Clock state) noexcept { free_at_ = state; }
  // Is cyc high at this edge: in an access, or in a block of accesses?
  [[nodiscard]] bool is_held(Clock edge) const noexcept { return held_ || edge < free_at_; }
  // What a read of `address` gives from state edge + 1 on.
  void word(std::uint32_t address, std::uint32_t value, Clock edge) noexcept;
  // Not in a constructor: all outputs are low at first, and a component without its pins may be made.
  void output(std::uint32_t pin, bool level, Clock edge) { outputs_[pin].change(level, edge + 1); }
  [[nodiscard]] bool is_watched(std::uint32_t pin) const noexcept {
    return pin < outputs_.size() && outputs_[pin].is_watched();
  }
  // A wire from an output has this value from state edge + 1 on. A spec may have been without this output.
  void wire(std::uint32_t output, WireValue value, Clock edge);
  // Words and wires as a reset leaves them, where that is not 0.
  void initial_word(std::uint32_t address, std::uint32_t value) noexcept;
  void initial_wire(std::uint32_t output, WireValue value) noexcept {
    if (output < wires_.size()) {
      wires_[output].value = value;
    }
  }
  // The event is high for one clock, from state edge + 1 on.
  void event(std::uint32_t number, Clock edge);

 private:
  struct Word {
    std::uint32_t value = 0;
    std::uint32_t before = 0;  // before edge `changed`
    Clock changed = never;
  };

  struct Event {
    std::optional<std::uint32_t> group;  // that it triggers
    Clock falls = never;                 // while it is high: the state in which it is low again
  };

  struct Lead {
    Component* sink;
    std::uint32_t input;
  };

  struct OutputWire {
    WireValue value;
    std::vector<Lead> leads;
    WireWatcher watcher;
  };

  struct Waiting {  // a value of a wire
    Clock edge;
    std::uint32_t input;
    WireValue value;
  };

  [[nodiscard]] Clock next_edge() const noexcept;
  void deliver(Clock edge);
  [[nodiscard]] Clock begun(Clock at);
  void lower(Clock state);
  void send(const Event& one, bool high, Clock state) const;
  [[nodiscard]] std::uint32_t seen(std::uint32_t address, Clock at) const noexcept;

  std::string writable_;
  bool snapshot_;
  std::vector<Word> words_;
  std::vector<std::uint32_t> write_words_;
  std::vector<std::uint32_t> frozen_;  // of the block that is open
  std::vector<char> thawed_;           // written in this block
  bool held_ = false;
  std::uint32_t inputs_;
  std::vector<OutputPin> outputs_;
  std::vector<Event> events_;
  EventSink sink_;
  std::uint32_t wires_in_;
  std::vector<OutputWire> wires_;
  std::vector<Component*> sources_;  // components with a wire to this one
  std::deque<Waiting> waiting_;      // in the order of their edges
  Clock state_ = 0;                  // everything before this edge has happened
  Clock free_at_ = 0;                // when the bus may begin another access
  std::uint32_t written_ = 0;
  Clock written_edge_ = never;  // the edge that sees `written`
};

// The model of the entity of `configuration`. nullptr: there is none, and its words are plain ones.
std::unique_ptr<Component> make_component(const ComponentConfiguration& configuration);

}  // namespace unitylink::device
