/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Values that the gateware publishes together, by its own clock or on an event. C11 and C++20.
 */
#ifndef UNITYLINK_STREAM_H
#define UNITYLINK_STREAM_H

#include <unitylink/sets.h>

#ifdef __cplusplus
extern "C" {
#endif

/* `room` has two words for each word of the set. */
typedef struct {
  ul_objects* objects;
  const ul_set* set;
  uint32_t divisor; /* of the base rate; 0: published on an event */
  uint32_t* room;
  uint32_t subscription;
  uint8_t link;
  bool running;
} ul_stream;

/* Lets the device publish. `ring` publishes are kept until they are polled. Twice does nothing. */
static inline ul_status ul_stream_start(ul_stream* stream, uint32_t ring, ul_failure* failure) {
  ul_subscription_options options;
  uint32_t taken = 0;
  if (stream->running) return UL_OK;
  memset(&options, 0, sizeof options);
  options.size = sizeof options;
  options.divisor = stream->divisor;
  options.on_event = stream->divisor == 0 ? 1 : 0;
  options.verify = 1; /* but not where a read takes something out */
  options.ring = ring;
  stream->link = stream->set->count > 0 ? ul_of_set(stream->objects, 0, stream->set, 0)->link : 0;
  for (uint32_t i = 0; i < stream->set->count; ++i) {
    const ul_value* value = ul_of_set(stream->objects, 0, stream->set, i);
    if ((value->flags & UL_VALUE_READ_AGAIN) == 0) options.verify = 0;
    for (uint32_t word = 0; word < value->words; ++word) stream->room[taken++] = value->address + word;
  }
  const ul_status status =
      ul_subscribe(stream->objects->links[stream->link], stream->room, taken, &options, &stream->subscription);
  stream->running = status == UL_OK;
  return ul_fail_link(failure, status, stream->set->path);
}

/* Takes the oldest publish out: its time (s, CLOCK_MONOTONIC) and raw numbers. `come` false: there is none. */
static inline ul_status ul_stream_poll(ul_stream* stream, double* time_s, uint64_t* raws, bool* come,
                                       ul_failure* failure) {
  const uint32_t* word = stream->room;
  size_t taken = 0;
  *come = false;
  if (!stream->running)
    return ul_fail(failure, UL_ARGUMENT, stream->set->path, "its publishes were not started; call start first");
  const ul_status status =
      ul_drain(stream->objects->links[stream->link], stream->subscription, time_s, stream->room, 1, &taken);
  if (status != UL_OK) return ul_fail_link(failure, status, stream->set->path);
  *come = taken > 0;
  for (uint32_t i = 0; taken > 0 && i < stream->set->count; ++i) {
    const ul_value* value = ul_of_set(stream->objects, 0, stream->set, i);
    raws[i] = ul_join(value, ul_data_bits(stream->objects, value), word);
    word += value->words;
  }
  return UL_OK;
}

/* Waits for a publish. `come` false: none came within `timeout_ns`. */
static inline ul_status ul_stream_wait(ul_stream* stream, uint64_t timeout_ns, bool* come, ul_failure* failure) {
  *come = false;
  if (!stream->running)
    return ul_fail(failure, UL_ARGUMENT, stream->set->path, "its publishes were not started; call start first");
  const ul_status status = ul_wait_publish(stream->objects->links[stream->link], stream->subscription, timeout_ns);
  *come = status == UL_OK;
  return status == UL_TIMEOUT ? UL_OK : ul_fail_link(failure, status, stream->set->path);
}

/* Publishes that were overwritten before they were polled, or lost on the line. */
static inline uint64_t ul_stream_lost(const ul_stream* stream) {
  uint64_t lost = 0, missing = 0;
  if (!stream->running) return 0;
  ul_lost(stream->objects->links[stream->link], stream->subscription, &lost);
  ul_missing(stream->objects->links[stream->link], stream->subscription, &missing);
  return lost + missing;
}

static inline void ul_stream_stop(ul_stream* stream) {
  if (stream->running) ul_unsubscribe(stream->objects->links[stream->link], stream->subscription);
  stream->running = false;
}

#ifdef __cplusplus
}
#endif

#endif
