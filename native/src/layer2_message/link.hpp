// SPDX-License-Identifier: BSD-3-Clause
// Link: one engine, one driver, one mutex. Every call may be made from any thread.
//
// The caller reads. A thread that waits for an answer polls the descriptor itself, and dispatches all that arrives,
// also for other threads. It is then the leader. When it has its answers, it passes this role on. A reader thread
// exists only if there are subscriptions or asynchronous requests. It does not read while callers do.
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
#include "layer0_driver/lockstep.hpp"
#include "layer2_message/classic_engine.hpp"
#include "layer2_message/framed_engine.hpp"
#include "layer2_message/link_options.hpp"
#include "layer2_message/mapped_engine.hpp"
#include "layer2_message/reply_pace.hpp"
#include "layer2_message/subscription_request.hpp"

namespace unitylink {

struct RequestOptions {
  std::optional<bool> checked = std::nullopt;  // the link's default
  bool repeat = false;                         // the request may be sent twice without harm
  std::uint64_t timeout_ns = 0;                // for each attempt; 0: the link's default
  // in link time: the request is given up then, even if attempts are left
  std::uint64_t until_ns = Engine::no_deadline;
};

// One vector call: its exchanges, and their places in the caller's arrays.
struct Call {
  std::vector<Exchange> exchanges;
  Batch batch;
  std::size_t block = 1;            // addresses in each exchange; the last one may have fewer
  std::span<std::uint32_t> values;  // for single reads: result() writes the words here
};

// What a framed device reports about itself in its control registers and its answer to HELLO.
struct Description {
  std::uint32_t version = 0;  // version of the protocol: major in the upper half, minor in the lower
  std::uint32_t gateware_version = 0;
  std::uint32_t build = 0;
  std::uint32_t clock_hz = 0;
  std::uint32_t features = 0;       // bits of protocol::control_value
  std::uint32_t credit = 0;         // bytes of unanswered requests
  std::uint32_t request_max = 0;    // bytes of the longest request payload
  std::uint32_t reply_max = 0;      // bytes of the longest reply payload
  std::uint32_t window = 0;         // requests in flight
  std::uint32_t cache = 0;          // bytes of a reply that the device keeps for a repeat
  std::uint32_t exchanges = 0;      // exchange groups
  std::uint32_t exchange_size = 0;  // words in each exchange group
  std::uint64_t spec_hash = 0;
};

// The device's clock, measured with the host's clock. period_ns is 0 until it is known.
struct ClockState {
  double period_ns = 0;
  double drift_ppm = 0;
  double uncertainty_ns = 0;
};

// A change of the line or of the device. When a link with reconnect=1 loses its line, the events are lost, restarted
// (if the device was reset), and back.
struct LinkEvent {
  enum class Kind : std::uint8_t {
    lost,  // the line is gone, or the device is silent; the link opens it again
    // the device was reset, or another host used it. Its outputs may differ from what was written
    restarted,
    back,  // requests are accepted again; subscriptions, groups and the dead-man are set up as before
  };
  Kind kind = Kind::lost;
  std::uint64_t time_ns = 0;
  std::string text;
};

class Link {
 public:
  // Opens the port, resynchronises with the device, and asks for its configuration.
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
  // "framed", "classic", or "memory" (no protocol).
  [[nodiscard]] const char* protocol() const noexcept { return framed_ ? "framed" : mapped_ ? "memory" : "classic"; }
  // Why the link speaks the classic protocol although the URL does not ask for it. Empty in all other cases.
  [[nodiscard]] const std::string& notice() const noexcept { return notice_; }
  // All zero on a classic link.
  [[nodiscard]] const Description& description() const noexcept { return description_; }
  // Checks that the gateware was built from the spec that has one of these hashes. `spec` is its name in errors.
  // mismatch: the gateware reports another hash. `unverified` gets the reason why the result is not known, or was
  // overridden by spec_hash=any. It is empty if the gateware has the right hash.
  [[nodiscard]] Outcome check_spec(std::string_view spec, std::span<const std::uint64_t> hashes,
                                   std::string& unverified) const;
  [[nodiscard]] ClockState clock();

