/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The unit as FMI 3.0 for co-simulation has it: its life, its steps, its variables.
 */
#include "fmi3.h"

typedef struct {
  unit unit; /* the first member: `tell` gets a pointer to it */
  fmi3InstanceEnvironment environment;
  fmi3LogMessageCallback log;
} fmi3_unit;

static fmi3Status status_of(bool done) { return done ? fmi3OK : fmi3Error; }

static void tell(const unit* self, const char* why) {
  const fmi3_unit* made = (const fmi3_unit*)self;
  if (made->log != NULL) made->log(made->environment, fmi3Error, "logStatusError", why);
}

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
  fmi3_unit* self = calloc(1, sizeof *self);
  if (self == NULL) return NULL;
  self->environment = environment;
  self->log = log;
  unit_make(&self->unit, tell);
  return self;
}

EXPORT void fmi3FreeInstance(fmi3Instance instance) {
  if (instance == NULL) return;
  unit_close(instance);
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
  return status_of(unit_open(instance, start_s));
}

EXPORT fmi3Status fmi3ExitInitializationMode(fmi3Instance instance) { return status_of(unit_begin(instance)); }

EXPORT fmi3Status fmi3EnterStepMode(fmi3Instance instance) {
  (void)instance;
  return fmi3OK;
}

EXPORT fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 at_s, fmi3Float64 step_s, fmi3Boolean keeps,
                             fmi3Boolean* event, fmi3Boolean* terminate, fmi3Boolean* early, fmi3Float64* reached_s) {
  (void)keeps;
  *event = *terminate = *early = false;
  const bool done = unit_step(instance, at_s, step_s);
  *reached_s = done ? at_s + step_s : at_s;
  return status_of(done);
}

EXPORT fmi3Status fmi3Terminate(fmi3Instance instance) {
  unit_close(instance);
  return fmi3OK;
}

EXPORT fmi3Status fmi3Reset(fmi3Instance instance) {
  unit_forget(instance);
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

/* ---- its variables */

#define VALUES(type, kind)                                                                                    \
  EXPORT fmi3Status fmi3Get##type(fmi3Instance instance, const fmi3ValueReference references[], size_t count, \
                                  fmi3##type values[], size_t value_count) {                                  \
    (void)value_count;                                                                                        \
    for (size_t i = 0; i < count; ++i)                                                                        \
      if (!unit_get_##kind(instance, references[i], &values[i])) return fmi3Error;                            \
    return fmi3OK;                                                                                            \
  }                                                                                                           \
  EXPORT fmi3Status fmi3Set##type(fmi3Instance instance, const fmi3ValueReference references[], size_t count, \
                                  const fmi3##type values[], size_t value_count) {                            \
    (void)value_count;                                                                                        \
    for (size_t i = 0; i < count; ++i)                                                                        \
      if (!unit_set_##kind(instance, references[i], values[i])) return fmi3Error;                             \
    return fmi3OK;                                                                                            \
  }
VALUES(Float64, real)
VALUES(Int64, whole)
VALUES(UInt64, unsigned)
VALUES(Boolean, bool)
VALUES(String, text)
