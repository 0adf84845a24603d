/* SPDX-License-Identifier: BSD-3-Clause
 *
 * A unit of FMI 3.0: what its files share. With UNITYLINK_FMI_HEADERS the declarations are those of the standard's
 * headers, else those here.
 */
#include "model.h"

#include <time.h>

#ifdef UNITYLINK_FMI_HEADERS
#include "fmi3Functions.h"
#define EXPORT FMI3_Export
#else
#define EXPORT __attribute__((visibility("default")))
typedef void* fmi3Instance;
typedef void* fmi3InstanceEnvironment;
typedef void* fmi3FMUState;
typedef uint32_t fmi3ValueReference;
typedef float fmi3Float32;
typedef double fmi3Float64;
typedef int8_t fmi3Int8;
typedef uint8_t fmi3UInt8;
typedef int16_t fmi3Int16;
typedef uint16_t fmi3UInt16;
typedef int32_t fmi3Int32;
typedef uint32_t fmi3UInt32;
typedef int64_t fmi3Int64;
typedef uint64_t fmi3UInt64;
typedef bool fmi3Boolean;
typedef const char* fmi3String;
typedef uint8_t fmi3Byte;
typedef const uint8_t* fmi3Binary;
typedef bool fmi3Clock;
typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef int fmi3DependencyKind;
typedef int fmi3IntervalQualifier;
typedef void (*fmi3LogMessageCallback)(fmi3InstanceEnvironment, fmi3Status, fmi3String, fmi3String);
typedef void (*fmi3ClockUpdateCallback)(fmi3InstanceEnvironment);
typedef void (*fmi3IntermediateUpdateCallback)(fmi3InstanceEnvironment, fmi3Float64, fmi3Boolean, fmi3Boolean,
                                               fmi3Boolean, fmi3Boolean, fmi3Boolean*, fmi3Float64*);
typedef void (*fmi3LockPreemptionCallback)(void);
typedef void (*fmi3UnlockPreemptionCallback)(void);
#endif

enum { TIME = 0, PACED = 1, URL = 2, FIRST_VALUE = URL + MODEL_LINKS, URL_ROOM = 512 };

typedef struct {
  MODEL_ROBOT robot; /* stays where it is, so an instance does, too */
  ul_link* links[MODEL_LINKS];
  char urls[MODEL_LINKS][URL_ROOM];
  bool paced, open;
  uint64_t raws[MODEL_VALUES];
  bool given[MODEL_VALUES]; /* set since the last step */
  uint32_t room[2 * MODEL_WORDS];
  uint64_t moved[MODEL_VALUES]; /* what a set reads or writes */
  double time_s, begun_s;       /* of the simulation; when it was 0, on the clock of this machine */
  fmi3InstanceEnvironment environment;
  fmi3LogMessageCallback log;
} unit;

static inline fmi3Status failed(const unit* self, const char* why) {
  if (self->log != NULL) self->log(self->environment, fmi3Error, "logStatusError", why);
  return fmi3Error;
}

/* Tells why the last call of the objects failed. */
static inline fmi3Status not_done(const unit* self) { return failed(self, self->robot.robot.failure.text); }
