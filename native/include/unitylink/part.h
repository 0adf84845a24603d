/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Parts of a robot for the headers of `unitylink generate --only c`: which values a part has, and the types of C that
 * they come in. C11.
 */
#ifndef UNITYLINK_PART_H
#define UNITYLINK_PART_H

#include <unitylink/cycle.h>
#include <unitylink/stream.h>

/* A robot, and why its last failed call failed. If several threads use it, each call's status counts, not this text. */
typedef struct {
  ul_objects objects;
  ul_failure failure;
} ul_robot;

/* A part of a robot: its values begin at `first` in the robot's table. */
typedef struct {
  ul_robot* robot;
  uint32_t first;
  const char* path;
} ul_part;

/* The room of the links of a robot, and of its committed memory. */
static inline void ul_robot_begin(ul_robot* robot, const ul_robot_facts* facts, ul_link** links, bool* framed,
                                  ul_memory* memories, uint32_t* words, uint32_t* next, uint8_t* known) {
  robot->objects.facts = facts;
  robot->objects.links = links;
  robot->objects.framed = framed;
  robot->objects.memories = memories;
  robot->objects.unverified = "";
  for (uint32_t i = 0; i < facts->memory_count; ++i) {
    memories[i].shadow = words;
    memories[i].next = next;
    memories[i].known = known;
    words += facts->memories[i].count + 1;
    next += facts->memories[i].count + 1;
    known += facts->memories[i].count + 1;
  }
}

static inline void ul_part_begin(ul_part* part, ul_robot* robot, uint32_t first, const char* path) {
  part->robot = robot;
  part->first = first;
  part->path = path;
}

static inline const ul_value* ul_part_value(const ul_part* part, uint32_t place) {
  return &part->robot->objects.facts->values[part->first + place];
}
static inline ul_status ul_part_read(const ul_part* part, uint32_t place, uint64_t* raw) {
  return ul_value_read(&part->robot->objects, part->first + place, raw, &part->robot->failure);
}
static inline ul_status ul_part_write(const ul_part* part, uint32_t place, uint64_t raw) {
  return ul_value_write(&part->robot->objects, part->first + place, raw, &part->robot->failure);
}
/* The place of an item of an array. False: there is none. */
static inline bool ul_part_item(const ul_part* part, const uint16_t* places, uint32_t count, uint32_t item,
                                uint32_t* place) {
  *place = item < count ? places[item] : 0;
  if (item >= count)
    ul_fail(&part->robot->failure, UL_RANGE, part->path, "there is no item %u; there are %u", (unsigned)item,
            (unsigned)count);
  return item < count;
}

/* ---- the types of values: ul_get_ decodes a raw number, ul_put_ encodes a value */

static inline ul_status ul_get_bool(const ul_value* facts, uint64_t raw, bool* value, ul_failure* failure) {
  (void)facts, (void)failure;
  *value = (raw & 1U) != 0;
  return UL_OK;
}
static inline ul_status ul_put_bool(const ul_value* facts, bool value, uint64_t* raw, ul_failure* failure) {
  (void)facts, (void)failure;
  *raw = value ? 1 : 0;
  return UL_OK;
}
static inline ul_status ul_get_double(const ul_value* facts, uint64_t raw, double* value, ul_failure* failure) {
  (void)failure;
  *value = ul_decode_real(facts, raw);
  return UL_OK;
}
static inline ul_status ul_put_double(const ul_value* facts, double value, uint64_t* raw, ul_failure* failure) {
  return ul_encode_real(facts, value, raw, failure);
}

#define UL_WHOLE_NUMBER(bits)                                                                        \
  static inline ul_status ul_get_i##bits(const ul_value* facts, uint64_t raw, int##bits##_t* value,  \
                                         ul_failure* failure) {                                      \
    (void)failure;                                                                                   \
    *value = (int##bits##_t)ul_signed(facts, raw);                                                   \
    return UL_OK;                                                                                    \
  }                                                                                                  \
  static inline ul_status ul_put_i##bits(const ul_value* facts, int##bits##_t value, uint64_t* raw,  \
                                         ul_failure* failure) {                                      \
    return ul_encode_signed(facts, value, raw, failure);                                             \
  }                                                                                                  \
  static inline ul_status ul_get_u##bits(const ul_value* facts, uint64_t raw, uint##bits##_t* value, \
                                         ul_failure* failure) {                                      \
    (void)failure;                                                                                   \
    *value = (uint##bits##_t)(raw & ul_mask(facts->width));                                          \
    return UL_OK;                                                                                    \
  }                                                                                                  \
  static inline ul_status ul_put_u##bits(const ul_value* facts, uint##bits##_t value, uint64_t* raw, \
                                         ul_failure* failure) {                                      \
    return ul_encode_unsigned(facts, value, raw, failure);                                           \
  }
UL_WHOLE_NUMBER(8)
UL_WHOLE_NUMBER(16)
UL_WHOLE_NUMBER(32)
UL_WHOLE_NUMBER(64)
#undef UL_WHOLE_NUMBER

#endif
