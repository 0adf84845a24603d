/* SPDX-License-Identifier: BSD-3-Clause
 * Holds the joint at an angle, 1000 times a second:  loop LINK ANGLE SECONDS */
#define _POSIX_C_SOURCE 200809L
#include <stdlib.h>
#include <time.h>

#include "joint.h"

static joint robot;
static joint_cycle cycle;

int main(int count, char** arguments) {
  ul_link* link = NULL;
  if (count != 4) return fprintf(stderr, "usage: loop LINK ANGLE SECONDS\n"), 2;
  if (ul_open(arguments[1], &link) != UL_OK) return fprintf(stderr, "%s\n", ul_last_error_text()), 1;
  ul_status status = joint_open(&robot, link); /* checks that the board has this spec */
  if (status == UL_OK) status = ul_set_dead_man(link, 1000000000, NULL);
  if (status == UL_OK) status = joint_cycle_open(&robot, &cycle); /* from here on nothing is allocated */
  const double wanted = atof(arguments[2]);
  const long cycles = lround(1000 * atof(arguments[3]));
  joint_outputs out;
  joint_inputs in = {0};
  struct timespec due;
  joint_initial(&out);
  clock_gettime(CLOCK_MONOTONIC, &due);
  for (long left = cycles; left > 0 && status == UL_OK; --left) {
    status = joint_exchange(&cycle, &out, &in); /* one message each way */
    out.torque = fmax(-2.0, fmin(2.0, 8.0 * (wanted - in.angle) - 0.6 * in.speed));
    if ((due.tv_nsec += 1000000) >= 1000000000) due.tv_nsec -= 1000000000, ++due.tv_sec;
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, NULL);
  }
  if (status == UL_OK) status = joint_torque_write(&robot, 0.0);
  if (status != UL_OK) fprintf(stderr, "%s\n", joint_error(&robot));
  if (status == UL_OK) printf("%ld cycles, the angle is %.3f rad\n", cycles, in.angle);
  ul_free(link);
  return status == UL_OK ? 0 : 1;
}
