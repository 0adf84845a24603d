// SPDX-License-Identifier: BSD-3-Clause
// The C ABI, made of unitylink::Link. No exception leaves this file.
#include "unitylink.h"

#include <string>

#include "abi/calls.hpp"
#include "layer2_message/link.hpp"

using namespace unitylink;
using namespace unitylink::abi;

struct ul_link {
  std::unique_ptr<Link> link;
  std::string unverified;  // the text that ul_check_spec returns
};

namespace {

static_assert(UL_CANCELLED == static_cast<ul_status>(Status::cancelled), "the two enumerations are one");
static_assert(UL_READ == protocol::list_operation::read && UL_READ_FIFO == protocol::list_operation::read_fifo &&
              UL_WRITE == protocol::list_operation::write && UL_WRITE_FIFO == protocol::list_operation::write_fifo &&
              UL_WRITE_MASKED == protocol::list_operation::write_masked && UL_ADD == protocol::list_operation::add);
static_assert(UL_BUS_ERROR == static_cast<ul_status>(Status::bus_error));

}  // namespace

const char* ul_version(void) { return UNITYLINK_VERSION; }

const char* ul_status_text(ul_status status) {
  switch (status) {
    case UL_ARGUMENT: return "a NULL pointer or a struct of unknown size";
    case UL_NO_MEMORY: return "out of memory or threads";
    default: return status_text(static_cast<Status>(status));
  }
}

const char* ul_last_error_text(void) {
  const ul_status status = last_failure.error().status;
  return *last_failure.text() == 0 && status != UL_OK ? ul_status_text(status) : last_failure.text();
}

ul_status ul_last_error(ul_error* error) {
  if (!known(error)) {
    return bad_argument(unknown_size);
  }
  give(error, last_failure.error());
  return UL_OK;
}

ul_status ul_open(const char* url, ul_link** link) {
  if (url == nullptr || link == nullptr) {
    return bad_argument(null_pointer);
  }
  *link = nullptr;
  return guarded([&] {
    auto opened = std::make_unique<ul_link>();
    Outcome outcome = Link::open(url, opened->link);
    if (outcome.ok()) {
      *link = opened.release();
    }
    return told(outcome);
  });
}

ul_status ul_close(ul_link* link) {
  if (link == nullptr) {
    return bad_argument(null_pointer);
  }
  return guarded([&] {
    link->link->close();
    return ul_status{UL_OK};
  });
}

void ul_free(ul_link* link) { delete link; }

ul_status ul_get_configuration(ul_link* link, ul_configuration* configuration) {
  if (link == nullptr || !known(configuration)) {
    return bad_argument(unknown_size);
  }
  const Configuration& has = link->link->configuration();
  give(configuration, ul_configuration{0, has.address_bytes, has.data_bytes, has.read_many, has.publish_mode,
                                       has.groups, has.group_size, link->link->usable_group_size(), has.rate_bytes,
                                       has.discovered ? 1u : 0u, has.base_hz});
  return UL_OK;
}

ul_status ul_get_statistics(ul_link* link, ul_statistics* statistics) {
  if (link == nullptr || !known(statistics)) {
    return bad_argument(unknown_size);
  }
  return guarded([&] {
    const Statistics has = link->link->statistics();
    const ul_statistics all = {0,
                               0,
                               has.requests,
                               has.replies,
                               has.device_errors,
                               has.retries,
                               has.timeouts,
                               has.fences,
                               has.checksum_errors,
                               has.malformed_messages,
                               has.datalink_errors,
                               has.stale_replies,
                               has.garbage_bytes,
                               has.publishes,
                               has.unclaimed_publishes,
                               has.mismatched_publishes,
                               has.overruns,
                               has.bytes_sent,
                               has.bytes_received,
                               has.posts,
                               has.missing_publishes,
                               has.sessions,
                               has.restarts,
                               has.reconnections};
    give(statistics, all);
    return ul_status{UL_OK};
  });
}

ul_status ul_read(ul_link* link, uint32_t address, uint32_t* value, const ul_options* options) {
  RequestOptions how;
  if (link == nullptr || value == nullptr || !request_options(options, true, how)) {
    return bad_argument(link == nullptr || value == nullptr ? null_pointer : unknown_size);
  }
  return guarded([&] { return told(link->link->read(address, *value, how)); });
}

ul_status ul_write(ul_link* link, uint32_t address, uint32_t value, const ul_options* options) {
  RequestOptions how;
  if (link == nullptr || !request_options(options, false, how)) {
    return bad_argument(link == nullptr ? null_pointer : unknown_size);
  }
  return guarded([&] { return told(link->link->write(address, value, how)); });
}

ul_status ul_read_many(ul_link* link, const uint32_t* addresses, size_t count, uint32_t* values, int32_t atomic,
                       const ul_options* options) {
  RequestOptions how;
  if (link == nullptr || (count > 0 && (addresses == nullptr || values == nullptr)) ||
      !request_options(options, true, how)) {
    return bad_argument(null_pointer);
  }
  return guarded([&] { return told(link->link->read_many({addresses, count}, {values, count}, atomic != 0, how)); });
}

