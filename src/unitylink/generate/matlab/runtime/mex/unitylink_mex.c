/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The one MEX file, on the C ABI: unitylink_mex(WHAT, ..). The classes of +unitylink call it. What it does for each
 * WHAT stands at its function, with the arguments after WHAT. The first one is the number of the robot.
 */
#include "loops.h"

static uint32_t place_of(const call* now) {
  const uint32_t place = count_of(now->given[1]);
  if (place >= now->robot->facts.value_count) raise_text(UL_ARGUMENT, "there is no value at this place");
  return place;
}

/* place -> value */
static void read_value(call* now) {
  uint32_t place;
  uint64_t raw = 0;
  needs(now, 2);
  place = place_of(now);
  must(now, ul_value_read(&now->robot->objects, place, &raw, &now->failure));
  now->made[0] = column(&now->robot->facts.values[place], now->robot->packed[place], &raw, 1, 1);
}

/* place, value */
static void write_value(call* now) {
  uint32_t place;
  uint64_t raw = 0;
  needs(now, 3);
  place = place_of(now);
  must(now, encode(&now->robot->facts.values[place], now->robot->packed[place], now->given[2], &raw, &now->failure));
  must(now, ul_value_write(&now->robot->objects, place, raw, &now->failure));
}

/* place, raw number -> value. Nothing is sent. */
static void decode_raw(call* now) {
  uint32_t place;
  uint64_t raw;
  needs(now, 3);
  place = place_of(now);
  raw = bits_of(now->given[2], 0);
  now->made[0] = column(&now->robot->facts.values[place], now->robot->packed[place], &raw, 1, 1);
}

/* place, value -> raw number. Nothing is sent. */
static void encode_raw(call* now) {
  uint32_t place;
  uint64_t raw = 0;
  needs(now, 3);
  place = place_of(now);
  must(now, encode(&now->robot->facts.values[place], now->robot->packed[place], now->given[2], &raw, &now->failure));
  now->made[0] = mxCreateNumericMatrix(1, 1, mxUINT64_CLASS, mxREAL);
  *(uint64_t*)mxGetData(now->made[0]) = raw;
}

/* name, first, places, consistent -> values */
static void read_set(call* now) {
  uint32_t first, *room;
  uint64_t* raws;
  needs(now, 5);
  first = count_of(now->given[2]);
  const ul_set set = set_of(now->robot, &temporary, now->given[1], first, now->given[3]);
  room = (uint32_t*)mxCalloc(2U * set.words + 1U, sizeof *room);
  raws = (uint64_t*)mxCalloc(set.count + 1U, sizeof *raws);
  must(now, ul_set_read(&now->robot->objects, first, &set, real_of(now->given[4]) != 0.0, room, raws, &now->failure));
  now->made[0] = decoded(now, &set, first, raws);
}

/* name, first, places, values */
static void write_set(call* now) {
  uint32_t first, *room;
  uint64_t* raws;
  needs(now, 5);
  first = count_of(now->given[2]);
  const ul_set set = set_of(now->robot, &temporary, now->given[1], first, now->given[3]);
  room = (uint32_t*)mxCalloc(2U * set.words + 1U, sizeof *room);
  raws = encoded(now, &set, first, now->given[4]);
  must(now, ul_set_write(&now->robot->objects, first, &set, raws, room, &now->failure));
}

/* name, first, places -> values: the INITIAL of each, or 0 */
static void initial(call* now) {
  uint32_t first;
  uint64_t* raws;
  needs(now, 4);
  first = count_of(now->given[2]);
  const ul_set set = set_of(now->robot, &temporary, now->given[1], first, now->given[3]);
  raws = (uint64_t*)mxCalloc(set.count + 1U, sizeof *raws);
  for (uint32_t i = 0; i < set.count; ++i) raws[i] = now->robot->initial[first + set.values[i]];
  now->made[0] = decoded(now, &set, first, raws);
}

/* -> why it is not known that the gateware has this spec; '': it was verified */
static void unverified(call* now) {
  needs(now, 1);
  now->made[0] = mxCreateString(now->robot->objects.unverified);
}

/* seconds. Sets the dead-man of each link, see ul_set_dead_man. */
static void dead_man(call* now) {
  double seconds;
  needs(now, 2);
  seconds = real_of(now->given[1]);
  if (!(seconds >= 0.0 && seconds <= 1e9)) raise_text(UL_ARGUMENT, "the silence is in seconds, at most 1e9");
  for (uint32_t i = 0; i < now->robot->opened_count; ++i) {
    const ul_status status = ul_set_dead_man(now->robot->opened[i], (uint64_t)(seconds * 1e9), NULL);
    if (status != UL_OK) raise_text(status, ul_last_error_text());
  }
}

/* Allows writes again after the dead-man has tripped. */
static void arm(call* now) {
  needs(now, 1);
  for (uint32_t i = 0; i < now->robot->opened_count; ++i) {
    const ul_status status = ul_arm(now->robot->opened[i], NULL);
    if (status != UL_OK) raise_text(status, ul_last_error_text());
  }
}

static const struct {
  const char* what;
  void (*run)(call* now);
} calls[] = {{"read", read_value},   {"write", write_value},
             {"read_set", read_set}, {"write_set", write_set},
             {"decode", decode_raw}, {"encode", encode_raw},
             {"initial", initial},   {"cycle", open_cycle},
             {"exchange", exchange}, {"close_cycle", close_cycle},
             {"start", start},       {"wait", wait_publish},
             {"poll", poll},         {"lost", lost},
             {"stop", stop},         {"unverified", unverified},
             {"dead_man", dead_man}, {"arm", arm}};

void mexFunction(int left, mxArray* made[], int right, const mxArray* given[]) {
  char what[16] = "";
  call now;
  if (right < 2 || !mxIsChar(given[0]) || mxGetString(given[0], what, sizeof what) != 0)
    raise_text(UL_ARGUMENT, "unitylink_mex: use the classes that unitylink generate makes");
  free_blocks(temporary);
  temporary = NULL;
  memset(&now, 0, sizeof now);
  mexAtExit(close_all);
  if (strcmp(what, "open") == 0) { /* tables, cell of URLs -> number of the robot */
    made[0] = mxCreateDoubleScalar(open_session(given[1], right > 2 ? given[2] : NULL)->number);
    return;
  }
  if (strcmp(what, "close") == 0) { /* closing twice does nothing */
    close_session(count_of(given[1]));
    return;
  }
  now.left = left;
  now.made = made;
  now.right = right - 1;
  now.given = given + 1;
  now.robot = session_of(given[1]);
  for (size_t i = 0; i < sizeof calls / sizeof calls[0]; ++i) {
    if (strcmp(what, calls[i].what) == 0) {
      calls[i].run(&now);
      return;
    }
  }
  raise_text(UL_ARGUMENT, "unitylink_mex: there is no such call");
}
