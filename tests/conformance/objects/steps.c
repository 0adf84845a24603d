/* SPDX-License-Identifier: BSD-3-Clause
 * The steps in C. steps.py and steps.cpp do the same and print the same lines. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "steps.h"

static int step = 0;
static steps robot;

static void must(ul_status status) {
  if (status == UL_OK) return;
  fprintf(stderr, "%s\n", steps_error(&robot));
  exit(1);
}

static void say(const char* name) { printf("%02d %s: ", ++step, name); }

static void refused(const char* name, ul_status status) {
  say(name);
  puts(status == UL_OK ? "done" : status == UL_RANGE ? "refused" : "unexpected");
}

static void say_count(void) {
  uint32_t count = 0;
  must(steps_count_read(&robot, &count));
  say("count");
  printf("%" PRIu32 "\n", count);
}

static void say_small(void) {
  int8_t small = 0;
  must(steps_small_read(&robot, &small));
  say("small");
  printf("%d\n", small);
}

static void say_big(void) {
  uint64_t big = 0;
  must(steps_big_read(&robot, &big));
  say("big");
  printf("%" PRIu64 "\n", big);
}

static void whole(void) {
  must(steps_count_write(&robot, 123456));
  say_count();
  must(steps_count_write(&robot, 4294967295U));
  say_count();
  must(steps_small_write(&robot, -100));
  say_small();
  refused("small 101", steps_small_write(&robot, 101));
  refused("small -101", steps_small_write(&robot, -101));
  say_small();
  must(steps_big_write(&robot, 18446744073709551615U));
  say_big();
  must(steps_big_write(&robot, 81985529216486895U));
  say_big();
}

static void say_torque(const steps_joint* joint) {
  double torque = 0.0;
  must(steps_joint_torque_read(joint, &torque));
  say("torque");
  printf("%.8f\n", torque);
}

static void real(void) {
  double number = 0.0, other = 0.0;
  must(steps_gain_write(&robot, 2.5));
  must(steps_gain_read(&robot, &number));
  say("gain");
  printf("%.6f\n", number);
  refused("gain 10.5", steps_gain_write(&robot, 10.5));
  refused("gain NaN", steps_gain_write(&robot, NAN));
  must(steps_exact_write(&robot, -0.1));
  must(steps_exact_read(&robot, &number));
  say("exact");
  printf("%.17g\n", number);
  refused("exact infinite", steps_exact_write(&robot, INFINITY));
  must(steps_joint_torque_write(&robot.j[0], 1.503));
  say_torque(&robot.j[0]);
  must(steps_joint_torque_write(&robot.j[1], 99.0));
  say_torque(&robot.j[1]);
  must(steps_joint_torque_write(&robot.j[1], -99.0));
  say_torque(&robot.j[1]);
  must(steps_joint_target_write(&robot.j[0], -1.2345));
  refused("target 3.5", steps_joint_target_write(&robot.j[0], 3.5));
  must(steps_joint_pos_read(&robot.j[0], &number));
  must(steps_joint_pos_read(&robot.j[1], &other));
  say("pos");
  printf("%.3f %.3f\n", number, other);
}

static void say_level(void) {
  steps_level_t level = 0;
  must(steps_level_read(&robot, &level));
  say("level");
  printf("%d\n", level);
}

static void named(void) {
  steps_mode_t mode = STEPS_MODE_IDLE;
  steps_status_t status = {true, STEPS_MODE_RUN, -12.5};
  bool lamps[3] = {true, false, true};
  must(steps_joint_mode_write(&robot.j[0], STEPS_MODE_STOP));
  must(steps_joint_mode_read(&robot.j[0], &mode));
  say("mode");
  printf("%d\n", mode);
  refused("mode 2", steps_joint_mode_write(&robot.j[0], 2));
  refused("mode of the board", steps_joint_mode_read(&robot.j[1], &mode));
  must(steps_level_write(&robot, STEPS_LEVEL_HIGH));
  say_level();
  must(steps_level_write(&robot, 200));
  say_level();
  must(steps_status_write(&robot, status));
  must(steps_status_read(&robot, &status));
  say("status");
  printf("%d %d %.1f\n", status.ready, status.mode, status.heat);
  status.heat = 64.0;
  refused("status hot", steps_status_write(&robot, status));
  for (uint32_t item = 0; item < 3; ++item) {
    must(steps_lamps_write(&robot, item, lamps[item]));
    must(steps_lamps_read(&robot, item, &lamps[item]));
  }
  say("lamps");
  printf("%d %d %d\n", lamps[0], lamps[1], lamps[2]);
}

static void say_faults(void) {
  uint8_t faults = 0;
  must(steps_faults_read(&robot, &faults));
  say("faults");
  printf("%d\n", faults);
}

static void say_net(void) {
  int32_t a = 0;
  double b = 0.0;
  must(steps_table_a_read(&robot.net, &a));
  must(steps_table_b_read(&robot.net, &b));
  say("net");
  printf("%" PRId32 " %.1f\n", a, b);
}

static void special(void) {
  uint16_t lost = 0;
  say_faults();
  must(steps_faults_clear(&robot, 4));
  say_faults();
  must(steps_lost_read(&robot, &lost));
  say("lost");
  printf("%d\n", lost);
  must(steps_reset_pulse(&robot, 3));
  say("reset");
  puts("pulsed");
  refused("reset 16", steps_reset_pulse(&robot, 16));
  must(steps_table_a_write(&robot.net, -7));
  say_net();
  must(steps_table_b_write(&robot.net, 12.3));
  say_net();
  must(steps_table_a_write(&robot.net, 8));
  say_net();
}

static void say_joint(const char* name, const steps_joint_inputs* state) {
  say(name);
  printf("%.3f %d %.3f\n", state->pos, state->mode, state->torque);
}

static void together(void) {
  const steps_targets_outputs targets = {0.25, -0.25};
  steps_joint_outputs out = {1.5, STEPS_MODE_RUN, -2.25};
  steps_joint_inputs in;
  steps_joint_cycle cycle;
  steps_inputs shot;
  steps_published_pose pose;
  uint16_t limit = 0;
  double time_s = 0.0;
  bool come = false;
  must(steps_targets_write(&robot, &targets));
  must(steps_limit_read(&robot, &limit));
  say("limit");
  printf("%d\n", limit);
  must(steps_joint_mode_write(&robot.j[1], STEPS_MODE_IDLE));
  must(steps_joint_cycle_open(&robot.j[0], &cycle));
  must(steps_joint_exchange(&cycle, &out, &in));
  say_joint("cycle", &in);
  out.target = 4.0;
  refused("cycle 4", steps_joint_exchange(&cycle, &out, &in));
  out.target = -1.5;
  out.mode = STEPS_MODE_STOP;
  out.torque = 50.0;
  must(steps_joint_exchange(&cycle, &out, &in));
  say_joint("cycle", &in);
  steps_joint_cycle_close(&cycle);
  must(steps_snapshot(&robot, &shot, false));
  say("snapshot");
  printf("%" PRIu32 " %d %" PRIu64 " %.3f %.3f\n", shot.count, shot.small, shot.big, shot.gain, shot.j[1].torque);
  must(steps_published_pose_start(&robot, 4096));
  must(steps_published_pose_wait(&robot, 10000000000U, &come));
  must(steps_published_pose_poll(&robot, &time_s, &pose, &come));
  say("published");
  printf("%.3f\n", pose.j_1_pos);
  steps_published_pose_stop(&robot);
}

int main(int count, char** arguments) {
  ul_link* link = NULL;
  if (count < 2) return 2;
  if (ul_open(arguments[1], &link) != UL_OK) {
    fprintf(stderr, "%s\n", ul_last_error_text());
    return 1;
  }
  must(steps_open(&robot, link));
  whole();
  real();
  named();
  special();
  together();
  ul_free(link);
  return 0;
}