ul_status ul_read_each(ul_link* link, const uint32_t* addresses, size_t count, uint32_t* values,
                       const ul_options* options) {
  RequestOptions how;
  if (link == nullptr || (count > 0 && (addresses == nullptr || values == nullptr)) ||
      !request_options(options, true, how)) {
    return bad_argument(null_pointer);
  }
  return guarded([&] { return told(link->link->read_each({addresses, count}, {values, count}, how)); });
}

ul_status ul_write_many(ul_link* link, const uint32_t* addresses, const uint32_t* values, size_t count,
                        const ul_options* options) {
  RequestOptions how;
  if (link == nullptr || (count > 0 && (addresses == nullptr || values == nullptr)) ||
      !request_options(options, false, how)) {
    return bad_argument(null_pointer);
  }
  return guarded([&] { return told(link->link->write_many({addresses, count}, {values, count}, how)); });
}

const char* ul_protocol(ul_link* link) { return link != nullptr ? link->link->protocol() : "classic"; }
const char* ul_notice(ul_link* link) { return link != nullptr ? link->link->notice().c_str() : ""; }

ul_status ul_check_spec(ul_link* link, const char* spec, const uint64_t* hashes, size_t count,
                        const char** unverified) {
  if (link == nullptr || spec == nullptr || (count > 0 && hashes == nullptr)) {
    return bad_argument(null_pointer);
  }
  return guarded([&] {
    const ul_status status = told(link->link->check_spec(spec, {hashes, count}, link->unverified));
    if (unverified != nullptr) {
      *unverified = link->unverified.c_str();
    }
    return status;
  });
}

ul_status ul_transfer(ul_link* link, const uint32_t* write_addresses, const uint32_t* write_values, size_t writes,
                      const uint32_t* addresses, uint32_t* values, size_t reads, int32_t atomic,
                      const ul_options* options) {
  RequestOptions how;
  const bool missing = (writes > 0 && (write_addresses == nullptr || write_values == nullptr)) ||
                       (reads > 0 && (addresses == nullptr || values == nullptr));
  if (link == nullptr || missing || !request_options(options, false, how)) {
    return bad_argument(link == nullptr || missing ? null_pointer : unknown_size);
  }
  return guarded([&] {
    return told(link->link->transfer({write_addresses, writes}, {write_values, writes}, {addresses, reads},
                                     {values, reads}, atomic != 0, how));
  });
}

ul_status ul_list(ul_link* link, const ul_list_word* words, size_t count, uint32_t* values, size_t room, int32_t atomic,
                  const ul_options* options) {
  RequestOptions how;
  const bool missing = (count > 0 && words == nullptr) || (room > 0 && values == nullptr);
  if (link == nullptr || missing || !request_options(options, false, how)) {
    return bad_argument(link == nullptr || missing ? null_pointer : unknown_size);
  }
  return guarded([&] {
    std::vector<ListWord> steps;
    for (const ul_list_word& word : std::span(words, count)) {
      steps.push_back({word.operation, word.address, word.value, word.mask});
    }
    return told(link->link->list(steps, {values, room}, atomic != 0, how));
  });
}

ul_status ul_post(ul_link* link, const uint32_t* addresses, const uint32_t* values, size_t count,
                  const ul_options* options) {
  RequestOptions how;
  if (link == nullptr || (count > 0 && (addresses == nullptr || values == nullptr)) ||
      !request_options(options, false, how)) {
    return bad_argument(null_pointer);
  }
  return guarded([&] { return told(link->link->post({addresses, count}, {values, count}, how)); });
}

ul_status ul_sync(ul_link* link, const ul_options* options) {
  RequestOptions how;
  if (link == nullptr || !request_options(options, true, how)) {
    return bad_argument(link == nullptr ? null_pointer : unknown_size);
  }
  return guarded([&] { return told(link->link->sync(how)); });
}

ul_status ul_read_control(ul_link* link, uint32_t address, uint32_t* values, size_t count, const ul_options* options) {
  RequestOptions how;
  if (link == nullptr || values == nullptr || !request_options(options, true, how)) {
    return bad_argument(link == nullptr || values == nullptr ? null_pointer : unknown_size);
  }
  return guarded([&] { return told(link->link->read_control(address, {values, count}, how)); });
}

ul_status ul_write_control(ul_link* link, uint32_t address, uint32_t value, const ul_options* options) {
  RequestOptions how;
  if (link == nullptr || !request_options(options, false, how)) {
    return bad_argument(link == nullptr ? null_pointer : unknown_size);
  }
  return guarded([&] { return told(link->link->write_control(address, value, how)); });
}

