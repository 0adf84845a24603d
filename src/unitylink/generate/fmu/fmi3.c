/* SPDX-License-Identifier: BSD-3-Clause
 *
 * A robot as a unit of FMI 3.0 for co-simulation: its values are variables, and a step writes and reads them over the
 * link. model.h says which values there are.
 */
#include "unit.h"

/* ---- the link */

static ul_objects* objects(unit* self) { return &self->robot.robot.objects; }

static void close_links(unit* self) {
  for (int i = MODEL_LINKS - 1; i >= 0; --i) {
    if (i == 0 || self->links[i] != self->links[0]) ul_free(self->links[i]);
    self->links[i] = NULL;
  }
  self->open = false;
}

/* A link without a URL is the first one. */
static fmi3Status open_links(unit* self) {
  for (int i = 0; i < MODEL_LINKS; ++i) {
    if (i > 0 && *self->urls[i] == '\0') {
      self->links[i] = self->links[0];
      continue;
    }
    if (ul_open(self->urls[i], &self->links[i]) != UL_OK) {
      const fmi3Status status = failed(self, ul_last_error_text());
      close_links(self);
      return status;
    }
  }
  if (MODEL_OPEN(&self->robot, self->links) != UL_OK) {
    const fmi3Status status = not_done(self);
    close_links(self);
    return status;
  }
  self->open = true;
  return fmi3OK;
}

static fmi3Status read_outputs(unit* self) {
  const ul_set set = {MODEL_NAME, model_outputs, MODEL_OUTPUTS, MODEL_WORDS};
  if (MODEL_OUTPUTS == 0) return fmi3OK;
  if (ul_set_read(objects(self), 0, &set, false, self->room, self->moved, &self->robot.robot.failure) != UL_OK)
    return not_done(self);
  for (uint32_t i = 0; i < MODEL_OUTPUTS; ++i) self->raws[model_outputs[i]] = self->moved[i];
  return fmi3OK;
}

/* Writes what was set since the last step, together. What was never set is not written. */
static fmi3Status write_inputs(unit* self) {
  uint16_t places[MODEL_VALUES];
  ul_set set = {MODEL_NAME, places, 0, MODEL_WORDS};
  for (uint32_t i = 0; i < MODEL_INPUTS; ++i) {
    const uint16_t place = model_inputs[i];
    if (!self->given[place]) continue;
    self->moved[set.count] = self->raws[place];
    places[set.count++] = place;
  }
  if (set.count == 0) return fmi3OK;
  if (ul_set_write(objects(self), 0, &set, self->moved, self->room, &self->robot.robot.failure) != UL_OK)
    return not_done(self);
  memset(self->given, 0, sizeof self->given);
  return fmi3OK;
}

static double now_s(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void sleep_until(double time_s) {
  for (double left_s = time_s - now_s(); left_s > 0; left_s = time_s - now_s()) {
    struct timespec pause = {(time_t)left_s, (long)(1e9 * (left_s - (double)(time_t)left_s))};
    nanosleep(&pause, NULL);
  }
}

/* ---- the life of a unit */

EXPORT const char* fmi3GetVersion(void) { return "3.0"; }

EXPORT fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources,
                                                fmi3Boolean visible, fmi3Boolean logs, fmi3Boolean events,
                                                fmi3Boolean early, const fmi3ValueReference required[],
                                                size_t required_count, fmi3InstanceEnvironment environment,
                                                fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update) {
  (void)name, (void)resources, (void)visible, (void)logs, (void)events, (void)early, (void)required,
      (void)required_count;
  (void)update;
  if (token == NULL || strcmp(token, MODEL_TOKEN) != 0) {
    if (log != NULL)
      log(environment, fmi3Error, "logStatusError", "the binary is of another spec than modelDescription.xml");
    return NULL;
  }
  unit* self = calloc(1, sizeof *self);
  if (self == NULL) return NULL;
  snprintf(self->urls[0], URL_ROOM, "%s", MODEL_URL);
  self->paced = true;
  self->environment = environment;
  self->log = log;
  return self;
}

EXPORT void fmi3FreeInstance(fmi3Instance instance) {
  if (instance == NULL) return;
  close_links(instance);
  free(instance);
}

EXPORT fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean on, size_t count,
                                      const fmi3String categories[]) {
  (void)instance, (void)on, (void)count, (void)categories;
  return fmi3OK;
}

EXPORT fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean defined, fmi3Float64 tolerance,
                                              fmi3Float64 start_s, fmi3Boolean stops, fmi3Float64 stop_s) {
  (void)defined, (void)tolerance, (void)stops, (void)stop_s;
  unit* self = instance;
  self->time_s = start_s;
  const fmi3Status status = open_links(self);
  return status == fmi3OK ? read_outputs(self) : status;
}

EXPORT fmi3Status fmi3ExitInitializationMode(fmi3Instance instance) {
  unit* self = instance;
  const fmi3Status status = write_inputs(self);
  self->begun_s = now_s() - self->time_s;
  return status;
}

EXPORT fmi3Status fmi3EnterStepMode(fmi3Instance instance) {
  (void)instance;
  return fmi3OK;
}

EXPORT fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 at_s, fmi3Float64 step_s, fmi3Boolean keeps,
                             fmi3Boolean* event, fmi3Boolean* terminate, fmi3Boolean* early, fmi3Float64* reached_s) {
  (void)keeps;
  unit* self = instance;
  *event = *terminate = *early = false;
  *reached_s = at_s;
  if (!self->open) return failed(self, "a step before the initialization, or after the end");
  fmi3Status status = write_inputs(self);
  if (status != fmi3OK) return status;
  self->time_s = at_s + step_s;
  if (self->paced) sleep_until(self->begun_s + self->time_s);
  status = read_outputs(self);
  if (status == fmi3OK) *reached_s = self->time_s;
  return status;
}

EXPORT fmi3Status fmi3Terminate(fmi3Instance instance) {
  close_links(instance);
  return fmi3OK;
}

EXPORT fmi3Status fmi3Reset(fmi3Instance instance) {
  unit* self = instance;
  close_links(self);
  memset(self->given, 0, sizeof self->given);
  return fmi3OK;
}

/* A unit that is never in this mode has nothing to update. */
EXPORT fmi3Status fmi3UpdateDiscreteStates(fmi3Instance instance, fmi3Boolean* again, fmi3Boolean* terminate,
                                           fmi3Boolean* nominals, fmi3Boolean* states, fmi3Boolean* defined,
                                           fmi3Float64* next_s) {
  (void)instance, (void)next_s;
  *again = *terminate = *nominals = *states = *defined = false;
  return fmi3OK;
}