  [[nodiscard]] Outcome read(std::uint32_t address, std::uint32_t& value, const RequestOptions& how);
  // Reads blocks, each as large as the device allows. `atomic`: all in one block, else mismatch.
  [[nodiscard]] Outcome read_many(std::span<const std::uint32_t> addresses, std::span<std::uint32_t> values,
                                  bool atomic, const RequestOptions& how);
  // Reads each word by its own request. As many requests are in flight as window and credit allow.
  [[nodiscard]] Outcome read_each(std::span<const std::uint32_t> addresses, std::span<std::uint32_t> values,
                                  const RequestOptions& how);
  [[nodiscard]] Outcome write(std::uint32_t address, std::uint32_t value, const RequestOptions& how);
  // Accesses mapped memory without waiting. The caller may hold a lock meanwhile, such as Python's: the access is
  // shorter than giving the lock away. False: nothing was done, because another thread uses the link, or the access
  // fails. Then call the full form, which waits, or gives the error.
  [[nodiscard]] bool read_at_once(std::uint32_t address, std::uint32_t& value) noexcept;
  [[nodiscard]] bool read_at_once(std::span<const std::uint32_t> addresses, std::span<std::uint32_t> values,
                                  bool atomic) noexcept;
  [[nodiscard]] bool write_at_once(std::uint32_t address, std::uint32_t value) noexcept;
  // Writes in order. After a failed write no further one is sent. Outcome::index is the number of the failed one.
  [[nodiscard]] Outcome write_many(std::span<const std::uint32_t> addresses, std::span<const std::uint32_t> values,
                                   const RequestOptions& how);

  // Writes, then reads, in one message each way if the protocol and the device's buffers allow. `atomic`: with the bus
  // held, else mismatch.
  [[nodiscard]] Outcome transfer(std::span<const std::uint32_t> write_addresses,
                                 std::span<const std::uint32_t> write_values, std::span<const std::uint32_t> addresses,
                                 std::span<std::uint32_t> values, bool atomic, const RequestOptions& how);
  // Does any operations in order. `values` has room for the words that are read. On a framed link they go in one
  // message if the device's buffers allow, else in several, still in order. `atomic`: in one message with the bus held,
  // else mismatch. On a classic link they are single reads and writes.
  [[nodiscard]] Outcome list(std::span<const ListWord> steps, std::span<std::uint32_t> values, bool atomic,
                             const RequestOptions& how);
  // Writes without answers, at the full rate of the line. sync() gives the result. The words of one call are sent
  // together. If one fails, those after it in its message are not executed. On a classic link these are ordinary
  // writes.
  [[nodiscard]] Outcome post(std::span<const std::uint32_t> addresses, std::span<const std::uint32_t> values,
                             const RequestOptions& how);
  // Returns when the device has executed all posts. bus_error: some failed since the last call. unknown: a session was
  // lost before the device had confirmed all its posts.
  [[nodiscard]] Outcome sync(const RequestOptions& how);
  // Defines an exchange group: its words are named once. `id` stands for it until it is released, also in later
  // sessions. mismatch: the device has no group left, or none so large. On a classic link the link keeps the group, and
  // exchange() is write_many() and read_many().
  [[nodiscard]] Outcome define_exchange(std::span<const ExchangeWord> outputs, std::span<const ExchangeWord> inputs,
                                        std::uint32_t& id);
  // Writes all outputs, then reads all inputs, with the bus held. Only data is sent, without addresses.
  [[nodiscard]] Outcome exchange(std::uint32_t id, std::span<const std::uint32_t> outputs,
                                 std::span<std::uint32_t> inputs, const RequestOptions& how);
  void release_exchange(std::uint32_t id);
  // Reads and writes the device's own registers (protocol::control). mismatch: a classic link.
  [[nodiscard]] Outcome read_control(std::uint32_t address, std::span<std::uint32_t> values, const RequestOptions& how);
  [[nodiscard]] Outcome write_control(std::uint32_t address, std::uint32_t value, const RequestOptions& how);

  // Sets the dead-man: after `silence_s` seconds without a message from this link, the gateware makes its outputs safe.
  // 0: never. The link sends signs of life while nobody calls. mismatch: the gateware has no dead-man.
  [[nodiscard]] Outcome set_dead_man(double silence_s, const RequestOptions& how);
  // Allows writes again after it has tripped, and starts it. If it tripped in the open session, another one begins.
  [[nodiscard]] Outcome arm(const RequestOptions& how);
  // It has tripped: it gets no more signs of life, and arm() starts it with `ticks`. Nothing is sent.
  void rest_dead_man(std::uint32_t ticks);
  [[nodiscard]] std::uint32_t dead_man_ticks();  // the last setting; 0: none
  // Makes the outputs safe now, as the dead-man does; arm() starts it as before. Nothing is sent meanwhile: for two
  // ticks of the base frequency and 0.4 ms. mismatch: the gateware has no dead-man.
  [[nodiscard]] Outcome trip(const RequestOptions& how);
  // The dead-man watches the link. This call makes the link also watch the program. If alive() is not called for
  // `patience_s`, the link gives its line up. With reconnect=1 the line is opened again at the next call of alive(),
  // else the link ends. 0: the program is not watched. range: more than an hour.
  [[nodiscard]] Outcome watch_program(double patience_s);
  // Says that the program works. It never locks, waits or allocates.
  void alive() noexcept;

