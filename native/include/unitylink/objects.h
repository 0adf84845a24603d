/* SPDX-License-Identifier: BSD-3-Clause
 *
 * A robot as values on its links: what the headers of `unitylink generate --only c` and `--only cpp` are made of. C11
 * and C++20, on the C ABI. Nothing here allocates, and no lock is held: the caller gives all room.
 *
 * Threads: calls for plain memory may come from any thread. Outputs behind a commit (TOSNET, DOUBLE_BUFFER) share a
 * shadow, so only one thread at a time may write them.
 */
#ifndef UNITYLINK_OBJECTS_H
#define UNITYLINK_OBJECTS_H

#include <unitylink/value.h>

#include <time.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What the spec says about a link of the robot. */
typedef struct {
  const char* name;
  uint32_t data_bits;
  uint32_t address_bits;
  const uint64_t* gateware; /* the wire hashes that gateware of this spec may have */
  size_t gateware_count;
} ul_link_facts;

/* Memory whose outputs take effect by a commit. The commit swaps two buffers without copying, so it needs all outputs.
 */
typedef struct {
  uint8_t link, control; /* the links of the data, and of commits and status */
  uint32_t commit;       /* the address of the commit; on TosNet also of the status word */
  uint32_t pending;      /* bits of the status word; 0: there is no status word */
  uint32_t aborted, online, halted;
  const uint32_t* addresses; /* all outputs, then the commit */
  uint32_t count;            /* outputs */
} ul_memory_facts;

typedef struct {
  const char* name; /* of the public constructor */
  const char* spec; /* the file name of the spec */
  const ul_value* values;
  uint32_t value_count;
  const ul_link_facts* links;
  uint32_t link_count;
  const ul_memory_facts* memories;
  uint32_t memory_count;
} ul_robot_facts;

/* The state of a committed memory. The arrays have room for count + 1 words. */
typedef struct {
  uint32_t* shadow; /* the words as last committed */
  uint32_t* next;
  uint8_t* known; /* whether the word of the shadow is known */
  bool settled;   /* no commit of ours can be pending */
  uint64_t generation;
} ul_memory;

typedef struct {
  const ul_robot_facts* facts;
  ul_link** links; /* link_count of them */
  bool* framed;
  ul_memory* memories;
  const char* unverified; /* why it is not known that the gateware has this spec; "": it was verified */
} ul_objects;

/* Options for requests of some values. `again`: sending them twice does no harm. */
static inline ul_options ul_how(bool checked, bool again) {
  ul_options options;
  memset(&options, 0, sizeof options);
  options.size = sizeof options;
  options.checked = checked ? 1 : -1;
  options.repeat = again ? 1 : 0;
  return options;
}

/* ---- connecting */

static inline ul_status ul_objects_check_link(ul_objects* objects, uint32_t number, ul_failure* failure) {
  const ul_robot_facts* facts = objects->facts;
  const ul_link_facts* wanted = &facts->links[number];
  ul_link* link = objects->links[number];
  const char* unverified = "";
  ul_configuration has;
  if (link == NULL)
    return ul_fail(failure, UL_ARGUMENT, facts->name, "the link '%s' is NULL; open it first", wanted->name);
  memset(&has, 0, sizeof has);
  has.size = sizeof has;
  if (ul_get_configuration(link, &has) != UL_OK) return ul_fail_link(failure, UL_ARGUMENT, facts->name);
  objects->framed[number] = strcmp(ul_protocol(link), "framed") == 0;
  if (ul_check_spec(link, facts->spec, wanted->gateware, wanted->gateware_count, &unverified) != UL_OK) {
    ul_error error;
    memset(&error, 0, sizeof error);
    error.size = sizeof error;
    ul_last_error(&error);
    return ul_fail_link(failure, error.status, facts->name);
  }
  if (has.data_bytes * 8 != wanted->data_bits || has.address_bytes * 8 < wanted->address_bits)
    return ul_fail(failure, UL_MISMATCH, facts->name,
                   "the device has words of %u and addresses of %u bits, and %s needs %u and %u: this is not its board",
                   (unsigned)has.data_bytes * 8, (unsigned)has.address_bytes * 8, facts->spec,
                   (unsigned)wanted->data_bits, (unsigned)wanted->address_bits);
  if (*unverified != '\0') objects->unverified = unverified;
  for (uint32_t i = 0; *ul_notice(link) != '\0' && i < facts->value_count; ++i) {
    if (facts->values[i].link == number && (facts->values[i].flags & UL_VALUE_FRAMES) != 0)
      return ul_fail(failure, UL_MISMATCH, facts->values[i].path,
                     "it needs the framed protocol, and the link has fallen back to the classic one: %s. Use gateware "
                     "with the framed protocol, or add protocol=classic to the URL if you want that",
                     ul_notice(link));
  }
  return UL_OK;
}

