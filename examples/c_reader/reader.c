/* SPDX-License-Identifier: BSD-3-Clause
 * Reads a word, then prints what the device publishes of it:  reader LINK ADDRESS [PUBLISHES]
 *
 *     reader serial:/dev/ttyUSB0?baud=3000000 0x20 10
 */
#include <stdio.h>
#include <stdlib.h>
#include <unitylink.h>

static int failed(const char* what) {
  fprintf(stderr, "%s: %s\n", what, ul_last_error_text());
  return 1;
}

/* Every base period, until `wanted` have come. */
static int print_publishes(ul_link* link, uint32_t address, unsigned long wanted) {
  const ul_subscription_options how = {.size = sizeof how, .divisor = 1, .verify = 1, .ring = 1024};
  uint32_t subscription;
  if (ul_subscribe(link, &address, 1, &how, &subscription) != UL_OK) {
    return failed("subscribe");
  }
  while (wanted > 0) {
    double times_s[64];
    uint32_t values[64]; /* room * words of each publish */
    size_t taken;
    if (ul_wait_publish(link, subscription, 1000000000u) != UL_OK ||
        ul_drain(link, subscription, times_s, values, 64, &taken) != UL_OK) {
      return failed("publishes");
    }
    for (size_t index = 0; index < taken && wanted > 0; ++index, --wanted) {
      printf("%.6f s  0x%08x\n", times_s[index], (unsigned)values[index]);
    }
  }
  return ul_unsubscribe(link, subscription) == UL_OK ? 0 : failed("unsubscribe");
}

int main(int count, char** arguments) {
  if (count < 3) {
    fprintf(stderr, "usage: %s LINK ADDRESS [PUBLISHES]\n", arguments[0]);
    return 2;
  }
  ul_link* link;
  if (ul_open(arguments[1], &link) != UL_OK) {
    return failed("open");
  }
  const uint32_t address = (uint32_t)strtoul(arguments[2], NULL, 0);
  uint32_t value;
  int result = 0;
  if (ul_read(link, address, &value, NULL) == UL_OK) {
    printf("0x%08x\n", (unsigned)value);
    result = count > 3 ? print_publishes(link, address, strtoul(arguments[3], NULL, 0)) : 0;
  } else {
    result = failed("read");
  }
  ul_free(link); /* closes it, too */
  return result;
}
