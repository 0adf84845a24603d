/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The unit as FMI 2.0 for co-simulation has it: its life, its steps, its variables. A whole number of more than 32 bits
 * is a Real there, because an Integer has 32 bits.
 */
#include "fmi2.h"

enum { NAME_ROOM = 128 };

typedef struct {
  unit unit; /* the first member: `tell` gets a pointer to it */
  fmi2ComponentEnvironment environment;
  fmi2CallbackLogger log;
  double start_s;
  char name[NAME_ROOM];
} fmi2_unit;

static fmi2Status status_of(bool done) { return done ? fmi2OK : fmi2Error; }

/* The message is a format. Some importers ignore what is behind it, so it is the text itself if it can be. */
static void tell(const unit* self, const char* why) {
  const fmi2_unit* made = (const fmi2_unit*)self;
  if (made->log == NULL) return;
  const bool plain = strchr(why, '%') == NULL;
  made->log(made->environment, made->name, fmi2Error, "logStatusError", plain ? why : "%s", why);
}

EXPORT const char* fmi2GetTypesPlatform(void) { return "default"; }
EXPORT const char* fmi2GetVersion(void) { return "2.0"; }

EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String token, fmi2String resources,
                                     const fmi2CallbackFunctions* functions, fmi2Boolean visible, fmi2Boolean logs) {
  (void)resources, (void)visible, (void)logs;
  fmi2_unit* self = calloc(1, sizeof *self);
  if (self == NULL) return NULL;
  if (functions != NULL) {
    self->environment = functions->componentEnvironment;
    self->log = functions->logger;
  }
  snprintf(self->name, NAME_ROOM, "%s", name != NULL ? name : MODEL_NAME);
  unit_make(&self->unit, tell);
  if (type == fmi2CoSimulation && token != NULL && strcmp(token, MODEL_TOKEN) == 0) return self;
  failed(&self->unit, type == fmi2CoSimulation ? "the binary is of another spec than modelDescription.xml"
                                               : "this unit is for co-simulation");
  free(self);
  return NULL;
}

EXPORT void fmi2FreeInstance(fmi2Component component) {
  if (component == NULL) return;
  unit_close(component);
  free(component);
}

EXPORT fmi2Status fmi2SetDebugLogging(fmi2Component component, fmi2Boolean on, size_t count,
                                      const fmi2String categories[]) {
  (void)component, (void)on, (void)count, (void)categories;
  return fmi2OK;
}

EXPORT fmi2Status fmi2SetupExperiment(fmi2Component component, fmi2Boolean defined, fmi2Real tolerance,
                                      fmi2Real start_s, fmi2Boolean stops, fmi2Real stop_s) {
  (void)defined, (void)tolerance, (void)stops, (void)stop_s;
  ((fmi2_unit*)component)->start_s = start_s;
  return fmi2OK;
}

EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component component) {
  return status_of(unit_open(component, ((fmi2_unit*)component)->start_s));
}

EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component component) { return status_of(unit_begin(component)); }

EXPORT fmi2Status fmi2DoStep(fmi2Component component, fmi2Real at_s, fmi2Real step_s, fmi2Boolean keeps) {
  (void)keeps;
  return status_of(unit_step(component, at_s, step_s));
}

EXPORT fmi2Status fmi2Terminate(fmi2Component component) {
  unit_close(component);
  return fmi2OK;
}

EXPORT fmi2Status fmi2Reset(fmi2Component component) {
  unit_forget(component);
  ((fmi2_unit*)component)->start_s = 0.0;
  return fmi2OK;
}

/* ---- its variables */

static bool get_real(unit* self, fmi2ValueReference reference, fmi2Real* value) {
  const char type = unit_type(reference);
  uint64_t large = 0;
  int64_t whole = 0;
  if (type == 'u') {
    if (!unit_get_unsigned(self, reference, &large)) return false;
    *value = (double)large;
    return true;
  }
  if (type != 'w') return unit_get_real(self, reference, value);
  if (!unit_get_whole(self, reference, &whole)) return false;
  *value = (double)whole;
  return true;
}

static bool set_real(unit* self, fmi2ValueReference reference, fmi2Real value) {
  const char type = unit_type(reference);
  if (type != 'w' && type != 'u') return unit_set_real(self, reference, value);
  const double low = type == 'u' ? 0.0 : -0x1p63, end = type == 'u' ? 0x1p64 : 0x1p63;
  if (!(value >= low && value < end) || value != nearbyint(value))
    return failed(self, "this variable takes whole numbers of 64 bits");
  return type == 'u' ? unit_set_unsigned(self, reference, (uint64_t)value)
                     : unit_set_whole(self, reference, (int64_t)value);
}

static bool wide(unit* self, fmi2ValueReference reference) {
  const char type = unit_type(reference);
  if (type != 'w' && type != 'u') return false;
  failed(self, "this variable has more than 32 bits, and is a Real");
  return true;
}

static bool get_integer(unit* self, fmi2ValueReference reference, fmi2Integer* value) {
  int64_t whole = 0;
  if (wide(self, reference)) return false;
  if (!unit_get_whole(self, reference, &whole)) return false;
  *value = (fmi2Integer)whole;
  return true;
}

static bool set_integer(unit* self, fmi2ValueReference reference, fmi2Integer value) {
  if (wide(self, reference)) return false;
  return unit_set_whole(self, reference, value);
}

static bool get_boolean(unit* self, fmi2ValueReference reference, fmi2Boolean* value) {
  bool got = false;
  if (!unit_get_bool(self, reference, &got)) return false;
  *value = got;
  return true;
}

static bool set_boolean(unit* self, fmi2ValueReference reference, fmi2Boolean value) {
  return unit_set_bool(self, reference, value != 0);
}

#define VALUES(type, get, set)                                                                                  \
  EXPORT fmi2Status fmi2Get##type(fmi2Component component, const fmi2ValueReference references[], size_t count, \
                                  fmi2##type values[]) {                                                        \
    for (size_t i = 0; i < count; ++i)                                                                          \
      if (!get(component, references[i], &values[i])) return fmi2Error;                                         \
    return fmi2OK;                                                                                              \
  }                                                                                                             \
  EXPORT fmi2Status fmi2Set##type(fmi2Component component, const fmi2ValueReference references[], size_t count, \
                                  const fmi2##type values[]) {                                                  \
    for (size_t i = 0; i < count; ++i)                                                                          \
      if (!set(component, references[i], values[i])) return fmi2Error;                                          \
    return fmi2OK;                                                                                              \
  }
VALUES(Real, get_real, set_real)
VALUES(Integer, get_integer, set_integer)
VALUES(Boolean, get_boolean, set_boolean)
VALUES(String, unit_get_text, unit_set_text)