/* Checks that the boards behind the links are those of the spec. */
static inline ul_status ul_objects_check(ul_objects* objects, ul_failure* failure) {
  objects->unverified = "";
  for (uint32_t number = 0; number < objects->facts->link_count; ++number) {
    const ul_status status = ul_objects_check_link(objects, number, failure);
    if (status != UL_OK) return status;
  }
  return UL_OK;
}

/* ---- words */

static inline ul_status ul_objects_read_words(ul_objects* objects, uint32_t link, const uint32_t* addresses,
                                              size_t count, uint32_t* words, bool atomic, const ul_options* how) {
  if (count == 0) return UL_OK;
  if (count == 1) return ul_read(objects->links[link], addresses[0], words, how);
  if (objects->framed[link])
    return ul_transfer(objects->links[link], NULL, NULL, 0, addresses, words, count, atomic ? 1 : 0, how);
  return ul_read_many(objects->links[link], addresses, count, words, atomic ? 1 : 0, how);
}

static inline ul_status ul_objects_write_words(ul_objects* objects, uint32_t link, const uint32_t* addresses,
                                               const uint32_t* words, size_t count, const ul_options* how) {
  if (count == 0) return UL_OK;
  if (count == 1) return ul_write(objects->links[link], addresses[0], words[0], how);
  if (objects->framed[link]) return ul_transfer(objects->links[link], addresses, words, count, NULL, NULL, 0, 0, how);
  return ul_write_many(objects->links[link], addresses, words, count, how);
}

/* ---- committed memory */

/* Changes each time a device of the memory may have lost what was written to it. */
static inline uint64_t ul_memory_generation(const ul_objects* objects, const ul_memory_facts* facts) {
  const uint8_t links[2] = {facts->link, facts->control};
  uint64_t sum = 0;
  for (unsigned i = 0; i < (objects->links[facts->link] == objects->links[facts->control] ? 1U : 2U); ++i) {
    ul_statistics counted;
    memset(&counted, 0, sizeof counted);
    counted.size = sizeof counted;
    if (ul_get_statistics(objects->links[links[i]], &counted) == UL_OK) sum += counted.restarts + counted.reconnections;
  }
  return sum + 1; /* 0 stands for a memory that was never looked at */
}

static inline double ul_seconds(void) {
  struct timespec now;
  timespec_get(&now, TIME_UTC);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}
enum { UL_COMMIT_LOOKS = 20000 }; /* the most looks at a pending commit, should the clock be set back meanwhile */

/* Waits until no commit is pending. After a commit of our own it checks that the network has not dropped it. `status`
 * is the status word if `*status_known`. */
