// SPDX-License-Identifier: BSD-3-Clause
// Link: one engine, one driver, one mutex. Every call may be made from any thread.
//
// Caller reads: a waiting caller polls the descriptor itself and dispatches whatever arrives, for others too; when its
// own answers are in it hands the role on. Only while there are subscriptions or asynchronous requests does a reader
// thread stand in, and it stands back as long as callers come.
#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "layer0_driver/descriptor.hpp"
#include "layer0_driver/driver.hpp"
#include "layer2_message/classic_engine.hpp"
#include "layer2_message/framed_engine.hpp"
#include "layer2_message/link_options.hpp"
#include "layer2_message/mapped_engine.hpp"
#include "layer2_message/reply_pace.hpp"

namespace unitylink {

struct RequestOptions {
  std::optional<bool> checked = std::nullopt;    // the link's default
  bool repeat = false;                           // sending it twice does no harm
  std::uint64_t timeout_ns = 0;                  // per attempt, 0: the link's default
  std::uint64_t until_ns = Engine::no_deadline;  // of link time: then it is given up, however many attempts are left
};

// One call of a vector form: its exchanges, and how they lie in the caller's arrays.
struct Call {
  std::vector<Exchange> exchanges;
  Batch batch;
  std::size_t block = 1;            // addresses in each exchange but the last
  std::span<std::uint32_t> values;  // of single reads, filled by result()
};

// What a framed device says about itself, from its control registers and its greeting.
struct Description {
  std::uint32_t version = 0;  // of the protocol: major in the upper half, minor in the lower
  std::uint32_t gateware_version = 0;
  std::uint32_t build = 0;
  std::uint32_t clock_hz = 0;
  std::uint32_t features = 0;     // bits of protocol::control_value
  std::uint32_t credit = 0;       // bytes of unanswered requests
  std::uint32_t request_max = 0;  // bytes of the longest payloads
  std::uint32_t reply_max = 0;
  std::uint32_t window = 0;         // requests in flight
  std::uint32_t cache = 0;          // bytes of a reply kept for a repeat
  std::uint32_t exchanges = 0;      // exchange groups
  std::uint32_t exchange_size = 0;  // words in each
  std::uint64_t spec_hash = 0;
};

// The device's clock in the host's time; period_ns 0: not known yet.
struct ClockState {
  double period_ns = 0;
  double drift_ppm = 0;
  double uncertainty_ns = 0;
};

struct SubscriptionRequest {
  std::span<const std::uint32_t> addresses;
  std::uint32_t divisor = 0;  // publish every so many base periods, 0: not by time
  bool on_event = false;      // publish when the group's event input says so
  bool verify = true;         // read every address once before: on 2012 gateware a silent one would publish for ever
  std::size_t ring = 4096;    // publishes kept until they are fetched
  std::optional<std::uint32_t> group = std::nullopt;  // of the gateware: the one with a certain event line; else any
};

// What has become of the line, or of the device behind it. Of a link that is opened again the order is lost, restarted
// (if it was), back.
struct LinkEvent {
  enum class Kind : std::uint8_t {
    lost,  // the line is gone, or the device silent; it is being opened again
    // the device has not gone on where it was: it was reset, or another host has had it. Its outputs are its own
    restarted,
    back,  // requests are taken again; subscriptions, groups and the dead-man are as they were
  };
  Kind kind = Kind::lost;
  std::uint64_t time_ns = 0;
  std::string text;
};

class Link {
 public:
  // Opens the port, resynchronises with the device whatever it was doing, and asks for its configuration.
  [[nodiscard]] static Outcome open(std::string_view url, std::unique_ptr<Link>& link);
  [[nodiscard]] static Outcome open(std::unique_ptr<Driver> driver, const LinkOptions& options,
                                    std::unique_ptr<Link>& link);
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;
  ~Link();

