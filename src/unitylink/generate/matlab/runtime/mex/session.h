/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Robots that are open: their tables, their links, and their cycles and streams. MATLAB has numbers of them, never
 * pointers.
 */
#ifndef UNITYLINK_MEX_SESSION_H
#define UNITYLINK_MEX_SESSION_H

#include "conversion.h"

/* A cycle or a stream. `number` 0: closed, or an error left it half made. */
typedef struct loop {
  struct loop* next;
  uint32_t number;
  bool streams;
  ul_set outputs, inputs;
  ul_cycle cycle;
  ul_stream stream;
  block* blocks;
} loop;

typedef struct session {
  struct session* next;
  uint32_t number;
  ul_robot_facts facts;
  ul_objects objects;
  fields** packed;   /* of each value */
  uint64_t* initial; /* raw numbers */
  ul_link** opened;  /* those to free */
  uint32_t opened_count;
  loop* loops;
  block* blocks;
} session;

static session* sessions = NULL;
static session* opening = NULL; /* an error in its tables left it half made */
static uint32_t last_number = 0;

static void end_loop(loop* one) {
  if (one->number == 0) return;
  if (one->streams)
    ul_stream_stop(&one->stream);
  else
    ul_cycle_close(&one->cycle);
  one->number = 0;
}

static void free_ended(session* robot) {
  for (loop** at = &robot->loops; *at != NULL;) {
    loop* one = *at;
    if (one->number != 0) {
      at = &one->next;
      continue;
    }
    *at = one->next;
    free_blocks(one->blocks);
    free(one);
  }
}

static void free_session(session* robot) {
  for (loop* one = robot->loops; one != NULL; one = one->next) end_loop(one);
  free_ended(robot);
  for (uint32_t i = 0; i < robot->opened_count; ++i) ul_free(robot->opened[i]);
  free_blocks(robot->blocks);
  free(robot);
}

static void close_session(uint32_t number) {
  for (session** at = &sessions; *at != NULL; at = &(*at)->next) {
    session* robot = *at;
    if (robot->number != number) continue;
    *at = robot->next;
    free_session(robot);
    if (sessions == NULL) mexUnlock();
    return;
  }
}

static void close_all(void) {
  while (sessions != NULL) close_session(sessions->number);
  if (opening != NULL) free_session(opening);
  opening = NULL;
}

static session* session_of(const mxArray* number) {
  const uint32_t wanted = count_of(number);
  for (session* robot = sessions; robot != NULL; robot = robot->next) {
    if (robot->number == wanted) return robot;
  }
  raise_text(UL_CLOSED, "the robot was closed; open it again");
  return NULL;
}

/* ---- tables */

static void links_of(session* robot, const mxArray* rows) {
  ul_link_facts* links;
  const uint32_t count = (uint32_t)mxGetNumberOfElements(rows);
  robot->facts.links = links = (ul_link_facts*)room_of(&robot->blocks, count, sizeof *links);
  robot->facts.link_count = count;
  for (uint32_t i = 0; i < count; ++i) {
    const mxArray* row = item_of(rows, i);
    const mxArray* hashes = item_of(row, 3);
    uint64_t* gateware = (uint64_t*)room_of(&robot->blocks, mxGetNumberOfElements(hashes), sizeof *gateware);
    links[i].name = text_of(&robot->blocks, item_of(row, 0));
    links[i].data_bits = count_of(item_of(row, 1));
    links[i].address_bits = count_of(item_of(row, 2));
    links[i].gateware = gateware;
    links[i].gateware_count = mxGetNumberOfElements(hashes);
    for (size_t n = 0; n < links[i].gateware_count; ++n) gateware[n] = bits_of(hashes, n);
  }
}

static void memories_of(session* robot, const mxArray* rows) {
  ul_memory_facts* facts;
  const uint32_t count = (uint32_t)mxGetNumberOfElements(rows);
  robot->facts.memories = facts = (ul_memory_facts*)room_of(&robot->blocks, count, sizeof *facts);
  robot->facts.memory_count = count;
  robot->objects.memories = (ul_memory*)room_of(&robot->blocks, count, sizeof(ul_memory));
  for (uint32_t i = 0; i < count; ++i) {
    const mxArray* row = item_of(rows, i);
    const mxArray* given = item_of(row, 7);
    const uint32_t words = (uint32_t)mxGetNumberOfElements(given); /* all outputs, then the commit */
    uint32_t* addresses = (uint32_t*)room_of(&robot->blocks, words, sizeof *addresses);
    ul_memory* memory = &robot->objects.memories[i];
    facts[i].link = (uint8_t)count_of(item_of(row, 0));
    facts[i].control = (uint8_t)count_of(item_of(row, 1));
    facts[i].commit = word_of(item_of(row, 2));
    facts[i].pending = word_of(item_of(row, 3));
    facts[i].aborted = word_of(item_of(row, 4));
    facts[i].online = word_of(item_of(row, 5));
    facts[i].halted = word_of(item_of(row, 6));
    for (uint32_t n = 0; n < words; ++n) addresses[n] = (uint32_t)bits_of(given, n);
    facts[i].addresses = addresses;
    if (words == 0 || facts[i].link >= robot->facts.link_count || facts[i].control >= robot->facts.link_count)
      raise_text(UL_ARGUMENT, "a table is not that of generated code; generate again");
    facts[i].count = words - 1;
    memory->shadow = (uint32_t*)room_of(&robot->blocks, words, sizeof(uint32_t));
    memory->next = (uint32_t*)room_of(&robot->blocks, words, sizeof(uint32_t));
    memory->known = (uint8_t*)room_of(&robot->blocks, words, 1);
  }
}