ul_status ul_define_exchange(ul_link* link, const ul_exchange_word* outputs, size_t output_count,
                             const ul_exchange_word* inputs, size_t input_count, uint32_t* group) {
  if (link == nullptr || group == nullptr || (output_count > 0 && outputs == nullptr) ||
      (input_count > 0 && inputs == nullptr)) {
    return bad_argument(null_pointer);
  }
  return guarded([&] {
    const auto words = [](const ul_exchange_word* given, size_t count) {
      std::vector<ExchangeWord> taken;
      for (size_t index = 0; index < count; ++index) {
        taken.push_back({given[index].address, given[index].bytes});
      }
      return taken;
    };
    return told(link->link->define_exchange(words(outputs, output_count), words(inputs, input_count), *group));
  });
}

ul_status ul_exchange(ul_link* link, uint32_t group, const uint32_t* outputs, size_t output_count, uint32_t* inputs,
                      size_t input_count, const ul_options* options) {
  RequestOptions how;
  const bool missing = (output_count > 0 && outputs == nullptr) || (input_count > 0 && inputs == nullptr);
  if (link == nullptr || missing || !request_options(options, false, how)) {
    return bad_argument(link == nullptr || missing ? null_pointer : unknown_size);
  }
  return guarded(
      [&] { return told(link->link->exchange(group, {outputs, output_count}, {inputs, input_count}, how)); });
}

ul_status ul_release_exchange(ul_link* link, uint32_t group) {
  if (link == nullptr) {
    return bad_argument(null_pointer);
  }
  return guarded([&] {
    link->link->release_exchange(group);
    return ul_status{UL_OK};
  });
}

ul_status ul_set_dead_man(ul_link* link, uint64_t silence_ns, const ul_options* options) {
  RequestOptions how;
  if (link == nullptr || !request_options(options, false, how)) {
    return bad_argument(link == nullptr ? null_pointer : unknown_size);
  }
  return guarded([&] { return told(link->link->set_dead_man(static_cast<double>(silence_ns) * 1e-9, how)); });
}

ul_status ul_arm(ul_link* link, const ul_options* options) {
  RequestOptions how;
  if (link == nullptr || !request_options(options, false, how)) {
    return bad_argument(link == nullptr ? null_pointer : unknown_size);
  }
  return guarded([&] { return told(link->link->arm(how)); });
}

ul_status ul_watch_program(ul_link* link, uint64_t patience_ns) {
  if (link == nullptr) {
    return bad_argument(null_pointer);
  }
  return guarded([&] { return told(link->link->watch_program(static_cast<double>(patience_ns) * 1e-9)); });
}

void ul_alive(ul_link* link) {
  if (link != nullptr) {
    link->link->alive();
  }
}

ul_status ul_subscribe(ul_link* link, const uint32_t* addresses, size_t count, const ul_subscription_options* options,
                       uint32_t* subscription) {
  ul_subscription_options wanted{};
  const bool taken = take(options, wanted);
  if (link == nullptr || addresses == nullptr || subscription == nullptr || !taken) {
    return bad_argument(taken ? null_pointer : unknown_size);
  }
  return guarded([&] {
    const SubscriptionRequest request{
        {addresses, count}, wanted.divisor, wanted.on_event != 0, wanted.verify != 0, wanted.ring};
    return told(link->link->subscribe(request, *subscription));
  });
}

ul_status ul_unsubscribe(ul_link* link, uint32_t subscription) {
  if (link == nullptr) {
    return bad_argument(null_pointer);
  }
  return guarded([&] { return told(link->link->unsubscribe(subscription)); });
}

ul_status ul_drain(ul_link* link, uint32_t subscription, double* times_s, uint32_t* values, size_t room,
                   size_t* taken) {
  if (link == nullptr || times_s == nullptr || values == nullptr || taken == nullptr) {
    return bad_argument(null_pointer);
  }
  return guarded([&] {
    *taken = link->link->drain(subscription, {times_s, room}, {values, room * link->link->words(subscription)});
    return ul_status{UL_OK};
  });
}

ul_status ul_wait_publish(ul_link* link, uint32_t subscription, uint64_t timeout_ns) {
  if (link == nullptr) {
    return bad_argument(null_pointer);
  }
  return guarded([&] {
    if (link->link->wait_publish(subscription, timeout_ns)) {
      return ul_status{UL_OK};
    }
    const bool over = link->link->closed() || !link->link->subscribed(subscription);
    return told({over ? Status::closed : Status::timeout,
                 over ? "the link or the subscription has ended" : "no publish came in time"});
  });
}

ul_status ul_wait_up(ul_link* link, uint64_t timeout_ns) {
  if (link == nullptr) {
    return bad_argument(null_pointer);
  }
  return guarded([&] { return told(link->link->wait_up(timeout_ns)); });
}

ul_status ul_lost(ul_link* link, uint32_t subscription, uint64_t* lost) {
  if (link == nullptr || lost == nullptr) {
    return bad_argument(null_pointer);
  }
  return guarded([&] {
    *lost = link->link->lost(subscription);
    return ul_status{UL_OK};
  });
}

ul_status ul_missing(ul_link* link, uint32_t subscription, uint64_t* missing) {
  if (link == nullptr || missing == nullptr) {
    return bad_argument(null_pointer);
  }
  return guarded([&] {
    *missing = link->link->missing(subscription);
    return ul_status{UL_OK};
  });
}