  [[nodiscard]] const Configuration& configuration() const noexcept { return configuration_; }
  [[nodiscard]] const LinkOptions& options() const noexcept { return options_; }
  [[nodiscard]] std::uint32_t usable_group_size() const noexcept;
  [[nodiscard]] bool framed() const noexcept { return framed_ != nullptr; }
  // "framed", "classic", or "memory", where there is no protocol.
  [[nodiscard]] const char* protocol() const noexcept { return framed_ ? "framed" : mapped_ ? "memory" : "classic"; }
  // Why the classic protocol is spoken although it was not asked for; empty: it was, or is not spoken.
  [[nodiscard]] const std::string& notice() const noexcept { return notice_; }
  // All zero on a classic link.
  [[nodiscard]] const Description& description() const noexcept { return description_; }
  // Was the gateware built from `spec` (what errors call it), which has one of `hashes`? mismatch: it says that it was
  // not. `unverified` is why that is not known, and what the user overrides by spec_hash=any; empty: it was.
  [[nodiscard]] Outcome check_spec(std::string_view spec, std::span<const std::uint64_t> hashes,
                                   std::string& unverified) const;
  [[nodiscard]] ClockState clock();

  [[nodiscard]] Outcome read(std::uint32_t address, std::uint32_t& value, const RequestOptions& how);
  // In blocks of what the device can hold; `atomic`: in one block or not at all.
  [[nodiscard]] Outcome read_many(std::span<const std::uint32_t> addresses, std::span<std::uint32_t> values,
                                  bool atomic, const RequestOptions& how);
  // One R each, as many in flight as window and credit allow.
  [[nodiscard]] Outcome read_each(std::span<const std::uint32_t> addresses, std::span<std::uint32_t> values,
                                  const RequestOptions& how);
  [[nodiscard]] Outcome write(std::uint32_t address, std::uint32_t value, const RequestOptions& how);
  // Words of mapped memory, while nobody else holds the link: an access takes less time than to give away what the
  // caller holds, such as Python's lock. False: nothing was done, and the call of the full form tells why, or waits.
  [[nodiscard]] bool read_at_once(std::uint32_t address, std::uint32_t& value) noexcept;
  [[nodiscard]] bool read_at_once(std::span<const std::uint32_t> addresses, std::span<std::uint32_t> values,
                                  bool atomic) noexcept;
  [[nodiscard]] bool write_at_once(std::uint32_t address, std::uint32_t value) noexcept;
  // In order; after one has failed no further one is sent. Outcome::index says which.
  [[nodiscard]] Outcome write_many(std::span<const std::uint32_t> addresses, std::span<const std::uint32_t> values,
                                   const RequestOptions& how);

  // Writes, then reads; one message each way where the protocol and the device's buffers allow. `atomic`: with the bus
  // held, or mismatch.
  [[nodiscard]] Outcome transfer(std::span<const std::uint32_t> write_addresses,
                                 std::span<const std::uint32_t> write_values, std::span<const std::uint32_t> addresses,
                                 std::span<std::uint32_t> values, bool atomic, const RequestOptions& how);
  // Any operations, in order; `values` has room for the words that are read. Framed: in one message where the device's
  // buffers allow, else in several that stay in order; `atomic`: in one, with the bus held, or mismatch. On a classic
  // link they are reads and writes, one after the other.
  [[nodiscard]] Outcome list(std::span<const ListWord> steps, std::span<std::uint32_t> values, bool atomic,
                             const RequestOptions& how);
  // Writes without answers, at the full rate of the line; sync() tells what became of them. Words of one call go out
  // together: where one fails, those behind it in its message are not executed. On a classic link they are ordinary
  // writes.
  [[nodiscard]] Outcome post(std::span<const std::uint32_t> addresses, std::span<const std::uint32_t> values,
                             const RequestOptions& how);
  // Returns when the device has executed all posts; bus_error when some of them failed since the last call, unknown
  // when a session was lost before it had confirmed some.
  [[nodiscard]] Outcome sync(const RequestOptions& how);
  // Names the words of an exchange group, once: `id` stands for it from then on, in later sessions too, until it is
  // released. mismatch where the device has no group left, or none so large. On a classic link it is kept here, and
  // exchange() is write_many() and read_many().
  [[nodiscard]] Outcome define_exchange(std::span<const ExchangeWord> outputs, std::span<const ExchangeWord> inputs,
                                        std::uint32_t& id);
  // Writes all outputs, then reads all inputs, with the bus held: only their data travels.
  [[nodiscard]] Outcome exchange(std::uint32_t id, std::span<const std::uint32_t> outputs,
                                 std::span<std::uint32_t> inputs, const RequestOptions& how);
  void release_exchange(std::uint32_t id);
  // The device's own registers (protocol::control); mismatch on a classic link.
  [[nodiscard]] Outcome read_control(std::uint32_t address, std::span<std::uint32_t> values, const RequestOptions& how);
  [[nodiscard]] Outcome write_control(std::uint32_t address, std::uint32_t value, const RequestOptions& how);

