/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Several values of a robot at once: read together, written together. One value is a set of one. C11 and C++20.
 */
#ifndef UNITYLINK_SETS_H
#define UNITYLINK_SETS_H

#include <unitylink/objects.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Values of a robot: `values` are places in its table, counted from `first`. `words` is the sum of their words. */
typedef struct {
  const char* path;
  const uint16_t* values;
  uint32_t count;
  uint32_t words;
} ul_set;

static inline const ul_value* ul_of_set(const ul_objects* objects, uint32_t first, const ul_set* set, uint32_t i) {
  return &objects->facts->values[first + set->values[i]];
}

static inline uint32_t ul_data_bits(const ul_objects* objects, const ul_value* value) {
  return objects->facts->links[value->link].data_bits;
}

/* Reads all values of the set: their raw numbers, in order. `atomic`: those of a link are of one moment, or it is
 * UL_MISMATCH. `room` has two words for each word of the set. */
static inline ul_status ul_set_read(ul_objects* objects, uint32_t first, const ul_set* set, bool atomic, uint32_t* room,
                                    uint64_t* raws, ul_failure* failure) {
  uint32_t* addresses = room;
  uint32_t* words = room + set->words;
  for (uint32_t link = 0; link < objects->facts->link_count; ++link) {
    bool checked = false, again = true;
    size_t taken = 0, used = 0;
    for (uint32_t i = 0; i < set->count; ++i) {
      const ul_value* value = ul_of_set(objects, first, set, i);
      if (value->link != link) continue;
      checked = checked || (value->flags & UL_VALUE_CHECKED) != 0;
      again = again && (value->flags & UL_VALUE_READ_AGAIN) != 0;
      for (uint32_t word = 0; word < value->words; ++word) addresses[taken++] = value->address + word;
    }
    const ul_options how = ul_how(checked, again);
    const ul_status status = ul_objects_read_words(objects, link, addresses, taken, words, atomic, &how);
    if (status != UL_OK) return ul_fail_link(failure, status, set->path);
    for (uint32_t i = 0; i < set->count; ++i) {
      const ul_value* value = ul_of_set(objects, first, set, i);
      if (value->link != link) continue;
      raws[i] = ul_join(value, ul_data_bits(objects, value), words + used);
      used += value->words;
    }
  }
  return UL_OK;
}

/* Writes the outputs of the set that lie in committed memory: one burst and one commit for each memory. */
static inline ul_status ul_set_commit(ul_objects* objects, uint32_t first, const ul_set* set, const uint64_t* raws,
                                      ul_failure* failure) {
  for (uint32_t number = 0; number < objects->facts->memory_count; ++number) {
    bool begun = false;
    for (uint32_t i = 0; i < set->count; ++i) {
      const ul_value* value = ul_of_set(objects, first, set, i);
      if (value->memory != (int16_t)number) continue;
      if (!begun) {
        const ul_status status = ul_memory_begin(objects, number, set->path, failure);
        if (status != UL_OK) return status;
      }
      begun = true;
      ul_split(value, ul_data_bits(objects, value), raws[i], objects->memories[number].next + value->slot);
    }
    if (begun) {
      const ul_status status = ul_memory_commit(objects, number, set->path, failure);
      if (status != UL_OK) return status;
    }
  }
  return UL_OK;
}

/* Writes all values of the set: plain words in one burst for each link, then committed memory. `room` has two words for
 * each word of the set. */
static inline ul_status ul_set_write(ul_objects* objects, uint32_t first, const ul_set* set, const uint64_t* raws,
                                     uint32_t* room, ul_failure* failure) {
  uint32_t* addresses = room;
  uint32_t* words = room + set->words;
  for (uint32_t link = 0; link < objects->facts->link_count; ++link) {
    bool checked = false, again = true;
    size_t taken = 0;
    for (uint32_t i = 0; i < set->count; ++i) {
      const ul_value* value = ul_of_set(objects, first, set, i);
      if (value->link != link || value->memory >= 0) continue;
      checked = checked || (value->flags & UL_VALUE_CHECKED) != 0;
      again = again && (value->flags & UL_VALUE_WRITE_AGAIN) != 0;
      for (uint32_t word = 0; word < value->words; ++word) addresses[taken + word] = value->address + word;
      ul_split(value, ul_data_bits(objects, value), raws[i], words + taken);
      taken += value->words;
    }
    const ul_options how = ul_how(checked, again);
    const ul_status status = ul_objects_write_words(objects, link, addresses, words, taken, &how);
    if (status != UL_OK) return ul_fail_link(failure, status, set->path);
  }
  return ul_set_commit(objects, first, set, raws, failure);
}

/* Reads and writes one value. */
enum { UL_VALUE_WORDS_MAX = 8 }; /* 64 bits on a bus of 8 */
static inline ul_status ul_value_read(ul_objects* objects, uint32_t index, uint64_t* raw, ul_failure* failure) {
  const ul_value* value = &objects->facts->values[index];
  const uint16_t itself = 0;
  const ul_set set = {value->path, &itself, 1, value->words};
  uint32_t room[2 * UL_VALUE_WORDS_MAX];
  return ul_set_read(objects, index, &set, value->words > 1, room, raw, failure);
}
static inline ul_status ul_value_write(ul_objects* objects, uint32_t index, uint64_t raw, ul_failure* failure) {
  const ul_value* value = &objects->facts->values[index];
  const uint16_t itself = 0;
  const ul_set set = {value->path, &itself, 1, value->words};
  uint32_t room[2 * UL_VALUE_WORDS_MAX];
  return ul_set_write(objects, index, &set, &raw, room, failure);
}

#ifdef __cplusplus
}
#endif

#endif
