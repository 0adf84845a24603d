/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The calls of cycles and streams. The arguments after the number of the robot stand at each.
 */
#ifndef UNITYLINK_MEX_LOOPS_H
#define UNITYLINK_MEX_LOOPS_H

#include "call.h"

static loop* loop_made(call* now) {
  loop* made = (loop*)calloc(1, sizeof *made);
  free_ended(now->robot);
  if (made == NULL) raise_text(UL_NO_MEMORY, "no memory is left");
  made->next = now->robot->loops;
  now->robot->loops = made;
  return made;
}

static void loop_begins(call* now, loop* made) {
  made->number = ++last_number;
  now->made[0] = mxCreateDoubleScalar(made->number);
}

static loop* loop_of(const call* now, bool streams) {
  const uint32_t number = count_of(now->given[1]);
  for (loop* one = now->robot->loops; number > 0 && one != NULL; one = one->next) {
    if (one->number == number && one->streams == streams) return one;
  }
  raise_text(UL_ARGUMENT, streams ? "its publishes were not started; call start first" : "the cycle was closed");
  return NULL;
}

/* name, first, places of outputs, places of inputs -> number of the cycle */
static void open_cycle(call* now) {
  loop* made;
  size_t words;
  block** blocks;
  needs(now, 5);
  made = loop_made(now);
  blocks = &made->blocks;
  made->cycle.first = count_of(now->given[2]);
  made->outputs = set_of(now->robot, blocks, now->given[1], made->cycle.first, now->given[3]);
  made->inputs = set_of(now->robot, blocks, now->given[1], made->cycle.first, now->given[4]);
  words = (size_t)made->outputs.words + made->inputs.words;
  made->cycle.objects = &now->robot->objects;
  made->cycle.outputs = &made->outputs;
  made->cycle.inputs = &made->inputs;
  made->cycle.addresses = (uint32_t*)room_of(blocks, words, sizeof(uint32_t));
  made->cycle.words = (uint32_t*)room_of(blocks, words, sizeof(uint32_t));
  made->cycle.layout = (ul_exchange_word*)room_of(blocks, words, sizeof(ul_exchange_word));
  must(now, ul_cycle_open(&made->cycle, &now->failure));
  loop_begins(now, made);
}

/* number of the cycle, outputs -> inputs */
static void exchange(call* now) {
  loop* one;
  uint64_t *outputs, *inputs;
  needs(now, 3);
  one = loop_of(now, false);
  outputs = encoded(now, &one->outputs, one->cycle.first, now->given[2]);
  inputs = (uint64_t*)mxCalloc(one->inputs.count + 1U, sizeof *inputs);
  must(now, ul_cycle_exchange(&one->cycle, outputs, inputs, &now->failure));
  now->made[0] = decoded(now, &one->inputs, one->cycle.first, inputs);
}

static void close_cycle(call* now) {
  needs(now, 2);
  end_loop(loop_of(now, false));
}

/* name, places, divisor, room for publishes -> number of the stream */
static void start(call* now) {
  loop* made;
  needs(now, 5);
  made = loop_made(now);
  made->streams = true;
  made->inputs = set_of(now->robot, &made->blocks, now->given[1], 0, now->given[2]);
  made->stream.objects = &now->robot->objects;
  made->stream.set = &made->inputs;
  made->stream.divisor = count_of(now->given[3]);
  made->stream.room = (uint32_t*)room_of(&made->blocks, 2U * made->inputs.words, sizeof(uint32_t));
  must(now, ul_stream_start(&made->stream, count_of(now->given[4]), &now->failure));
  loop_begins(now, made);
}

/* number of the stream, seconds -> whether one came */
static void wait_publish(call* now) {
  bool come = false;
  double seconds;
  needs(now, 3);
  seconds = real_of(now->given[2]);
  if (!(seconds >= 0.0 && seconds <= 1e9)) raise_text(UL_ARGUMENT, "the time to wait is in seconds, at most 1e9");
  must(now, ul_stream_wait(&loop_of(now, true)->stream, (uint64_t)(seconds * 1e9), &come, &now->failure));
  now->made[0] = mxCreateLogicalScalar(come);
}

/* number of the stream, the most publishes -> times in seconds, and a column for each value */
static void poll(call* now) {
  loop* one;
  uint32_t most, room = 16, taken = 0;
  double* times;
  uint64_t* raws;
  mxArray* columns;
  needs(now, 3);
  one = loop_of(now, true);
  most = count_of(now->given[2]);
  times = (double*)mxCalloc(room, sizeof *times);
  raws = (uint64_t*)mxCalloc((size_t)room * (one->inputs.count + 1U), sizeof *raws);
  for (bool come = true; taken < most; ++taken) {
    if (taken == room) {
      room *= 2;
      times = (double*)mxRealloc(times, room * sizeof *times);
      raws = (uint64_t*)mxRealloc(raws, (size_t)room * (one->inputs.count + 1U) * sizeof *raws);
    }
    must(now,
         ul_stream_poll(&one->stream, &times[taken], raws + (size_t)taken * one->inputs.count, &come, &now->failure));
    if (!come) break;
  }
  now->made[0] = mxCreateDoubleMatrix(taken, 1, mxREAL);
  if (taken > 0) memcpy(mxGetPr(now->made[0]), times, taken * sizeof *times);
  if (now->left < 2) return;
  columns = mxCreateCellMatrix(one->inputs.count, 1);
  for (uint32_t i = 0; i < one->inputs.count; ++i) {
    const uint32_t place = one->inputs.values[i];
    mxSetCell(columns, i,
              column(&now->robot->facts.values[place], now->robot->packed[place], raws + i, taken, one->inputs.count));
  }
  now->made[1] = columns;
}

/* number of the stream -> publishes that were overwritten or lost on the line */
static void lost(call* now) {
  needs(now, 2);
  now->made[0] = mxCreateDoubleScalar((double)ul_stream_lost(&loop_of(now, true)->stream));
}

static void stop(call* now) {
  needs(now, 2);
  end_loop(loop_of(now, true));
}

#endif
