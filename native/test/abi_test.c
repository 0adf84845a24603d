/* SPDX-License-Identifier: BSD-3-Clause
 * unitylink.h used from C. Returns 0, or the line that went wrong. */
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "unitylink.h"

int abi_test(const char* url);

#define EXPECT(condition) \
  do {                    \
    if (!(condition)) {   \
      return __LINE__;    \
    }                     \
  } while (0)

/* A program of a later version, whose structs have more members. */
static int newer_program(ul_link* link) {
  struct {
    ul_configuration first;
    uint64_t later[2];
  } configuration;
  struct {
    ul_options first;
    uint64_t later;
  } options = {{sizeof options, -1, 1, 0, 0}, 0};
  uint32_t value = 0;

  memset(&configuration, 0xFF, sizeof configuration);
  configuration.first.size = sizeof configuration;
  EXPECT(ul_get_configuration(link, &configuration.first) == UL_OK);
  EXPECT(configuration.first.size == sizeof configuration && configuration.first.base_hz == 1000);
  EXPECT(configuration.later[0] == 0 && configuration.later[1] == 0);
  configuration.first.size = 0xFFFFFFFF; /* a struct that was not filled in */
  EXPECT(ul_get_configuration(link, &configuration.first) == UL_ARGUMENT);

  EXPECT(ul_read(link, 0x10, &value, &options.first) == UL_OK);
  options.later = 1; /* it asks for what this library does not have */
  EXPECT(ul_read(link, 0x10, &value, &options.first) == UL_ARGUMENT);
  EXPECT(strstr(ul_last_error_text(), "only a newer library has") != NULL);
  return 0;
}

int abi_test(const char* url) {
  ul_link* link = NULL;
  ul_configuration configuration = {sizeof configuration, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  ul_options options = {sizeof options, -1, 1, 0, 0};
  ul_statistics statistics;
  ul_error error = {sizeof error, 0, 0, 0, 0, 0, 0};
  uint32_t addresses[3] = {0x10, 0x11, 0x12};
  uint32_t values[3] = {1, 2, 3};
  uint32_t value = 0;

  EXPECT(ul_open("nonsense", &link) == UL_BAD_URL && link == NULL);
  EXPECT(strstr(ul_last_error_text(), "nonsense") != NULL);
  EXPECT(ul_open(NULL, &link) == UL_ARGUMENT);
  EXPECT(strlen(ul_status_text(UL_TIMEOUT)) > 0 && strlen(ul_status_text(99)) > 0);

  EXPECT(ul_open(url, &link) == UL_OK && link != NULL);
  EXPECT(ul_get_configuration(link, &configuration) == UL_OK);
  EXPECT(configuration.address_bytes == 1 && configuration.data_bytes == 4 && configuration.base_hz == 1000);
  configuration.size = 3;
  EXPECT(ul_get_configuration(link, &configuration) == UL_ARGUMENT);

  const int newer = newer_program(link);
  if (newer != 0) {
    return newer;
  }

  EXPECT(ul_write_many(link, addresses, values, 3, &options) == UL_OK);
  EXPECT(ul_read(link, 0x12, &value, NULL) == UL_OK && value == 3);
  memset(values, 0, sizeof values);
  EXPECT(ul_read_many(link, addresses, 3, values, 1, NULL) == UL_OK && values[0] == 1 && values[2] == 3);
  EXPECT(ul_read_each(link, addresses, 3, values, NULL) == UL_OK && values[1] == 2);
  const int memory = strcmp(ul_protocol(link), "memory") == 0;
  const ul_status beyond = memory ? UL_BUS_ERROR : UL_RANGE;
  EXPECT(ul_read(link, 0x100, &value, NULL) == beyond);
  EXPECT(ul_last_error(&error) == UL_OK && error.status == beyond && error.has_address && error.address == 0x100);

  memset(&statistics, 0, sizeof statistics);
  statistics.size = sizeof statistics;
  EXPECT(ul_get_statistics(link, &statistics) == UL_OK && statistics.requests >= 6);
  statistics.size = offsetof(ul_statistics, posts); /* a program of version 0.1.0 */
  EXPECT(ul_get_statistics(link, &statistics) == UL_OK);
  statistics.size = offsetof(ul_statistics, restarts); /* of one before reconnect=1 */
  EXPECT(ul_get_statistics(link, &statistics) == UL_OK);
  EXPECT(ul_wait_up(link, 0) == UL_OK && ul_wait_up(NULL, 0) == UL_ARGUMENT);

  addresses[0] = 0x20;
  EXPECT(ul_transfer(link, addresses, values, 3, addresses, values, 3, 0, NULL) == UL_OK && values[0] == 1 &&
         values[2] == 3);
  EXPECT(ul_transfer(link, NULL, values, 3, addresses, values, 3, 0, NULL) == UL_ARGUMENT);
  values[1] = 77;
  EXPECT(ul_post(link, addresses, values, 3, NULL) == UL_OK && ul_sync(link, NULL) == UL_OK);
  EXPECT(ul_read(link, 0x11, &value, NULL) == UL_OK && value == 77);
  EXPECT(strcmp(ul_notice(NULL), "") == 0);
  EXPECT((strcmp(ul_notice(link), "") == 0) ==
         (strcmp(ul_protocol(link), "classic") != 0 || strstr(url, "protocol=classic") != NULL));
  if (strcmp(ul_protocol(link), "framed") == 0) {
    EXPECT(ul_read_control(link, 0, &value, 1, NULL) == UL_OK && value == 0x554C4652);
    EXPECT(ul_read_control(link, 0, &value, 0, NULL) == UL_RANGE);
    const uint64_t hash = 1;
    const char* unverified = NULL;
    EXPECT(ul_check_spec(link, "arm.ul", &hash, 1, &unverified) == UL_OK &&
           strstr(unverified, "without the hash of its spec") != NULL);
    EXPECT(ul_check_spec(link, NULL, &hash, 1, NULL) == UL_ARGUMENT &&
           ul_check_spec(link, "arm.ul", NULL, 1, NULL) == UL_ARGUMENT);
    EXPECT(ul_write_control(link, 0, 1, NULL) == UL_PROTOCOL_ERROR);
  } else {
    EXPECT(ul_read_control(link, 0, &value, 1, NULL) == UL_MISMATCH);
  }
  EXPECT(ul_close(link) == UL_OK && ul_close(link) == UL_OK);
  EXPECT(ul_read(link, 0x12, &value, NULL) == UL_CLOSED && ul_wait_up(link, 0) == UL_CLOSED);
  ul_free(link);
  ul_free(NULL);
  return 0;
}
