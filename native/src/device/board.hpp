// SPDX-License-Identifier: BSD-3-Clause
// A running device: a thread serves it on an endpoint. Its clock follows the common time of all virtual boards in this
// process.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "device/endpoint.hpp"
#include "device/served_device.hpp"
#include "device/tosnet.hpp"
#include "device/word_plant.hpp"
#include "layer0_driver/lockstep.hpp"
#include "layer0_driver/robot_time.hpp"

namespace unitylink::device {

// The simulated machine behind the registers. The board's thread calls `step` without its lock, every `period_s` of
// device time. If it returns false, the stepping ends, and the board continues to serve.
struct PlantHook {
  double period_s = 0;
  std::function<bool(double time_s)> step;
};

struct BoardStatistics {
  DeviceStatistics device;
  std::uint64_t clients = 0;        // clients so far
  std::uint64_t bytes_dropped = 0;  // bytes published without a client
  std::uint64_t plant_steps = 0;    // with those that were left out
  double time_slipped_s = 0;        // how late the device clock is because the machine was too busy
};

// An output pin of a component, since the board was made.
struct SeenPin {
  bool level = false;
  std::uint64_t rises = 0;
  std::int64_t steps = 0;
  double high_s = 0;
  double time_s = 0;  // when it was looked at
};

// A client that leaves frees the board, and its settings stay. Publishing continues without a client, as on a real
// board. A client that does not read fills the transmit FIFO, and the device stops, as gateware does. All calls may
// come from any thread.
class Board : private Lockstep::Member {
 public:
  Board(std::unique_ptr<ServedDevice> device, std::unique_ptr<Endpoint> endpoint);
  // Serves the twin. `configuration.problem()` must be empty.
  Board(const DeviceConfiguration& configuration, std::unique_ptr<Endpoint> endpoint);
  ~Board() override;

  void set_plant(PlantHook hook);  // before start(), or after begin_anew()
  // A plant of words. Where its words settle, it makes only the steps that can be seen, and the thread sleeps
  // meanwhile.
  void set_plant(double period_s, WordPlant words);
  // With the endpoint "lockstep" it has no thread: whoever waits at a link runs it. Throws TimeConflict.
  void start();
  [[nodiscard]] bool in_steps() const noexcept { return in_steps_; }
  // Begins again as a board that has just been made, with a device that has. The line to the client ends, and the plant
  // makes no step until set_plant(). False: its time does not go in steps, it has stopped, or its plant is in a step.
  bool begin_anew(std::unique_ptr<ServedDevice> device);
  // Idempotent. Waits for the thread, and so for a step of the plant, unless this step itself calls it.
  void stop();

  std::string url();
  [[nodiscard]] double time_s();
  BusReply get(std::uint32_t address);
  BusStatus set(std::uint32_t address, std::uint32_t value);
  // Several of one moment. They return how many words it were, up to the first one that cannot be read, or set.
  std::size_t get(std::span<const std::uint32_t> addresses, std::span<std::uint32_t> words);
  std::size_t set(std::span<const std::uint32_t> addresses, std::span<const std::uint32_t> words);
  // For the state of a board that a new one gets: a word, and the plant's own clock. While the plant is held it makes
  // no step. release_plant() lets it go on as the other one would have gone on.
  BusStatus preset(std::uint32_t address, std::uint32_t value);
  BusStatus write(std::uint32_t address, std::uint32_t value);  // as the dead-man does; only the twin can
  struct PlantPhase {
    Clock clock = never;  // of its next step. never: it makes none
    Clock wait = 0;       // until then
  };
  PlantPhase plant_phase();
  void hold_plant();
  void release_plant(const PlantPhase& phase);
  void set_event(std::uint32_t group, bool high);
  void pulse_event(std::uint32_t group);
  void receive_error(std::uint8_t bits);
  void hang_up();  // the line to the client breaks; the device continues
  bool async_take(AsyncWord& word);
  bool async_give(const AsyncWord& word);
  // The pins of components: their outside. False or nothing: there is no such pin.
  bool drive(std::uint32_t component, std::uint32_t pin, bool level);
  bool turn(std::uint32_t component, const EncoderLines& lines, std::int64_t counts, double seconds);
  bool modulate(std::uint32_t component, const ModulatorLines& lines, double level, double seconds);
  bool attach(std::uint32_t component, const DeviceLines& lines);
  // Calls `use` with the device whose first line is this output of a component. False: there is none.
  bool with_device(std::uint32_t component, std::uint32_t out, const std::function<void(BusDevice&)>& use);
  bool count_by(std::uint32_t component, std::uint32_t pin, std::uint32_t direction);
  // Levels of an input, each so many seconds from now, and the edges of an output with their times.
  using PinLevels = std::vector<std::pair<double, bool>>;
  void play(std::uint32_t component, std::uint32_t pin, const PinLevels& levels);
  std::optional<PinLevels> edges(std::uint32_t component, std::uint32_t pin);
  std::optional<SeenPin> look(std::uint32_t component, std::uint32_t pin);
  void set_online(bool online);  // this call and the next three are for the TosNet
  bool set_ring(std::uint32_t ring, bool whole);
  bool set_node(std::uint32_t id, bool present);
  void damage_cycle();
  BoardStatistics statistics();
  std::string failure();  // why the device has stopped; empty while it runs
  [[nodiscard]] const DeviceConfiguration& configuration() const noexcept { return device_->configuration(); }

