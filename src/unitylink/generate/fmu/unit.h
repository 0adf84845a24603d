/* SPDX-License-Identifier: BSD-3-Clause
 *
 * A unit: a robot behind its links, with its values as variables. It knows no version of FMI. fmi2.c and fmi3.c put
 * theirs around it: a struct whose first member is the unit, so that `tell` finds the importer's log behind it.
 *
 * Functions return false after telling why.
 */
#include "model.h"

#include <time.h>

enum { TIME = 0, PACED = 1, URL = 2, FIRST_VALUE = URL + MODEL_LINKS, URL_ROOM = 512 };

typedef struct unit {
  MODEL_ROBOT robot; /* stays where it is, so an instance does, too */
  ul_link* links[MODEL_LINKS];
  char urls[MODEL_LINKS][URL_ROOM];
  bool paced, open, begun;
  uint64_t raws[MODEL_VALUES];
  bool given[MODEL_VALUES]; /* set since the last step */
  uint32_t room[2 * MODEL_WORDS];
  uint64_t moved[MODEL_VALUES]; /* what a set reads or writes */
  double time_s, begun_s;       /* of the simulation; when it was 0, on the clock of this machine */
  void (*tell)(const struct unit* self, const char* why);
} unit;

/* Tells why, and returns false. */
bool failed(const unit* self, const char* why);

/* ---- its life: unit.c */

void unit_make(unit* self, void (*tell)(const unit* self, const char* why));
bool unit_open(unit* self, double start_s);             /* opens the links, and reads all outputs */
bool unit_begin(unit* self);                            /* writes what was set, and begins to count the time */
bool unit_step(unit* self, double at_s, double step_s); /* writes, waits, reads */
void unit_close(unit* self);
void unit_forget(unit* self); /* closes, and is as it was made */

/* ---- its variables: variables.c. A real is of the type `r`, a whole number `i` with more than 32 bits `w`, and
 * without a sign in 64 bits `u`. */

char unit_type(uint32_t reference); /* of a value of the robot; 0 is none */
bool unit_get_real(unit* self, uint32_t reference, double* value);
bool unit_set_real(unit* self, uint32_t reference, double value);
bool unit_get_whole(unit* self, uint32_t reference, int64_t* value);
bool unit_set_whole(unit* self, uint32_t reference, int64_t value);
bool unit_get_unsigned(unit* self, uint32_t reference, uint64_t* value);
bool unit_set_unsigned(unit* self, uint32_t reference, uint64_t value);
bool unit_get_bool(unit* self, uint32_t reference, bool* value);
bool unit_set_bool(unit* self, uint32_t reference, bool value);
bool unit_get_text(unit* self, uint32_t reference, const char** value);
bool unit_set_text(unit* self, uint32_t reference, const char* value);
