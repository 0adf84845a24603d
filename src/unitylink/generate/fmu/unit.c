/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The life of a unit: its links, and a step, which writes inputs and reads outputs over them.
 */
#include "unit.h"

bool failed(const unit* self, const char* why) {
  self->tell(self, why);
  return false;
}

/* Tells why the last call of the objects failed. */
static bool not_done(const unit* self) { return failed(self, self->robot.robot.failure.text); }

static ul_objects* objects(unit* self) { return &self->robot.robot.objects; }

static void begin_anew(unit* self) {
  memset(self->urls, 0, sizeof self->urls);
  snprintf(self->urls[0], URL_ROOM, "%s", MODEL_URL);
  for (uint32_t i = 0; i < MODEL_VALUES; ++i) self->raws[i] = model_starts[i];
  memset(self->given, 0, sizeof self->given);
  self->paced = true;
  self->time_s = 0.0;
}

void unit_make(unit* self, void (*tell)(const unit* self, const char* why)) {
  self->tell = tell;
  begin_anew(self);
}

void unit_close(unit* self) {
  for (int i = MODEL_LINKS - 1; i >= 0; --i) {
    if (i == 0 || self->links[i] != self->links[0]) ul_free(self->links[i]);
    self->links[i] = NULL;
  }
  self->open = self->begun = false;
}

void unit_forget(unit* self) {
  unit_close(self);
  begin_anew(self);
}

/* A link without a URL is the first one. */
static bool open_links(unit* self) {
  for (int i = 0; i < MODEL_LINKS; ++i) {
    if (i > 0 && *self->urls[i] == '\0') {
      self->links[i] = self->links[0];
      continue;
    }
    if (ul_open(self->urls[i], &self->links[i]) != UL_OK) {
      failed(self, ul_last_error_text());
      unit_close(self);
      return false;
    }
  }
  if (MODEL_OPEN(&self->robot, self->links) != UL_OK) {
    not_done(self);
    unit_close(self);
    return false;
  }
  self->open = true;
  return true;
}

static bool read_outputs(unit* self) {
  const ul_set set = {MODEL_NAME, model_outputs, MODEL_OUTPUTS, MODEL_WORDS};
  if (MODEL_OUTPUTS == 0) return true;
  if (ul_set_read(objects(self), 0, &set, false, self->room, self->moved, &self->robot.robot.failure) != UL_OK)
    return not_done(self);
  for (uint32_t i = 0; i < MODEL_OUTPUTS; ++i) self->raws[model_outputs[i]] = self->moved[i];
  return true;
}

/* Writes what was set since the last step, together. What was never set is not written. */
static bool write_inputs(unit* self) {
  uint16_t places[MODEL_VALUES];
  ul_set set = {MODEL_NAME, places, 0, MODEL_WORDS};
  for (uint32_t i = 0; i < MODEL_INPUTS; ++i) {
    const uint16_t place = model_inputs[i];
    if (!self->given[place]) continue;
    self->moved[set.count] = self->raws[place];
    places[set.count++] = place;
  }
  if (set.count == 0) return true;
  if (ul_set_write(objects(self), 0, &set, self->moved, self->room, &self->robot.robot.failure) != UL_OK)
    return not_done(self);
  memset(self->given, 0, sizeof self->given);
  return true;
}

static double now_s(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void sleep_until(double time_s) {
  for (double left_s = time_s - now_s(); left_s > 0; left_s = time_s - now_s()) {
    const double pause_s = fmin(left_s, 3600.0); /* a step of any length fits */
    struct timespec pause = {(time_t)pause_s, (long)(1e9 * (pause_s - (double)(time_t)pause_s))};
    nanosleep(&pause, NULL);
  }
}

bool unit_open(unit* self, double start_s) {
  if (self->open) return failed(self, "it is initialized already; reset it first");
  if (!isfinite(start_s)) return failed(self, "the time of the start is no number");
  self->time_s = start_s;
  if (open_links(self) && read_outputs(self)) return true;
  unit_close(self);
  return false;
}

bool unit_begin(unit* self) {
  if (!self->open) return failed(self, "the initialization has not begun, or has failed");
  if (!write_inputs(self)) return false;
  self->begun_s = now_s() - self->time_s;
  return self->begun = true;
}

bool unit_step(unit* self, double at_s, double step_s) {
  if (!self->begun) return failed(self, "a step before the initialization, or after the end");
  if (!(step_s > 0.0) || !isfinite(at_s + step_s)) return failed(self, "a step takes more than 0 s, and ends");
  if (at_s + step_s <= self->time_s) return failed(self, "a robot cannot go back in time: this step has been made");
  if (!write_inputs(self)) return false;
  self->time_s = at_s + step_s;
  if (self->paced) sleep_until(self->begun_s + self->time_s);
  return read_outputs(self);
}