  // So many seconds of silence from here on make the outputs safe, 0: never. Signs of life are sent while nobody calls.
  // mismatch: it has none.
  [[nodiscard]] Outcome set_dead_man(double silence_s, const RequestOptions& how);
  // Lets outputs be written again after the dead-man has tripped, and starts it again; in another session if it tripped
  // in this one.
  [[nodiscard]] Outcome arm(const RequestOptions& how);
  // The dead-man watches the link; this makes the link watch the program. Where alive() is not called for `patience_s`,
  // the line is given up as if it were lost, and opened again (reconnect=1) when the program lives again; without
  // reconnect=1 the link ends. 0: never. range.
  [[nodiscard]] Outcome watch_program(double patience_s);
  // The program lives. Neither locks, waits nor allocates.
  void alive() noexcept;

  // `id` names the subscription from then on; an id never comes back. What the device sent before it stopped can be
  // drained until its group (group_of) is subscribed anew; then there is nothing behind the old id any more.
  [[nodiscard]] Outcome subscribe(const SubscriptionRequest& request, std::uint32_t& id);
  [[nodiscard]] static constexpr std::uint32_t group_of(std::uint32_t id) noexcept {
    return id % protocol::limits::groups_max;
  }
  [[nodiscard]] Outcome unsubscribe(std::uint32_t id);
  [[nodiscard]] bool subscribed(std::uint32_t id);
  [[nodiscard]] std::size_t words(std::uint32_t id);      // in each publish
  [[nodiscard]] std::size_t available(std::uint32_t id);  // publishes to drain
  [[nodiscard]] std::uint64_t lost(std::uint32_t id);     // overwritten before they were drained
  [[nodiscard]] std::uint64_t missing(std::uint32_t id);  // lost on the way; classic publishes do not tell
  std::size_t drain(std::uint32_t id, std::span<double> times_s, std::span<std::uint32_t> values);
  // True when there is something to drain; false after `timeout_ns`, or when link or subscription has ended.
  [[nodiscard]] bool wait_publish(std::uint32_t id, std::uint64_t timeout_ns);
  // How many publishes have come and subscriptions have ended in all; returns when that is no longer `seen`, after
  // `timeout_ns`, or when the link was closed.
  [[nodiscard]] std::uint64_t wait_publishes(std::uint64_t seen, std::uint64_t timeout_ns);
  // `descriptor` (an eventfd) is written to at every batch of publishes, and when the link closes.
  void notify_publishes(int descriptor);
  void forget_notification(int descriptor);