static void values_of(session* robot, const mxArray* table) {
  const mxArray* rows = field_of(table, "values");
  const uint32_t count = (uint32_t)mxGetNumberOfElements(rows);
  ul_value* values = (ul_value*)room_of(&robot->blocks, count, sizeof *values);
  robot->facts.values = values;
  robot->facts.value_count = count;
  robot->packed = (fields**)room_of(&robot->blocks, count, sizeof *robot->packed);
  robot->initial = (uint64_t*)room_of(&robot->blocks, count, sizeof *robot->initial);
  for (uint32_t i = 0; i < count; ++i) {
    value_of(&robot->blocks, &values[i], item_of(rows, i));
    robot->packed[i] = fields_of(&robot->blocks, item_of(field_of(table, "fields"), i));
    robot->initial[i] = bits_of(field_of(table, "initial"), i);
    if (values[i].link >= robot->facts.link_count || values[i].memory >= (int32_t)robot->facts.memory_count ||
        (values[i].memory >= 0 &&
         values[i].slot + values[i].words > (int32_t)robot->facts.memories[values[i].memory].count))
      raise_text(UL_ARGUMENT, "a table is not that of generated code; generate again");
  }
}

/* Gives the links back at once, because another program may want them, and raises the error. */
static void give_up(ul_status status, const char* text) {
  char kept[1024];
  snprintf(kept, sizeof kept, "%s", text);
  free_session(opening);
  opening = NULL;
  raise_text(status, kept);
}

/* Opens a robot. `urls`: a URL for each link, or one for all, which then is one link. */
static session* open_session(const mxArray* table, const mxArray* urls) {
  ul_failure failure;
  session* robot;
  uint32_t given;
  if (opening != NULL) free_session(opening);
  opening = robot = (session*)calloc(1, sizeof *robot);
  if (robot == NULL) raise_text(UL_NO_MEMORY, "no memory is left");
  robot->facts.name = text_of(&robot->blocks, field_of(table, "name"));
  robot->facts.spec = text_of(&robot->blocks, field_of(table, "spec"));
  links_of(robot, field_of(table, "links"));
  memories_of(robot, field_of(table, "memories"));
  values_of(robot, table);
  given = urls != NULL && mxIsCell(urls) ? (uint32_t)mxGetNumberOfElements(urls) : 0;
  if (given != 1 && given != robot->facts.link_count)
    raise_text(UL_ARGUMENT, "give the URL of the link, or one for each link");
  robot->objects.facts = &robot->facts;
  robot->objects.links = (ul_link**)room_of(&robot->blocks, robot->facts.link_count, sizeof(ul_link*));
  robot->objects.framed = (bool*)room_of(&robot->blocks, robot->facts.link_count, sizeof(bool));
  robot->opened = (ul_link**)room_of(&robot->blocks, given, sizeof(ul_link*));
  for (uint32_t i = 0; i < given; ++i) {
    const ul_status status = ul_open(text_of(&robot->blocks, item_of(urls, i)), &robot->opened[i]);
    if (status != UL_OK) give_up(status, ul_last_error_text());
    robot->opened_count = i + 1;
  }
  for (uint32_t i = 0; i < robot->facts.link_count; ++i) robot->objects.links[i] = robot->opened[given == 1 ? 0 : i];
  if (ul_objects_check(&robot->objects, &failure) != UL_OK) give_up(failure.status, failure.text);
  opening = NULL;
  /* else `clear mex` would begin the numbers anew, and an old object would have this robot */
  if (sessions == NULL) mexLock();
  robot->number = ++last_number;
  robot->next = sessions;
  sessions = robot;
  return robot;
}

/* ---- sets */

/* Values by their places, counted from `first`. The set lives as long as `blocks`. */
static ul_set set_of(const session* robot, block** blocks, const mxArray* name, uint32_t first, const mxArray* places) {
  ul_set set = {text_of(blocks, name), NULL, 0, 0};
  uint16_t* kept;
  if (!mxIsDouble(places)) raise_text(UL_ARGUMENT, "places are numbers");
  set.count = (uint32_t)mxGetNumberOfElements(places);
  set.values = kept = (uint16_t*)room_of(blocks, set.count, sizeof *kept);
  for (uint32_t i = 0; i < set.count; ++i) {
    const double place = mxGetPr(places)[i];
    if (!(place >= 0.0 && place <= NUMBERS_MAX && first + place < robot->facts.value_count))
      raise_text(UL_ARGUMENT, "there is no value at this place");
    kept[i] = (uint16_t)place;
    set.words += robot->facts.values[first + kept[i]].words;
  }
  return set;
}

#endif
