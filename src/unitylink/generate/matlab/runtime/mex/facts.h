/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The tables of a robot, from the struct that NAME.tables() of MATLAB makes. All memory of a robot is in blocks that
 * are freed together.
 */
#ifndef UNITYLINK_MEX_FACTS_H
#define UNITYLINK_MEX_FACTS_H

#include <unitylink/cycle.h>
#include <unitylink/stream.h>

#include <mex.h>
#include <stdlib.h>

/* An error of MATLAB with its identifier. It does not return. */
static void raise_text(ul_status status, const char* text) {
  static const char* const names[] = {"Ok",       "Timeout",    "Unknown",   "Closed",        "Busy",
                                      "NotFound", "Permission", "BusError",  "ProtocolError", "Mismatch",
                                      "Range",    "BadUrl",     "Cancelled", "Argument",      "NoMemory",
                                      "Denied",   "Down",       "Refused",   "LeaseHeld"};
  char id[40];
  char* shown = (char*)mxMalloc(strlen(text) + 1);
  strcpy(shown, text);
  for (char* at = strchr(shown, '<'); at != NULL; at = strchr(at, '<')) *at = '('; /* MATLAB shows <a ..> as a link */
  const bool known = status > 0 && (size_t)status < sizeof names / sizeof names[0];
  snprintf(id, sizeof id, "unitylink:%s", known ? names[status] : "Unexpected");
  mxArray* told[3] = {mxCreateString(id), mxCreateString("%s"), mxCreateString(shown)};
  mexCallMATLAB(0, NULL, 3, told, "error"); /* mexErrMsgIdAndTxt of Octave puts the name of this file before it */
}

typedef struct block {
  struct block* next;
  uint64_t room[];
} block;

/* Room that lives as long as the robot. */
static void* room_of(block** blocks, size_t count, size_t bytes) {
  block* made = (block*)calloc(1, sizeof(block) + (count > 0 ? count : 1) * bytes);
  if (made == NULL) raise_text(UL_NO_MEMORY, "no memory is left");
  made->next = *blocks;
  *blocks = made;
  return made->room;
}

static void free_blocks(block* blocks) {
  while (blocks != NULL) {
    block* next = blocks->next;
    free(blocks);
    blocks = next;
  }
}

/* ---- what a table is made of */

static const mxArray* item_of(const mxArray* cell, size_t place) {
  if (cell == NULL || !mxIsCell(cell) || place >= mxGetNumberOfElements(cell) || mxGetCell(cell, place) == NULL)
    raise_text(UL_ARGUMENT, "a table is not that of generated code; generate again");
  return mxGetCell(cell, place);
}

static double real_of(const mxArray* number) {
  if (number == NULL || !(mxIsNumeric(number) || mxIsLogical(number)) || mxIsComplex(number) ||
      mxGetNumberOfElements(number) != 1)
    raise_text(UL_ARGUMENT, "one number is expected");
  return mxGetScalar(number);
}

/* A number of 0 to 2^32 - 1. */
static uint32_t count_of(const mxArray* number) {
  const double real = real_of(number);
  if (!(real >= 0.0 && real < 4294967296.0 && real == floor(real))) raise_text(UL_ARGUMENT, "a count is expected");
  return (uint32_t)real;
}

static uint64_t bits_of(const mxArray* numbers, size_t place) {
  if (numbers == NULL || !mxIsUint64(numbers) || place >= mxGetNumberOfElements(numbers))
    raise_text(UL_ARGUMENT, "a table is not that of generated code; generate again");
  return ((const uint64_t*)mxGetData(numbers))[place];
}

/* An address: a field of a packed value has a plain number instead. */
static uint32_t word_of(const mxArray* number) {
  return mxIsUint64(number) ? (uint32_t)bits_of(number, 0) : count_of(number);
}

static const char* text_of(block** blocks, const mxArray* text) {
  char* given = text != NULL && mxIsChar(text) ? mxArrayToString(text) : NULL;
  char* kept;
  if (given == NULL) raise_text(UL_ARGUMENT, "a text is expected");
  kept = (char*)room_of(blocks, strlen(given) + 1, 1);
  memcpy(kept, given, strlen(given) + 1);
  mxFree(given);
  return kept;
}

static const mxArray* field_of(const mxArray* table, const char* name) {
  const mxArray* found = table != NULL && mxIsStruct(table) ? mxGetField(table, 0, name) : NULL;
  if (found == NULL) raise_text(UL_ARGUMENT, "a table is not that of generated code; generate again");
  return found;
}

/* ---- values */

/* The fields of a packed value. */
typedef struct fields {
  uint32_t count;
  const char** names;
  ul_value* facts;
  struct fields** inner; /* of a field that is packed itself, else NULL */
} fields;

enum { FACTS = 21, NUMBERS_MAX = 65535 };

static void value_of(block** blocks, ul_value* value, const mxArray* row) {
  const mxArray* members = item_of(row, FACTS - 2);
  uint64_t* numbers;
  value->path = text_of(blocks, item_of(row, 0));
  value->unit = text_of(blocks, item_of(row, 1));
  value->address = word_of(item_of(row, 2));
  value->kind = (uint8_t)count_of(item_of(row, 3));
  value->width = (uint8_t)count_of(item_of(row, 4));
  value->words = (uint8_t)count_of(item_of(row, 5));
  value->flags = (uint8_t)count_of(item_of(row, 6));
  value->link = (uint8_t)count_of(item_of(row, 7));
  value->memory = (int16_t)real_of(item_of(row, 8));
  value->slot = (uint16_t)count_of(item_of(row, 9));
  value->low = bits_of(item_of(row, 10), 0);
  value->high = bits_of(item_of(row, 11), 0);
  value->scale = real_of(item_of(row, 12));
  value->offset = real_of(item_of(row, 13));
  value->multiplier = real_of(item_of(row, 14));
  value->added = real_of(item_of(row, 15));
  value->divisor = real_of(item_of(row, 16));
  value->minimum = real_of(item_of(row, 17));
  value->maximum = real_of(item_of(row, 18));
  value->member_count = (uint16_t)(mxGetNumberOfElements(members) & NUMBERS_MAX);
  numbers = (uint64_t*)room_of(blocks, value->member_count, sizeof *numbers);
  for (uint16_t i = 0; i < value->member_count; ++i) numbers[i] = bits_of(members, i);
  value->members = numbers;
  if (value->width < 1 || value->width > 64 || value->words < 1 || value->words > UL_VALUE_WORDS_MAX)
    raise_text(UL_ARGUMENT, "a table is not that of generated code; generate again");
}

/* Each row has a name, the facts, and the fields of the field. NULL for a value that is not packed. */
static fields* fields_of(block** blocks, const mxArray* rows) {
  fields* made;
  if (mxGetNumberOfElements(rows) == 0) return NULL;
  made = (fields*)room_of(blocks, 1, sizeof *made);
  made->count = (uint32_t)mxGetNumberOfElements(rows);
  made->names = (const char**)room_of(blocks, made->count, sizeof *made->names);
  made->facts = (ul_value*)room_of(blocks, made->count, sizeof *made->facts);
  made->inner = (fields**)room_of(blocks, made->count, sizeof *made->inner);
  for (uint32_t i = 0; i < made->count; ++i) {
    const mxArray* row = item_of(rows, i);
    made->names[i] = text_of(blocks, item_of(row, 0));
    value_of(blocks, &made->facts[i], item_of(row, 1));
    made->inner[i] = fields_of(blocks, item_of(row, 2));
  }
  return made;
}

#endif
