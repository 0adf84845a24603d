// SPDX-License-Identifier: BSD-3-Clause
// The model of bus_sequencer.vhd. A class below it is the bus, as spi_master.vhd is.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "device/component/component.hpp"
#include "device/component/ticker.hpp"

namespace unitylink::device {

// A byte that is to be exchanged.
struct BusRequest {
  bool first = false;  // begin a frame before it
  bool last = false;   // end the frame after it
  bool receive = false;
  std::uint8_t data = 0;
};

// Why a byte failed.
enum class BusFailure : std::uint32_t { none, no_answer, wrong_reply, refused };

class BusSequencer : public Component {
 public:
  explicit BusSequencer(const ComponentConfiguration& from);

 protected:
  // At `edge` the bus takes a request.
  virtual void begin(const BusRequest& request, Clock edge) = 0;
  // The next edge at which the bus does something by itself, and that edge.
  [[nodiscard]] virtual Clock next_of_bus() const noexcept = 0;
  virtual void step_bus(Clock edge) = 0;
  // At `edge` the byte has come, or it has failed. The sequencer sees it one clock later. The data of a refusal say
  // why.
  void reply(BusFailure failure, std::uint8_t data, Clock edge) noexcept;

 private:
  enum Register : std::uint32_t { control, status, failures, age, stamp, first_value };
  enum class State { fetching, running, exchanging };
  enum Operation : std::uint32_t { wait, sample, commit, ready, skip };

  [[nodiscard]] Clock next() const noexcept final;
  void step(Clock edge) final;
  void stored(std::uint32_t address, Clock edge) final;
  void look(std::uint32_t address, Clock state) final;

  [[nodiscard]] std::uint8_t byte_to_send() noexcept;
  void run(Clock edge);
  void operate(Clock edge);
  void answered(Clock edge);
  void keep();
  void go_on(Clock edge) noexcept;
  void go_to(std::uint32_t pc, Clock edge) noexcept;
  void start_anew(Clock edge) noexcept;
  void fail(Clock edge);
  void show(Clock edge);

  std::array<std::uint16_t, 256> program_{};
  std::uint32_t values_;
  std::uint32_t outputs_;
  std::uint32_t failures_most_;
  std::uint32_t data_mask_;
  Ticker tick_;  // of a microsecond

  State state_ = State::fetching;
  Clock due_ = 1;  // of the sequencer itself
  std::uint32_t pc_ = 0;
  std::uint32_t word_ = 0;
  bool enable_ = true;
  bool failing_ = false;
  bool valid_ = false;
  bool set_up_ = false;
  std::uint32_t reason_ = 0;
  std::uint32_t code_ = 0;   // of the last refusal
  std::uint32_t told_ = 0;   // outputs that were written
  std::uint32_t taken_ = 0;  // the output whose bytes are sent
  std::uint32_t failed_ = 0;
  std::uint32_t in_a_row_ = 0;
  Clock expired_from_ = 0;         // the first state in which the timer is zero
  std::uint64_t fresh_since_ = 0;  // the tick at the end of the last sample
  Clock replied_ = never;          // the state that has the reply
  BusFailure reply_failure_ = BusFailure::none;
  std::uint8_t reply_data_ = 0;
  std::uint32_t bank_ = 0;
  std::uint32_t pointer_ = 0;
  std::array<std::array<std::uint32_t, 32>, 2> banks_{};
};

}  // namespace unitylink::device