static inline ul_status ul_memory_settle(ul_objects* objects, const ul_memory_facts* facts, bool committed,
                                         bool status_known, uint32_t status, const char* path, ul_failure* failure) {
  const double end_s = ul_seconds() + 0.5;
  if (facts->pending == 0) return UL_OK;
  for (int looks = 0;; ++looks, status_known = false) {
    if (!status_known) {
      const ul_status read = ul_read(objects->links[facts->control], facts->commit, &status, NULL);
      if (read != UL_OK) return ul_fail_link(failure, read, path);
    }
    if ((status & facts->halted) != 0)
      return ul_fail(failure, UL_MISMATCH, path, "the TosNet network is halted until its reset");
    if ((status & facts->online) == 0)
      return ul_fail(failure, UL_MISMATCH, path, "the TosNet network is offline; outputs take no effect");
    if ((status & facts->pending) == 0) break;
    if (ul_seconds() > end_s || looks == UL_COMMIT_LOOKS)
      return ul_fail(failure, UL_TIMEOUT, path, "a commit is still pending after 0.5 s; the network does not cycle");
  }
  if (committed && (status & facts->aborted) != 0)
    return ul_fail(failure, UL_PROTOCOL_ERROR, path,
                   "the commit was aborted: another program wrote while it was pending. Write again");
  return UL_OK;
}

static inline ul_status ul_memory_read_back(ul_objects* objects, ul_memory* memory, const ul_memory_facts* facts,
                                            const char* path, ul_failure* failure) {
  const ul_options how = ul_how(false, true);
  const ul_status status =
      ul_objects_read_words(objects, facts->link, facts->addresses, facts->count, memory->shadow, false, &how);
  if (status != UL_OK) {
    memset(memory->known, 0, facts->count);
    return ul_fail_link(failure, status, path);
  }
  memset(memory->known, 1, facts->count);
  return UL_OK;
}

/* Begins a burst: the shadow is in `next`, to be changed. A running robot does not jump: what is not known is read. */
static inline ul_status ul_memory_begin(ul_objects* objects, uint32_t number, const char* path, ul_failure* failure) {
  const ul_memory_facts* facts = &objects->facts->memories[number];
  ul_memory* memory = &objects->memories[number];
  const uint64_t generation = ul_memory_generation(objects, facts);
  if (generation != memory->generation) {
    memset(memory->known, 0, facts->count);
    memory->settled = false;
    memory->generation = generation;
  }
  if (!memory->settled) {
    const ul_status status = ul_memory_settle(objects, facts, false, false, 0, path, failure);
    if (status != UL_OK) return status;
  }
  if (memchr(memory->known, 0, facts->count) != NULL) {
    const ul_status status = ul_memory_read_back(objects, memory, facts, path, failure);
    if (status != UL_OK) return status;
  }
  memcpy(memory->next, memory->shadow, facts->count * sizeof *memory->next);
  memory->next[facts->count] = 1; /* the commit */
  return UL_OK;
}

/* Writes `next` and commits it. A commit is never repeated. */
static inline ul_status ul_memory_commit(ul_objects* objects, uint32_t number, const char* path, ul_failure* failure) {
  const ul_memory_facts* facts = &objects->facts->memories[number];
  ul_memory* memory = &objects->memories[number];
  const bool at_once = objects->links[facts->link] == objects->links[facts->control] && objects->framed[facts->link];
  uint32_t word = 0;
  ul_status status;
  memory->settled = false; /* whatever happens from here on, look before the next burst */
  if (at_once) {
    status = ul_transfer(objects->links[facts->link], facts->addresses, memory->next, facts->count + 1U, &facts->commit,
                         &word, 1, 0, NULL);
  } else {
    const ul_options how = ul_how(false, true);
    status = ul_write_many(objects->links[facts->link], facts->addresses, memory->next, facts->count, &how);
    if (status == UL_OK) status = ul_write(objects->links[facts->control], facts->commit, 1, NULL);
  }
  if (status == UL_OK || status == UL_UNKNOWN)
    memcpy(memory->shadow, memory->next, facts->count * sizeof *memory->next);
  else
    memset(memory->known, 0, facts->count); /* a burst that failed half-way has left other words in the hidden buffer */
  if (status != UL_OK) return ul_fail_link(failure, status, path);
  status = ul_memory_settle(objects, facts, true, at_once, word, path, failure);
  memory->settled = status == UL_OK;
  return status;
}

#ifdef __cplusplus
}
#endif

#endif
