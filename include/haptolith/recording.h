/* libhaptolith_recording: recordings of loops, written, read, and replayed bit for bit. A separate library next to
 * libhaptolith, because it brings HDF5, of which a process should have one.
 *
 * The conventions are those of haptolith.h: every function returns a status, hapto_last_error() reports the reason, one
 * thread at a time uses a handle, structs begin with `size`. Nothing here is for 1 kHz. Content of a recording, and reading it in other
 * programs: docs/reference/recording-file.md.
 */
#ifndef HAPTOLITH_RECORDING_H
#define HAPTOLITH_RECORDING_H

#include <haptolith/haptolith.h>

#ifdef __cplusplus
extern "C" {
#endif

/* --- writing -------------------------------------------------------------------------------------------------------- */

typedef struct hapto_recorder hapto_recorder;

enum { HAPTO_RECORDER_OVERWRITE = 1 /* a file that is there; it stays as it is until the new one has been made */ };

/* Begins to record a loop that was made with HAPTO_LOOP_KEEPS_TICKS. With HAPTO_LOOP_HASHES too, begun before the first tick,
 * and of a scene that has not been stepped or changed before, it can be run again and verified.
 * path          ends in ".h5". Threads of the recorder's write; what was taken is in the file within half a second, and a
 *               program that is killed leaves a file that can be read.
 * frames_per_s  frames with all particles, 0 to 60. */
HAPTO_API int32_t hapto_recorder_create(hapto_loop *loop, const char *path, double frames_per_s, uint32_t flags,
                                        hapto_recorder **out);
/* Takes what is new: the ticks that wait, a frame when it is time for one, trips, the end. Call it every second or more often,
 * from the thread that takes snapshots of the loop, and before the loop is destroyed; it takes a snapshot itself.
 * HAPTO_FAILURE: the disk takes no more, and what is in the file stays. */
HAPTO_API int32_t hapto_recorder_take(hapto_recorder *recorder);
/* Something that happened, at the time of the last tick that was taken: `kind` is a word of 31 bytes at most, `text` of 479. */
HAPTO_API int32_t hapto_recorder_note(hapto_recorder *recorder, const char *kind, const char *text);
/* Takes what is new and closes the file. HAPTO_FAILURE: not all is in it, or the loop has been destroyed before its end was taken.
 * HAPTO_BUSY: another thread is watching the loop; nothing has been finished. */
HAPTO_API int32_t hapto_recorder_finish(hapto_recorder *recorder);

typedef struct hapto_recorder_info { /* amount that is safe in the file */
  uint32_t size;
  uint32_t reserved;
  uint64_t ticks, frames, events, bytes;
  uint64_t missing;         /* ticks that should be in it, and are not: they were not taken in time */
  uint64_t frames_left_out; /* frames that a slow disk could not store */
} hapto_recorder_info;
HAPTO_API int32_t hapto_recorder_get_info(const hapto_recorder *recorder, hapto_recorder_info *out);
/* Finishes it, if need be; it is destroyed whatever the status, which is that of finishing. */
HAPTO_API int32_t hapto_recorder_destroy(hapto_recorder *recorder);

/* --- reading -------------------------------------------------------------------------------------------------------- */

typedef struct hapto_recording hapto_recording;

/* Any recording of haptolith's: `haptolith run --record`, the page's, a recorder's; also one whose writer was killed, or still
 * writes. Lengths and types that the file claims are checked. */
HAPTO_API int32_t hapto_recording_open(const char *path, hapto_recording **out);

typedef struct hapto_recording_info {
  uint32_t size;
  int32_t finished;       /* 0: its writer was killed, or still writes */
  uint64_t ticks, frames, events;
  uint64_t missing_ticks; /* that should be in it, and are not, as far as its writer has counted */
  uint64_t start_tick;    /* 0: from the beginning of its run, so that it can be run again */
  double tick_s;
} hapto_recording_info;
HAPTO_API int32_t hapto_recording_get_info(const hapto_recording *recording, hapto_recording_info *out);
/* The header as a JSON object: "scenario" (the scene as TOML), "title", "program_version", "instruction_set", "arithmetic"
 * (set of bits that a replay needs: "fused" or "unfused"; "" for release 0.2.0 and earlier), "device", "device_limits", "host",
 * "started_utc", "seed", "threads", "hashed_parts". With the bytes needed, as hapto_scene_get_toml(). */
HAPTO_API int32_t hapto_recording_get_header(const hapto_recording *recording, char *json, uint64_t capacity, uint64_t *needed);
/* Events, as a JSON array of objects: "time_s", "tick", "kind", "text". Lengths as above. */
HAPTO_API int32_t hapto_recording_get_events(const hapto_recording *recording, char *json, uint64_t capacity, uint64_t *needed);
/* Up to `capacity` ticks from number `first` on; `count` is how many there were. */
HAPTO_API int32_t hapto_recording_read_ticks(const hapto_recording *recording, uint64_t first, hapto_tick *out, uint64_t capacity,
                                             uint64_t *count);

typedef struct hapto_recorded_frame {
  uint32_t size;
  uint32_t reserved;
  double time_s;
  uint64_t tick;
  uint64_t particles;
} hapto_recorded_frame;
/* A frame: its description, and the positions of all particles, x y z in m of one after the other. `capacity` counts floats, three
 * for a particle; positions may be NULL with capacity 0, which gives HAPTO_OK and the numbers in `out`. */
HAPTO_API int32_t hapto_recording_read_frame(const hapto_recording *recording, uint64_t index, hapto_recorded_frame *out,
                                             float *positions, uint64_t capacity);

typedef struct hapto_replay_report {
  uint32_t size;
  int32_t same;               /* 1: every replayed tick was bit-identical to the recorded one */
  uint64_t ticks;             /* run again */
  uint64_t hashes;            /* of the soil, that were compared */
  uint64_t different_tick;    /* the first that was not the same, from 0, and what of it: */
  const char *different;      /* "state_hash", "tool pose", "soil wrench", "rendered force", "device wrench", "injected energy",
                                 "trip", "end", "flags"; "" when all were */
  const char *ended_early;    /* why the rest could not be run again; "" when all was */
  uint64_t missing;           /* ticks missing in the recording, behind which nothing can be run again */
} hapto_replay_report;
/* Runs it again and compares every tick, bit by bit, to the first difference: hashes of the soil, the tool's pose, the wrenches,
 * energy, trip and flags. What the device reported is fed in, and times of work are not compared. Texts are valid until the
 * recording's next verification.
 * threads  that share a tick; 0: as recorded. The result must not depend on it. */
HAPTO_API int32_t hapto_recording_verify(hapto_recording *recording, uint32_t threads, hapto_progress progress, void *user,
                                         hapto_replay_report *out);
HAPTO_API int32_t hapto_recording_destroy(hapto_recording *recording);

#ifdef __cplusplus
}
#endif

#endif