  // `id` is the number of the subscription. No number is used twice. After unsubscribe(), earlier publishes can still
  // be drained, until another subscription gets the same group (group_of).
  [[nodiscard]] Outcome subscribe(const SubscriptionRequest& request, std::uint32_t& id);
  // Reads each address once, as subscribe() does with `verify`.
  [[nodiscard]] Outcome verify(std::span<const std::uint32_t> addresses);
  [[nodiscard]] static constexpr std::uint32_t group_of(std::uint32_t id) noexcept {
    return id % protocol::limits::groups_max;
  }
  [[nodiscard]] Outcome unsubscribe(std::uint32_t id);
  [[nodiscard]] bool subscribed(std::uint32_t id);
  [[nodiscard]] std::size_t words(std::uint32_t id);      // number of words in each publish
  [[nodiscard]] std::size_t available(std::uint32_t id);  // number of publishes to drain
  [[nodiscard]] std::uint64_t lost(std::uint32_t id);     // overwritten before they were drained
  [[nodiscard]] std::uint64_t missing(std::uint32_t id);  // lost on the line; classic: always 0, it cannot know
  std::size_t drain(std::uint32_t id, std::span<double> times_s, std::span<std::uint32_t> values);
  void drain(std::uint32_t id, Drained& to);  // all that waits; the memory of `to` is used again
  // True: there is something to drain. False: `timeout_ns` is over, or the link or the subscription has ended.
  [[nodiscard]] bool wait_publish(std::uint32_t id, std::uint64_t timeout_ns);
  // Waits for any news. The result counts all publishes, ended subscriptions and events so far. Returns when this count
  // differs from `seen`, after `timeout_ns`, or when the link was closed.
  [[nodiscard]] std::uint64_t wait_publishes(std::uint64_t seen, std::uint64_t timeout_ns);
  // Writes to `descriptor`, an eventfd, whenever publishes have arrived, and when the link closes.
  void notify_publishes(int descriptor);
  void forget_notification(int descriptor);

  // The steps of a vector call, for asynchronous callers: plan, submit, and result when all exchanges are done.
  // `addresses` and `values` must exist until then.
  [[nodiscard]] Outcome plan_read_many(Call& call, std::span<const std::uint32_t> addresses,
                                       std::span<std::uint32_t> values, bool atomic, const RequestOptions& how);
  [[nodiscard]] Outcome plan_read_each(Call& call, std::span<const std::uint32_t> addresses,
                                       std::span<std::uint32_t> values, const RequestOptions& how);
  [[nodiscard]] Outcome plan_write_many(Call& call, std::span<const std::uint32_t> addresses,
                                        std::span<const std::uint32_t> values, const RequestOptions& how);
  void submit(Call& call);
  // Gives a call up. Nothing of it is sent any more. What is in flight ends as usual, so the call is done soon.
  void withdraw(Call& call);
  [[nodiscard]] Outcome result(const Call& call);

  // Waits until requests are accepted. It returns at once, unless the line is gone and is being opened again
  // (reconnect=1). down: not within `timeout_ns`. closed: the link has ended.
  [[nodiscard]] Outcome wait_up(std::uint64_t timeout_ns);
  // Returns the events from number `from` on, and sets `from` to the number of the next event. The last 64 are kept.
  [[nodiscard]] std::vector<LinkEvent> events(std::uint64_t& from);
  // A number that changes each time the device may have lost what was written to it: after each restart, and each time
  // the line has come back.
  [[nodiscard]] std::uint64_t generation() const noexcept { return generation_; }