  // The vector calls in their parts, for asynchronous callers: plan, submit, and when all exchanges are done, result.
  // `addresses` and `values` must stay until then.
  [[nodiscard]] Outcome plan_read_many(Call& call, std::span<const std::uint32_t> addresses,
                                       std::span<std::uint32_t> values, bool atomic, const RequestOptions& how);
  [[nodiscard]] Outcome plan_read_each(Call& call, std::span<const std::uint32_t> addresses,
                                       std::span<std::uint32_t> values, const RequestOptions& how);
  [[nodiscard]] Outcome plan_write_many(Call& call, std::span<const std::uint32_t> addresses,
                                        std::span<const std::uint32_t> values, const RequestOptions& how);
  void submit(Call& call);
  // Nobody wants it any more: what has not been sent is not, the rest is not sent again. It is done as usual, if not at
  // once then soon.
  void withdraw(Call& call);
  [[nodiscard]] Outcome result(const Call& call);

  // Until requests are taken: at once, unless the line is gone and comes back (reconnect=1). down after `timeout_ns`,
  // closed when it has ended.
  [[nodiscard]] Outcome wait_up(std::uint64_t timeout_ns);
  // Those from number `from` on, of which the last 64 are kept; `from` becomes the number of the next. wait_publishes()
  // counts them, too.
  [[nodiscard]] std::vector<LinkEvent> events(std::uint64_t& from);
  // Another number whenever the device may not hold any more what was written to it: after each restart, and each time
  // the line has come back.
  [[nodiscard]] std::uint64_t generation() const noexcept { return generation_; }

  [[nodiscard]] Statistics statistics();
  [[nodiscard]] bool closed();
  // Ok while the link lives, then why it has ended; `by_itself`: not by close().
  [[nodiscard]] Outcome ending(bool& by_itself);
  // What did not go as wished although the link lives or lived, such as a trace that ends early; empty: nothing.
  [[nodiscard]] std::string warning();
  // Everything waiting ends with Status::closed, here and in other threads. Does not wait for a silent device.
  void close();
  // In a forked child, first of all: the link stays the parent's, and is closed here without a word to the device.
  void disown() noexcept;
  // Asked by threads that wait for an answer, about ten times a second, with no lock held; true makes them give their
  // request up.
  static void ask_while_waiting(bool (*interrupted)() noexcept) noexcept;

  // The time of deadlines and publishes, in which robots move: the real one, or that of the virtual boards in this
  // process.
  [[nodiscard]] std::uint64_t now_ns() const noexcept { return clock_(); }

 private:
  struct Subscription;
  struct ExchangeLayout;
  using Lock = std::unique_lock<std::mutex>;

  Link(std::unique_ptr<Driver> driver, std::unique_ptr<DriverSource> source, const LinkOptions& options);
  [[nodiscard]] static Outcome open(std::unique_ptr<Driver> driver, std::unique_ptr<DriverSource> source,
                                    const LinkOptions& options, std::unique_ptr<Link>& link);
  [[nodiscard]] Outcome begin();
  [[nodiscard]] Outcome begin_framed(std::uint64_t until_ns);
  void begin_mapped(MappedMemory& memory);
  [[nodiscard]] Outcome describe_device(const RequestOptions& how);

  // the wire (link.cpp)
  void run(std::span<Exchange> exchanges, std::uint64_t until_ns = Engine::no_deadline);
  void turn(Lock& lock, std::uint64_t until_ns) noexcept;
  void wait(Lock& lock, std::condition_variable& news, std::uint64_t until_ns) const noexcept;
  void flush(std::uint64_t now) noexcept;
  void lead(Lock& lock, std::uint64_t until_ns) noexcept;
  [[nodiscard]] static bool interrupted(Lock& lock) noexcept;
  void hand_over() noexcept;
  void wake() noexcept;
  void announce() noexcept;
  [[nodiscard]] Outcome end() const;  // why it has ended, with the mutex held
  void run_once(Lock& lock, std::span<Exchange> exchanges, std::uint64_t until_ns);
  [[nodiscard]] static bool was_cut(std::span<Exchange> exchanges) noexcept;
  void submit_all(std::span<Exchange> exchanges) noexcept;
  void fail(Status status, std::string_view reason) noexcept;
  void start_reader();
  void stop_reader();
  void stand_in(Lock& lock, std::condition_variable& elsewhere, std::uint64_t until_ns) noexcept;
  template <typename Ready>
  void listen(Lock& lock, std::uint64_t timeout_ns, Ready ready);
  void read_loop() noexcept;

