/* SPDX-License-Identifier: BSD-3-Clause
 *
 * A call of MATLAB, and the values that go in and out of it.
 */
#ifndef UNITYLINK_MEX_CALL_H
#define UNITYLINK_MEX_CALL_H

#include "session.h"

/* Room of one call, freed at the next: an error leaves the function where it stands. */
static block* temporary = NULL;

typedef struct {
  int left;
  mxArray** made;
  int right;
  const mxArray** given;
  session* robot;
  ul_failure failure;
} call;

static void must(const call* now, ul_status status) {
  if (status != UL_OK) raise_text(status, now->failure.text);
}

static void needs(const call* now, int count) {
  if (now->right != count) raise_text(UL_ARGUMENT, "unitylink_mex: another number of arguments is expected");
}

static mxArray* decoded(const call* now, const ul_set* set, uint32_t first, const uint64_t* raws) {
  mxArray* values = mxCreateCellMatrix(set->count, 1);
  for (uint32_t i = 0; i < set->count; ++i) {
    const uint32_t place = first + set->values[i];
    mxSetCell(values, i, column(&now->robot->facts.values[place], now->robot->packed[place], raws + i, 1, 1));
  }
  return values;
}

static uint64_t* encoded(call* now, const ul_set* set, uint32_t first, const mxArray* values) {
  uint64_t* raws = (uint64_t*)mxCalloc(set->count + 1U, sizeof *raws);
  if (!mxIsCell(values) || mxGetNumberOfElements(values) != set->count) {
    ul_fail(&now->failure, UL_ARGUMENT, set->path, "it takes %u values, and %u were given; nothing was sent",
            (unsigned)set->count, (unsigned)mxGetNumberOfElements(values));
    must(now, UL_ARGUMENT);
  }
  for (uint32_t i = 0; i < set->count; ++i) {
    const uint32_t place = first + set->values[i];
    must(now, encode(&now->robot->facts.values[place], now->robot->packed[place], item_of(values, i), &raws[i],
                     &now->failure));
  }
  return raws;
}

#endif
