/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The variables of a unit: how the importer gets and sets them. What is set is sent with the next step.
 */
#include "unit.h"

char unit_type(uint32_t reference) {
  const bool value = reference >= FIRST_VALUE && reference - FIRST_VALUE < MODEL_VALUES;
  return value ? model_types[reference - FIRST_VALUE] : '\0';
}

/* Returns the place of a value of one of these types, or -1 after telling why there is none. */
static int place_of(unit* self, uint32_t reference, const char* types) {
  const char type = unit_type(reference);
  if (type != '\0' && strchr(types, type) != NULL) return (int)(reference - FIRST_VALUE);
  failed(self, "there is no such variable of this type");
  return -1;
}

static const ul_value* facts_of(int place) { return &MODEL_TABLE.values[place]; }

static bool given(unit* self, int place, ul_status status) {
  if (status != UL_OK) return failed(self, self->robot.robot.failure.text);
  self->given[place] = true;
  return true;
}

bool unit_get_real(unit* self, uint32_t reference, double* value) {
  if (reference == TIME) {
    *value = self->time_s;
    return true;
  }
  const int place = place_of(self, reference, "r");
  if (place < 0) return false;
  *value = ul_decode_real(facts_of(place), self->raws[place]);
  return true;
}

bool unit_set_real(unit* self, uint32_t reference, double value) {
  const int place = place_of(self, reference, "r");
  if (place < 0) return false;
  return given(self, place, ul_encode_real(facts_of(place), value, &self->raws[place], &self->robot.robot.failure));
}

bool unit_get_whole(unit* self, uint32_t reference, int64_t* value) {
  const int place = place_of(self, reference, "iw");
  if (place < 0) return false;
  const ul_value* facts = facts_of(place);
  const uint64_t raw = self->raws[place];
  *value = facts->kind == UL_KIND_SIGNED ? ul_signed(facts, raw) : (int64_t)(raw & ul_mask(facts->width));
  return true;
}

bool unit_set_whole(unit* self, uint32_t reference, int64_t value) {
  const int place = place_of(self, reference, "iw");
  if (place < 0) return false;
  const ul_value* facts = facts_of(place);
  uint64_t* raw = &self->raws[place];
  ul_failure* failure = &self->robot.robot.failure;
  if (facts->kind == UL_KIND_SIGNED) return given(self, place, ul_encode_signed(facts, value, raw, failure));
  if (value < 0) return given(self, place, ul_fail_range(facts, (double)value, failure));
  if (facts->kind == UL_KIND_ENUM) return given(self, place, ul_encode_member(facts, (uint64_t)value, raw, failure));
  return given(self, place, ul_encode_unsigned(facts, (uint64_t)value, raw, failure));
}

bool unit_get_unsigned(unit* self, uint32_t reference, uint64_t* value) {
  const int place = place_of(self, reference, "u");
  if (place < 0) return false;
  *value = self->raws[place] & ul_mask(facts_of(place)->width);
  return true;
}

bool unit_set_unsigned(unit* self, uint32_t reference, uint64_t value) {
  const int place = place_of(self, reference, "u");
  if (place < 0) return false;
  const ul_value* facts = facts_of(place);
  ul_failure* failure = &self->robot.robot.failure;
  if (facts->kind == UL_KIND_ENUM)
    return given(self, place, ul_encode_member(facts, value, &self->raws[place], failure));
  return given(self, place, ul_encode_unsigned(facts, value, &self->raws[place], failure));
}

bool unit_get_bool(unit* self, uint32_t reference, bool* value) {
  if (reference == PACED) {
    *value = self->paced;
    return true;
  }
  const int place = place_of(self, reference, "b");
  if (place < 0) return false;
  *value = (self->raws[place] & 1U) != 0;
  return true;
}

bool unit_set_bool(unit* self, uint32_t reference, bool value) {
  if (reference == PACED) {
    self->paced = value;
    return true;
  }
  const int place = place_of(self, reference, "b");
  if (place < 0) return false;
  self->raws[place] = value ? 1 : 0;
  self->given[place] = true;
  return true;
}

static char* url_of(unit* self, uint32_t reference) {
  if (reference >= URL && reference < FIRST_VALUE) return self->urls[reference - URL];
  failed(self, "there is no such text");
  return NULL;
}

bool unit_get_text(unit* self, uint32_t reference, const char** value) {
  *value = url_of(self, reference);
  return *value != NULL;
}

bool unit_set_text(unit* self, uint32_t reference, const char* value) {
  char* url = url_of(self, reference);
  if (url == NULL) return false;
  if (self->open) return failed(self, "the link is open; its URL is set before the initialization");
  if (strlen(value) >= URL_ROOM) return failed(self, "a link URL of more than 511 characters");
  strcpy(url, value);
  return true;
}