  // the line that comes back (link_reconnect.cpp)
  enum class Line : std::uint8_t {
    up,
    gone,
    opening,  // the reader sets it up as it was; nobody else's requests are taken
  };
  [[nodiscard]] bool takes_requests() const noexcept;
  [[nodiscard]] bool waits_for_line(std::span<const Exchange> exchanges) const noexcept;
  [[nodiscard]] bool wait_for_line(Lock& lock, std::uint64_t until_ns);
  void last();
  void lose(Status status, std::string_view reason) noexcept;
  void tell(LinkEvent::Kind kind, std::string_view text) noexcept;
  void notice_restarts() noexcept;
  void reopen(Lock& lock);
  [[nodiscard]] Outcome restore();
  [[nodiscard]] Outcome stop_closed_groups();
  [[nodiscard]] std::uint64_t look_ns() const noexcept;
  [[nodiscard]] bool program_lives() const noexcept { return now_ns() < program_until_ns_; }
  void look_after(Lock& lock);

  // requests (link_requests.cpp)
  void prepare(Exchange& exchange, const RequestOptions& how) const noexcept;
  [[nodiscard]] Outcome check(const Exchange& exchange, std::size_t index);
  [[nodiscard]] Outcome check_address(std::uint32_t address, std::size_t index) const;
  [[nodiscard]] Outcome check_value(std::uint32_t address, std::uint32_t value, std::size_t index) const;
  [[nodiscard]] Outcome check_addresses(std::span<const std::uint32_t> addresses, std::size_t index) const;
  [[nodiscard]] Outcome check_writes(std::span<const std::uint32_t> addresses, std::span<const std::uint32_t> values,
                                     std::size_t index) const;
  [[nodiscard]] Outcome may_write();
  [[nodiscard]] std::size_t words_read(bool repeat) const noexcept;
  [[nodiscard]] std::size_t words_written() const noexcept;
  [[nodiscard]] std::size_t words_posted() const noexcept;
  [[nodiscard]] Outcome run_one(Exchange& exchange);
  [[nodiscard]] std::size_t words_at_once(bool repeat) const noexcept;
  [[nodiscard]] Outcome framed_only(const char* what) const;
  [[nodiscard]] Outcome check_list(std::span<const ListWord> steps, std::size_t room) const;
  [[nodiscard]] Outcome list_apart(std::span<const ListWord> steps, std::span<std::uint32_t> values,
                                   const RequestOptions& how);
  [[nodiscard]] std::size_t list_fits(std::span<const ListWord> steps) const noexcept;
  [[nodiscard]] Outcome check_exchange(const ExchangeLayout& layout) const;
  [[nodiscard]] Outcome outcome_of(const Exchange& exchange);

  // subscriptions (link_subscriptions.cpp)
  [[nodiscard]] Outcome check_subscription(const SubscriptionRequest& request);
  [[nodiscard]] Outcome quiet_device();
  [[nodiscard]] Outcome configure_group(std::uint32_t group, Subscription& subscription);
  [[nodiscard]] Outcome define_group(std::uint32_t group, std::span<const std::uint32_t> addresses,
                                     std::uint32_t divisor, bool on_event, PublishRing* ring);
  [[nodiscard]] Outcome set_rate(std::uint32_t group, std::uint32_t divisor);
  [[nodiscard]] Outcome set_event(std::uint32_t group, bool on);
  [[nodiscard]] Outcome stop_group(const Subscription& subscription, bool last);
  [[nodiscard]] Outcome command(Operation operation);
  [[nodiscard]] Subscription* find(std::uint32_t id) const noexcept;