 private:
  // Locks for a call from another thread. A caller in a tight loop could take the mutex again and again, and keep the
  // board's thread waiting. So callers let the board's thread go first.
  [[nodiscard]] std::unique_lock<std::mutex> enter();
  void come_back(std::unique_lock<std::mutex>& lock);  // locks for the board's thread
  // unlocks for waiting callers, while the board's thread makes no pause
  void let_in(std::unique_lock<std::mutex>& lock);

  void serve();
  void end();
  // in steps (board_steps.cpp)
  [[nodiscard]] std::uint64_t due_ns() noexcept override;
  void take_in() noexcept override;
  void work(std::uint64_t until_ns) noexcept override;
  void catch_up();
  [[nodiscard]] Clock next_clock() const noexcept;
  [[nodiscard]] Clock in_time(Clock target);
  [[nodiscard]] Clock within_reach(Clock target) const noexcept;
  // the plant (board_plant.cpp)
  void begin_plant(double period_s);
  void step_plant(std::unique_lock<std::mutex>& lock, Clock until);
  void step_words(Clock until);
  [[nodiscard]] Clock seen_step(Clock until) const noexcept;
  void go_on_to(Clock step) noexcept;
  [[nodiscard]] Clock plant_due() const noexcept { return leaves_out_ ? never : plant_next_; }
  void run_to_plant(Clock until);
  [[nodiscard]] bool wait(std::unique_lock<std::mutex>& lock);
  // the client (board_client.cpp)
  static constexpr std::size_t chunk_bytes = 16384;  // of output at once
  bool feed();
  [[nodiscard]] bool gather();
  void flush();
  void forget_output();
  void wake();
  void tell_due();
  [[nodiscard]] std::uint64_t robot_ns(Clock clock) const noexcept;
  [[nodiscard]] Clock clock_now() const noexcept;

  std::mutex mutex_;
  std::atomic<bool> board_waits_ = false;
  std::atomic<int> callers_ = 0;  // callers that wait for the mutex
  std::unique_ptr<ServedDevice> device_;
  std::unique_ptr<Endpoint> endpoint_;
  PlantHook plant_;
  std::optional<WordPlant> words_;  // in place of plant_
  Clock settle_ = never;            // of these words
  bool leaves_out_ = false;         // the plant makes only the steps that can be seen
  Clock plant_period_ = 0;
  Clock plant_next_ = never;
  Clock plant_offset_ = 0;  // from the device's clock to the plant's, which may have begun in another board
  BoardStatistics statistics_;
  std::vector<std::uint8_t> output_;  // taken from the device and not yet sent
  std::size_t output_sent_ = 0;
  bool output_blocked_ = false;
  bool fed_ = false;              // the device has just got bytes
  bool full_ = false;             // it had no room for more, so the endpoint may have kept some
  bool look_ = true;              // the endpoint may have a new client, or bytes
  bool at_rest_ = true;           // the last byte sent ended a message
  std::uint64_t start_ns_ = 0;    // robot time
  std::uint64_t started_ns_ = 0;  // real time
  RobotTime::Follower follower_{RobotTime::here()};
  Clock slip_ = 0;
  Clock lead_ = 0;
  Clock linger_until_ = 0;  // when a client that sends nothing more is dismissed
  int wake_ = -1;
  std::atomic<bool> stop_ = false;
  bool in_steps_ = false;
  bool plant_steps_now_ = false;
  std::uint64_t caught_up_ns_ = 0;  // robot time until which it has worked
  bool started_ = false;
  std::thread thread_;
};

}  // namespace unitylink::device
