// SPDX-License-Identifier: BSD-3-Clause
// The posts of a client: writes without an answer.
#include "server/session.hpp"

namespace unitylink::server {

namespace list = protocol::list_operation;
namespace request_kind = protocol::request_kind;
namespace status = protocol::reply_status;

namespace {

constexpr std::size_t post_bytes_most = 200;  // of the operations that are sent together

}  // namespace

// Sends the posts that wait, as many as fit into one list. A board without lists gets them one by one. False: they must
// wait.
bool Session::start_posts() {
  if (running_ > 0) {
    return false;
  }
  const bool lists = (features() & protocol::control_value::feature_lists) != 0;
  bool waits = false;  // for a lease
  Errand& errand = host_.errand();
  if (lists) {
    errand.body.assign(1, 0);  // the flags
  }
  while (!waiting_.empty() &&
         (waiting_.front().kind == request_kind::post || waiting_.front().kind == request_kind::post_list)) {
    Waiting& next = waiting_.front();
    const bool whole = next.payload.size() >= 2 && request_.parse_post(next.kind, next.payload, widths());
    const auto number = static_cast<std::uint16_t>(posts_ + errand.posts.size());
    const bool fits = errand.posts.empty() || (lists && errand.body.size() + next.payload.size() <= post_bytes_most);
    const bool turn = whole && request_.id == number;
    if (turn && !fits) {
      break;
    }
    const Lack lacking = turn ? lack() : Lack::nothing;
    if (lacking == Lack::answer || (lacking != Lack::nothing && !errand.posts.empty())) {
      waits = lacking == Lack::answer;  // else it is refused when those before it are executed
      break;
    }
    waiting_bytes_ -= sizeof(Waiting) + next.payload.size();
    if (Status why = 0; !turn) {
      counters_.discarded += 1;  // a repeat, or one before it is missing
    } else if (refuses(lacking, why)) {
      fail_post(number, why);
      ++posts_;
    } else {
      if (next.kind == request_kind::post && lists) {
        errand.body.push_back(static_cast<std::uint8_t>(list::write));
        errand.body.push_back(1);
      }
      errand.body.insert(errand.body.end(), next.payload.begin() + 2, next.payload.end());
      errand.post_words.push_back(request_.words.size());
      errand.posts.push_back(std::move(next));
    }
    waiting_.pop_front();
  }
  if (errand.posts.empty()) {
    host_.discard(errand);
    return !waits;
  }
  errand.session = this;
  errand.operation = request_kind::post;
  errand.answer.resize(lists ? 2 : 0);
  errand.exchange.kind = static_cast<std::uint8_t>(lists ? request_kind::list : request_kind::write);
  errand.exchange.changes = true;
  running_ += 1;
  alone_ = true;
  host_.submit(errand);
  return true;
}

// A list ends at its first failure. Posts are independent, so those after the failed one are sent again.
void Session::finish_posts(Errand& errand) {
  const Status outcome = errand.exchange.reply_status;
  const bool partly = outcome == status::bus_error || outcome == status::bus_timeout;
  std::size_t words = outcome == status::ok ? Engine::no_deadline : partly ? errand.exchange.words : 0;
  std::size_t done = 0;
  for (; done < errand.posts.size(); ++done) {
    const bool whole = words >= errand.post_words[done];
    if (!whole) {
      fail_post(posts_, outcome);
    }
    ++posts_;
    counters_.requests += 1;
    if (!whole && partly) {
      ++done;
      break;
    }
    words -= whole ? errand.post_words[done] : 0;
  }
  for (std::size_t index = errand.posts.size(); index-- > done;) {
    waiting_bytes_ += sizeof(Waiting) + errand.posts[index].payload.size();
    waiting_.push_front(std::move(errand.posts[index]));
  }
}

void Session::fail_post(std::uint16_t number, Status why) noexcept {
  if (failed_posts_ == 0) {
    first_failed_ = number;
    first_failure_ = why;
  }
  failed_posts_ = static_cast<std::uint16_t>(failed_posts_ + (failed_posts_ == 0xFFFF ? 0 : 1));
}

}  // namespace unitylink::server