  [[nodiscard]] Statistics statistics();
  [[nodiscard]] bool closed();
  // Why the link has ended; ok: it has not. `by_itself` is false if this program closed it.
  [[nodiscard]] Outcome ending(bool& by_itself);
  // A problem that does not end the link, such as a trace that ended early. Empty: none.
  [[nodiscard]] std::string warning();
  // Ends the link. All waiting calls, also in other threads, return Status::closed. It does not wait for a silent
  // device.
  void close();
  // The first call in a forked child. The link belongs to the parent, so this closes it without a message to the
  // device.
  void disown() noexcept;
  // Threads that wait for an answer call `interrupted` about ten times a second, with no lock held. If it returns true,
  // they give their request up.
  static void ask_while_waiting(bool (*interrupted)() noexcept) noexcept;

  // For a thread with a loop of its own (link_attend.cpp), such as a server's. It keeps the role of the leader from
  // one call of attend() to the next, so no other thread reads meanwhile.
  // Adds a request. It is sent in the next call of attend(). `on_done` is called in the thread that reads.
  void enqueue(Exchange& exchange);
  // How many requests are queued and not sent yet. push() sends what the line takes now.
  [[nodiscard]] std::size_t backlog();
  void push();
  // Sends what is queued. Waits for the device, for `other` to be readable, or until `until_ns`. `looking`: answers are
  // expected, so it looks before it sleeps. False: the line is gone, or the link has ended.
  bool attend(int other, std::uint64_t until_ns, bool looking);
  // Lets other threads read. Call it before any other method of the link that waits for an answer.
  void leave();
  // As leave(), and waits for `other`. Whoever asks then reads his answer himself, and need not be woken.
  bool rest(int other, std::uint64_t until_ns);
  void withdraw(Exchange& exchange);  // gives a queued request up
  // From now on `tap` gets all publishes of a framed link, too. nullptr: no longer.
  void tap_publishes(PublishTap* tap);
  // A subscription of which nothing is kept gets a listener, who can drain up to `ring` publishes, and a new number.
  [[nodiscard]] Outcome keep_publishes(std::uint32_t& id, std::size_t ring);
  // For the listener this is the end of the subscription. The device goes on, for a tap.
  void keep_no_more(std::uint32_t id);

  // The time of deadlines and publishes: real time, or the robot time of the virtual boards in this process.
  [[nodiscard]] std::uint64_t now_ns() const noexcept { return clock_(); }
  // Whether this robot time goes in steps, while a call waits. Otherwise time passes by itself.
  [[nodiscard]] bool in_steps() const noexcept { return step_ != nullptr; }
  // Waits until now_ns() is `until_ns`. In steps, boards and links advance so far. closed: the link has ended.
  [[nodiscard]] Outcome pass(std::uint64_t until_ns);

 private:
  struct Subscription;
  struct ExchangeLayout;
  class Step;  // this link as a member of Lockstep (link_steps.cpp)
  using Lock = std::unique_lock<std::mutex>;
  // How often a thread that waits asks whether it is interrupted.
  static constexpr std::uint64_t interruption_patience_ns = 100'000'000;

  Link(std::unique_ptr<Driver> driver, std::unique_ptr<DriverSource> source, const LinkOptions& options);
  [[nodiscard]] static Outcome open(std::unique_ptr<Driver> driver, std::unique_ptr<DriverSource> source,
                                    const LinkOptions& options, std::unique_ptr<Link>& link);
  [[nodiscard]] Outcome begin();
  [[nodiscard]] Outcome begin_framed(std::uint64_t until_ns, std::uint32_t attempts);
  void begin_mapped(MappedMemory& memory);
  [[nodiscard]] Outcome describe_device(const RequestOptions& how);

  // the wire (link.cpp)
  void run(std::span<Exchange> exchanges, std::uint64_t until_ns = Engine::no_deadline);
  void turn(Lock& lock, std::uint64_t until_ns) noexcept;
  void wait(Lock& lock, std::condition_variable& news, std::uint64_t until_ns) const noexcept;
  void flush(std::uint64_t now) noexcept;
  void lead(Lock& lock, std::uint64_t until_ns, int other = -1) noexcept;
  void touch_steps() noexcept;
  [[nodiscard]] int poll_until(std::uint64_t until_ns, std::span<pollfd> waiting) noexcept;
  [[nodiscard]] static bool interrupted(Lock& lock) noexcept;
  void hand_over() noexcept;
  void wake() noexcept;
  void announce() noexcept;
  [[nodiscard]] Outcome end() const;  // why the link has ended; call it with the mutex held
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
    opening,  // the reader sets the device up as before; requests of other threads are refused
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
  [[nodiscard]] static std::unique_ptr<Lockstep::Member> step_of(Link& link, Driver::TimeSource clock);
  void join_steps();
  void leave_steps();
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
  [[nodiscard]] static Outcome check_ring(std::size_t ring, std::size_t words);
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
  const std::unique_ptr<Lockstep::Member> step_;  // nullptr: time passes by itself
  // Only the reader replaces it, with the mutex held and without a leader. nullptr while the line is gone.
  std::unique_ptr<Driver> driver_;
  std::unique_ptr<DriverSource> source_;  // opens the driver again; nullptr if the link was not opened by a URL
  Configuration configuration_;
  Description description_;
  std::string notice_;
  bool checksums_ = true;  // false: the device's datalink does not know '$'
  Descriptor wake_descriptor_;
  std::atomic<bool> woken_ = false;
  Descriptor cancel_descriptor_;  // becomes readable when the link ends

