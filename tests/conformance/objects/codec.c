/* SPDX-License-Identifier: BSD-3-Clause
 * Encodes and decodes numbers of the spec random.ul:  `e INDEX NUMBER` gives the raw number or `-`, `d INDEX RAW` the
 * value. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "random.h"

static ul_status encode(const ul_value* facts, const char* number, uint64_t* raw, ul_failure* failure) {
  if (facts->kind == UL_KIND_SIGNED) return ul_encode_signed(facts, strtoll(number, NULL, 10), raw, failure);
  if (facts->kind == UL_KIND_UNSIGNED) return ul_encode_unsigned(facts, strtoull(number, NULL, 10), raw, failure);
  return ul_encode_real(facts, strtod(number, NULL), raw, failure);
}

static void decode(const ul_value* facts, uint64_t raw) {
  if (facts->kind == UL_KIND_SIGNED)
    printf("%" PRId64 "\n", ul_signed(facts, raw));
  else if (facts->kind == UL_KIND_UNSIGNED)
    printf("%" PRIu64 "\n", raw & ul_mask(facts->width));
  else
    printf("%a\n", ul_decode_real(facts, raw));
}

int main(void) {
  char what = 0;
  unsigned index = 0;
  char number[64];
  ul_failure failure;
  while (scanf(" %c %u %63s", &what, &index, number) == 3) {
    const ul_value* facts = &random_tables_values[index];
    uint64_t raw = 0;
    if (what == 'd')
      decode(facts, strtoull(number, NULL, 10));
    else if (encode(facts, number, &raw, &failure) == UL_OK)
      printf("%" PRIu64 "\n", raw);
    else
      puts("-");
  }
  return 0;
}