  const LinkOptions options_;
  const Driver::TimeSource clock_;
  // replaced by the reader alone, with the mutex held and nobody leading; none while the line is gone
  std::unique_ptr<Driver> driver_;
  std::unique_ptr<DriverSource> source_;  // of it, where the link was opened by a URL
  Configuration configuration_;
  Description description_;
  std::string notice_;
  bool checksums_ = true;  // false: the device's datalink knows no '$'
  Descriptor wake_descriptor_;
  Descriptor cancel_descriptor_;  // readable once the link ends

  std::mutex mutex_;                   // all below, up to the next mutex
  std::condition_variable turn_;       // followers: something was finished, or the role is free
  std::condition_variable published_;  // those who wait for publishes, while somebody else reads
  std::condition_variable idle_;       // the reader, while others read for themselves
  ClassicEngine classic_;
  std::unique_ptr<FramedEngine> framed_;  // once the device has shown that it speaks it
  std::unique_ptr<MappedEngine> mapped_;  // where the registers are memory
  Engine* engine_ = &classic_;            // the one of the three that is used
  std::array<std::shared_ptr<const ExchangeLayout>, protocol::limits::exchanges_max> exchanges_;
  std::vector<std::shared_ptr<const ExchangeLayout>> released_exchanges_;  // that the engine may still read
  std::uint32_t exchanges_made_ = 0;
  std::uint32_t dead_man_ticks_ = 0;  // as set last
  std::uint32_t failed_posts_ = 0;    // of this session, told by the last sync()
  std::uint64_t failed_session_ = 0;
  std::string reason_;  // why the link has ended
  bool lasts_ = false;  // the line is opened again when it is lost
  Line line_ = Line::up;
  std::string lost_because_;
  std::uint64_t lost_ns_ = 0;   // when what was under way was last cut off
  std::string trouble_;         // why it could not be opened again, the last time
  std::uint32_t attempts_ = 0;  // to open it again, since it was lost
  std::thread::id restorer_;
  std::uint64_t heard_ns_ = 0;  // when the last byte came
  std::uint64_t restarts_seen_ = 0;
  std::deque<LinkEvent> events_;
  std::uint64_t events_made_ = 0;
  std::atomic<std::uint64_t> generation_ = 0;
  std::atomic<std::uint64_t> program_patience_ns_ = 0;  // 0: nobody watches the program
  std::atomic<std::uint64_t> program_until_ns_ = Engine::no_deadline;
  ReplyPace pace_;
  bool leading_ = false;
  bool blocked_ = false;  // the driver took less than it was offered
  std::uint64_t leading_until_ns_ = 0;
  bool reader_leading_ = false;  // the leader waits for no answer
  bool reader_rests_ = false;    // until who waits for publishes has gone
  unsigned followers_ = 0;       // wait for turn_
  unsigned callers_ = 0;         // wait for answers, leading or not
  std::uint64_t last_call_ns_ = 0;
  std::thread::id last_caller_;
  unsigned listeners_ = 0;  // wait for publishes, leading or not
  std::uint64_t last_listened_ns_ = 0;
  std::vector<int> notified_;
  std::array<std::shared_ptr<Subscription>, protocol::limits::groups_max> subscriptions_;
  std::vector<std::shared_ptr<Subscription>> released_subscriptions_;  // that the engine may still read
  std::uint64_t subscriptions_ended_ = 0;
  bool reader_wanted_ = false;

  std::mutex configuring_;  // one subscribe or unsubscribe at a time
  // the host's shadow: bit g of the mask is group g
  std::array<std::uint8_t, protocol::limits::groups_max / 8> event_mask_{};
  bool quieted_ = false;
  std::thread reader_;
  std::mutex reader_mutex_;
  bool reader_kept_ = false;  // an asynchronous user keeps it for the link's life

  std::atomic<Gateware> gateware_;
  std::array<std::uint8_t, 65536> received_;
};

}  // namespace unitylink
