// SPDX-License-Identifier: BSD-3-Clause
// The C side of compiled gateware: Verilator makes code from model.v, and this file gives it the function table of
// rtl_model.h. The build defines READ_WORDS, WRITE_WORDS, WRITTEN, GROUPS, PINS_IN, PINS_OUT and EITHER_EDGE. With
// EITHER_EDGE each edge of `clock` is a clock of the design, so one evaluation is enough for it. With ONE_TRIGGER the
// clock is also the only thing that Verilator's code waits for, so it need not be asked whether there was one.
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <string>
#include <type_traits>

#include <verilated.h>

#include "Vmodel.h"
#include "Vmodel___024root.h"
#include "unitylink/rtl_model.h"

#if ONE_TRIGGER
void Vmodel___024root___eval_nba(Vmodel___024root* root);
#endif

namespace {

struct Model {
  Model() : context(std::make_unique<VerilatedContext>()), top(std::make_unique<Vmodel>(context.get(), "model")) {}

  std::unique_ptr<VerilatedContext> context;
  std::unique_ptr<Vmodel> top;
  std::string failure;
};

thread_local Model* at_work = nullptr;

// A port of up to 64 bits is a number. A wider port is a list of 32-bit words.
template <class Port>
void put_bit(Port& port, std::uint32_t bit, bool value) {
  if constexpr (std::is_integral_v<Port>) {
    const Port mask = static_cast<Port>(Port{1} << bit);
    port = static_cast<Port>(value ? port | mask : port & ~mask);
  } else {
    put_bit(port.at(bit / 32), bit % 32, value);
  }
}

template <class Port>
[[maybe_unused]] std::uint32_t bit_of(const Port& port, std::uint32_t bit) {
  if constexpr (std::is_integral_v<Port>) {
    return static_cast<std::uint32_t>(port >> bit & 1u);
  } else {
    return bit_of(port.at(bit / 32), bit % 32);
  }
}

[[maybe_unused]] void put_word(IData& port, std::uint32_t, std::uint32_t value) { port = value; }
[[maybe_unused]] void put_word(QData& port, std::uint32_t index, std::uint32_t value) {
  port = (port & ~(QData{0xFFFFFFFF} << 32 * index)) | QData{value} << 32 * index;
}
template <std::size_t words>
void put_word(VlWide<words>& port, std::uint32_t index, std::uint32_t value) {
  port.at(index) = value;
}

// Verilator keeps 64 bits as one number. On this machine its lower half comes first, as in a wide port.
static_assert(std::endian::native == std::endian::little);
[[maybe_unused]] const std::uint32_t* words_of(const IData& port) { return &port; }
[[maybe_unused]] const std::uint32_t* words_of(const QData& port) {
  return reinterpret_cast<const std::uint32_t*>(&port);
}
template <std::size_t words>
const std::uint32_t* words_of(const VlWide<words>& port) {
  return port.data();
}

Model& model_of(void* handle) { return *static_cast<Model*>(handle); }

void* create() {
  auto* model = new (std::nothrow) Model;
  if (model != nullptr) {
    at_work = model;
    model->top->eval();
  }
  return model;
}

void destroy(void* handle) {
  Model& model = model_of(handle);
  model.top->final();
  delete &model;
}

void clock(void* handle, unitylink_rtl_pins* pins) {
  Model& model = model_of(handle);
  Vmodel& top = *model.top;
  at_work = &model;
  top.reset_next = pins->reset;
  top.rx_valid_next = pins->rx_valid;
  top.rx_data_next = pins->rx_data;
  top.rx_error_next = pins->rx_error;
  top.tx_ready_next = pins->tx_ready;
#if ONE_TRIGGER
  top.rootp->__VnbaTriggered.at(0) = 1;
  Vmodel___024root___eval_nba(top.rootp);
#elif EITHER_EDGE
  top.clock ^= 1;
  top.eval();
#else
  top.clock = 1;
  top.eval();
  top.clock = 0;
  top.eval();
#endif
  pins->rx_ready = top.rx_ready;
  pins->tx_valid = top.tx_valid;
  pins->tx_data = top.tx_data;
}

void set_word([[maybe_unused]] void* handle, [[maybe_unused]] std::uint32_t index,
              [[maybe_unused]] std::uint32_t value) {
#if READ_WORDS > 0
  put_word(model_of(handle).top->read_words, index, value);
#endif
}

const std::uint32_t* words([[maybe_unused]] const void* handle) {
#if WRITE_WORDS > 0
  return words_of(static_cast<const Model*>(handle)->top->write_words);
#else
  return nullptr;
#endif
}

std::uint32_t was_written([[maybe_unused]] const void* handle, [[maybe_unused]] std::uint32_t index) {
#if WRITTEN > 0
  return bit_of(static_cast<const Model*>(handle)->top->written, index);
#else
  return 0;
#endif
}

void set_event([[maybe_unused]] void* handle, [[maybe_unused]] std::uint32_t group,
               [[maybe_unused]] std::uint32_t high) {
#if GROUPS > 0
  put_bit(model_of(handle).top->events_next, group, high != 0);
#endif
}

void set_pin([[maybe_unused]] void* handle, [[maybe_unused]] std::uint32_t index, [[maybe_unused]] std::uint32_t high) {
#if PINS_IN > 0
  put_bit(model_of(handle).top->pins_in_next, index, high != 0);
#endif
}

template <class Port>
[[maybe_unused]] std::uint32_t part_of(const Port& port, std::uint32_t word) {
  if constexpr (std::is_integral_v<Port>) {
    return static_cast<std::uint32_t>(std::uint64_t{port} >> 32 * word);
  } else {
    return port.at(word);
  }
}

std::uint32_t get_pins([[maybe_unused]] const void* handle, [[maybe_unused]] std::uint32_t word) {
#if PINS_OUT > 0
  return part_of(static_cast<const Model*>(handle)->top->pins_out, word);
#else
  return 0;
#endif
}

const char* failure(const void* handle) { return static_cast<const Model*>(handle)->failure.c_str(); }

constexpr unitylink_rtl table = {UNITYLINK_RTL_ABI, READ_WORDS, WRITE_WORDS, GROUPS,    create,  destroy, clock,
                                 set_word,          words,      was_written, set_event, failure, PINS_IN, PINS_OUT,
                                 set_pin,           get_pins};

}  // namespace

// The netlist calls this when an assertion of the VHDL fails.
extern "C" void unitylink_failed(const char* place) {
  if (at_work != nullptr && at_work->failure.empty()) {
    at_work->failure = place;
  }
}

extern "C" __attribute__((visibility("default"))) const unitylink_rtl* unitylink_rtl_model(void) { return &table; }
