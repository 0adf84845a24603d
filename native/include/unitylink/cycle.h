/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The body of a control loop: all outputs of a part of a robot are written, then all its inputs are read. C11, C++20.
 *
 * On a framed link the words are named once, as an exchange group. Then each exchange is one message each way with bare
 * data, and its inputs are of one moment. Outputs behind a commit are written before that.
 */
#ifndef UNITYLINK_CYCLE_H
#define UNITYLINK_CYCLE_H

#include <unitylink/sets.h>

#ifdef __cplusplus
extern "C" {
#endif

/* `addresses`, `words` and `layout` have room for the words of both sets. */
typedef struct {
  ul_objects* objects;
  uint32_t first;
  const ul_set* outputs;
  const ul_set* inputs;
  uint32_t* addresses;
  uint32_t* words;
  ul_exchange_word* layout;
  uint32_t plain; /* words of outputs that need no commit */
  uint32_t read;  /* words of inputs */
  uint32_t group;
  uint8_t link;
  bool open;    /* the device has the group */
  bool grouped; /* false: the device has no room for the group, so each message names its words */
} ul_cycle;

static inline uint32_t ul_cycle_layout(ul_cycle* cycle, const ul_set* set, bool outputs, uint32_t at) {
  for (uint32_t i = 0; i < set->count; ++i) {
    const ul_value* value = ul_of_set(cycle->objects, cycle->first, set, i);
    const uint32_t data_bytes = ul_data_bits(cycle->objects, value) / 8;
    uint32_t left = (value->width + 7U) / 8;
    if (outputs && value->memory >= 0) continue;
    for (uint32_t word = 0; word < value->words; ++word, ++at) {
      cycle->addresses[at] = value->address + word;
      cycle->layout[at].address = value->address + word;
      cycle->layout[at].bytes = left < data_bytes ? left : data_bytes;
      left -= cycle->layout[at].bytes;
    }
  }
  return at;
}

/* Defines the exchange group. All values of a cycle must be behind one link. */
static inline ul_status ul_cycle_open(ul_cycle* cycle, ul_failure* failure) {
  const ul_set* sets[2] = {cycle->outputs, cycle->inputs};
  bool any = false;
  cycle->open = cycle->grouped = false;
  cycle->link = 0;
  for (unsigned k = 0; k < 2; ++k) {
    for (uint32_t i = 0; i < sets[k]->count; ++i) {
      const ul_value* value = ul_of_set(cycle->objects, cycle->first, sets[k], i);
      if (any && value->link != cycle->link)
        return ul_fail(failure, UL_MISMATCH, sets[k]->path,
                       "its values are behind several links, and a cycle has one; make a cycle for each");
      cycle->link = value->link;
      any = true;
    }
  }
  cycle->plain = ul_cycle_layout(cycle, cycle->outputs, true, 0);
  cycle->read = ul_cycle_layout(cycle, cycle->inputs, false, cycle->plain) - cycle->plain;
  if (cycle->plain + cycle->read == 0) return UL_OK;
  const ul_status status = ul_define_exchange(cycle->objects->links[cycle->link], cycle->layout, cycle->plain,
                                              cycle->layout + cycle->plain, cycle->read, &cycle->group);
  if (status != UL_OK && status != UL_MISMATCH) return ul_fail_link(failure, status, cycle->inputs->path);
  cycle->open = cycle->grouped = status == UL_OK;
  return UL_OK;
}

/* Writes the raw numbers of all outputs, then reads those of all inputs. */
static inline ul_status ul_cycle_exchange(ul_cycle* cycle, const uint64_t* outputs, uint64_t* inputs,
                                          ul_failure* failure) {
  ul_objects* objects = cycle->objects;
  ul_link* link = objects->links[cycle->link];
  uint32_t* read = cycle->words + cycle->plain;
  uint32_t at = 0;
  ul_status status = ul_set_commit(objects, cycle->first, cycle->outputs, outputs, failure);
  if (status != UL_OK) return status;
  for (uint32_t i = 0; i < cycle->outputs->count; ++i) {
    const ul_value* value = ul_of_set(objects, cycle->first, cycle->outputs, i);
    if (value->memory >= 0) continue;
    ul_split(value, ul_data_bits(objects, value), outputs[i], cycle->words + at);
    at += value->words;
  }
  if (cycle->grouped)
    status = ul_exchange(link, cycle->group, cycle->words, cycle->plain, read, cycle->read, NULL);
  else if (cycle->plain + cycle->read > 0)
    status = ul_transfer(link, cycle->addresses, cycle->words, cycle->plain, cycle->addresses + cycle->plain, read,
                         cycle->read, objects->framed[cycle->link] ? 1 : 0, NULL);
  if (status != UL_OK) return ul_fail_link(failure, status, cycle->inputs->path);
  for (uint32_t i = 0; i < cycle->inputs->count; ++i) {
    const ul_value* value = ul_of_set(objects, cycle->first, cycle->inputs, i);
    inputs[i] = ul_join(value, ul_data_bits(objects, value), read);
    read += value->words;
  }
  return UL_OK;
}

/* Gives the group back to the device. Twice does nothing. */
static inline void ul_cycle_close(ul_cycle* cycle) {
  if (cycle->open) ul_release_exchange(cycle->objects->links[cycle->link], cycle->group);
  cycle->open = false;
}

#ifdef __cplusplus
}
#endif

#endif