  std::mutex mutex_;                   // guards all below, up to the next mutex
  std::condition_variable turn_;       // for followers: a request was finished, or there is no leader
  std::condition_variable published_;  // for threads that wait for publishes while another thread reads
  std::condition_variable idle_;       // for the reader, while other threads read
  ClassicEngine classic_;
  std::unique_ptr<FramedEngine> framed_;  // nullptr until the device has shown that it speaks this protocol
  std::unique_ptr<MappedEngine> mapped_;  // if the registers are memory of this machine
  Engine* engine_ = &classic_;            // the engine in use, one of these three
  std::array<std::shared_ptr<const ExchangeLayout>, protocol::limits::exchanges_max> exchanges_;
  std::vector<std::shared_ptr<const ExchangeLayout>> released_exchanges_;  // the engine may still read them
  std::uint32_t exchanges_made_ = 0;
  std::uint32_t dead_man_ticks_ = 0;  // the last setting
  std::uint32_t failed_posts_ = 0;    // number in this session, at the last sync()
  std::uint64_t failed_session_ = 0;
  std::string reason_;  // why the link has ended
  bool lasts_ = false;  // reconnect=1: a lost line is opened again
  Line line_ = Line::up;
  std::string lost_because_;
  std::uint64_t lost_ns_ = 0;   // when the line was last lost
  std::string trouble_;         // why the last attempt to open it again failed
  std::uint32_t attempts_ = 0;  // attempts to open it again since it was lost
  std::thread::id restorer_;
  std::uint64_t heard_ns_ = 0;  // when the last byte arrived
  std::uint64_t restarts_seen_ = 0;
  std::deque<LinkEvent> events_;
  std::uint64_t events_made_ = 0;
  std::atomic<std::uint64_t> generation_ = 0;
  std::atomic<std::uint64_t> program_patience_ns_ = 0;  // 0: the program is not watched
  std::atomic<std::uint64_t> program_until_ns_ = Engine::no_deadline;
  ReplyPace pace_;
  bool leading_ = false;
  bool blocked_ = false;                            // the driver has no room for more bytes
  std::atomic<std::uint64_t> silent_until_ns_ = 0;  // nothing is sent before this time
  std::uint64_t leading_until_ns_ = 0;
  bool reader_leading_ = false;  // the leader does not wait for an answer
  bool attended_ = false;        // the leader is a thread that calls attend()
  bool reader_rests_ = false;    // while another thread waits for publishes and reads
  bool reader_patient_ = false;  // it waits longer than at first for those who wait for publishes
  unsigned followers_ = 0;       // threads that wait for turn_
  unsigned callers_ = 0;         // threads that wait for answers, the leader included
  std::uint64_t last_call_ns_ = 0;
  std::thread::id last_caller_;
  unsigned listeners_ = 0;  // threads that wait for publishes, the leader included
  std::uint64_t last_listened_ns_ = 0;
  std::vector<int> notified_;
  std::array<std::shared_ptr<Subscription>, protocol::limits::groups_max> subscriptions_;
  std::vector<std::shared_ptr<Subscription>> released_subscriptions_;  // the engine may still read them
  std::uint64_t subscriptions_ended_ = 0;
  bool reader_wanted_ = false;

  std::mutex configuring_;  // held during a subscribe or unsubscribe
  // the host's copy: bit g belongs to group g
  std::array<std::uint8_t, protocol::limits::groups_max / 8> event_mask_{};
  bool quieted_ = false;
  std::thread reader_;
  std::mutex reader_mutex_;
  bool reader_kept_ = false;  // an asynchronous user keeps the reader as long as the link exists

  std::atomic<Gateware> gateware_;
  std::array<std::uint8_t, 65536> received_;
};

}  // namespace unitylink
