/* SPDX-License-Identifier: BSD-3-Clause
 * Sets an output of the board to an input of it, for ever:  loop cycle|event LINK
 * `cycle` exchanges outputs and inputs without a pause. `event` waits for the publish of a change.
 */
#include <stdio.h>
#include <string.h>
#include <unitylink.h>

enum { LEVELS = 0, OUTPUTS = 1, DIRECTION = 2, WATCH = 5 };

static int failed(const char* what) {
  fprintf(stderr, "%s: %s\n", what, ul_last_error_text());
  return 1;
}

static int cycle(ul_link* link) {
  const ul_exchange_word output = {.address = OUTPUTS, .bytes = 1};
  const ul_exchange_word input = {.address = LEVELS, .bytes = 1};
  uint32_t group;
  uint32_t levels = 0;
  if (ul_define_exchange(link, &output, 1, &input, 1, &group) != UL_OK) {
    return failed("exchange group");
  }
  puts("ready");
  fflush(stdout);
  for (;;) {
    const uint32_t outputs = (levels & 1u) << 1;
    if (ul_exchange(link, group, &outputs, 1, &levels, 1, NULL) != UL_OK) {
      return failed("exchange");
    }
  }
}

static int event(ul_link* link) {
  const ul_subscription_options how = {.size = sizeof how, .on_event = 1, .ring = 64};
  const uint32_t address = LEVELS;
  uint32_t subscription;
  if (ul_subscribe(link, &address, 1, &how, &subscription) != UL_OK) {
    return failed("subscribe");
  }
  puts("ready");
  fflush(stdout);
  for (;;) {
    double times_s[64];
    uint32_t levels[64];
    size_t taken;
    if (ul_wait_publish(link, subscription, 60000000000u) != UL_OK ||
        ul_drain(link, subscription, times_s, levels, 64, &taken) != UL_OK) {
      return failed("publishes");
    }
    if (taken > 0 && ul_write(link, OUTPUTS, (levels[taken - 1] & 1u) << 1, NULL) != UL_OK) {
      return failed("write");
    }
  }
}

int main(int count, char** arguments) {
  ul_link* link;
  if (count != 3) {
    fprintf(stderr, "usage: %s cycle|event LINK\n", arguments[0]);
    return 2;
  }
  if (ul_open(arguments[2], &link) != UL_OK || ul_write(link, DIRECTION, 2, NULL) != UL_OK ||
      ul_write(link, WATCH, 1, NULL) != UL_OK) {
    return failed("open");
  }
  return strcmp(arguments[1], "cycle") == 0 ? cycle(link) : event(link);
}
