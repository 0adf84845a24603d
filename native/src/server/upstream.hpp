// SPDX-License-Identifier: BSD-3-Clause
// The link to the board, as a server uses it: errands out, their answers and the publishes back.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "layer2_message/link.hpp"
#include "server/errand.hpp"
#include "server/turns.hpp"

namespace unitylink::server {

class Upstream final : private PublishTap {
 public:
  struct Publish {
    std::uint32_t group = 0;
    std::uint32_t missing = 0;
    std::uint32_t clock = 0;
    std::size_t begin = 0;  // its words in `Harvest::words`
    std::size_t end = 0;
  };
  // What has arrived since the last harvest.
  struct Harvest {
    std::vector<Errand*> done;
    std::vector<Publish> publishes;
    std::vector<std::uint8_t> words;
  };

  explicit Upstream(Link& link) : link_(link) { link.tap_publishes(this); }
  // All errands must be done, or the link closed.
  ~Upstream() { link_.tap_publishes(nullptr); }

  [[nodiscard]] Link& link() const noexcept { return link_; }
  [[nodiscard]] Errand& errand();
  void recycle(Errand& errand) { idle_.push_back(&errand); }
  // Sends it when it is its client's turn.
  void submit(Errand& errand);
  // Sends what waits, as much as the line takes. Call it when answers have come.
  void push();
  // Nobody waits any more for the errands of this session. What was not sent yet is not sent.
  void abandon(const Session& session);
  [[nodiscard]] std::size_t under_way() const noexcept { return under_way_.size(); }
  [[nodiscard]] const Turns& turns() const noexcept { return turns_; }
  // Valid until the next call.
  [[nodiscard]] const Harvest& harvest();

 private:
  void send(Errand& errand);
  static void on_done(Exchange& exchange) noexcept;
  void on_publish(std::uint32_t group, std::uint32_t missing, std::uint32_t clock,
                  std::span<const std::uint8_t> words) noexcept override;

  Link& link_;
  std::vector<std::unique_ptr<Errand>> errands_;
  std::vector<Errand*> idle_;
  std::vector<Errand*> under_way_;
  Turns turns_;
  std::mutex mutex_;  // guards arrived_, which the thread that reads fills
  Harvest arrived_;
  Harvest harvested_;
};

}  // namespace unitylink::server
