/* libhaptolith: soil that a hand, a robot or a simulator can dig in, at 1 kHz.
 *
 *     hapto_scene *scene = NULL;
 *     hapto_pose pose = {{0, 0, 0.06}, {1, 0, 0, 0}};
 *     hapto_wrench soil_wrench;
 *     if (hapto_scene_from_file("icra2021", NULL, 0, NULL, NULL, &scene) == HAPTO_OK &&
 *         hapto_scene_step(scene, &pose, NULL, &soil_wrench) == HAPTO_OK) { ... }
 *     hapto_scene_destroy(scene);
 *
 * Conventions
 *   - SI units: m, s, kg, N, rad. Quaternions are w, x, y, z. Frames are right-handed.
 *   - Scene frame: z points up, the origin is on the floor at the centre of the box. A pose is scene_T_tool: the
 *     tool's frame in the scene's.
 *   - Device frame: a haptic device's own. hapto_device_limits.turn_rad and the scene's [mapping] turn it into the scene's.
 *   - Soil wrench: what the soil does to the tool, about the tool's origin, scene frame, unfiltered. Device wrench: what is
 *     sent to the device, behind mapping, filter and safety layer, about the handle's origin, device frame.
 *   - Parameters are the keys of scene files (docs/reference/scenes.md): as a file, as text, or as overrides
 *     "table.key=value", for example "soil.preset=P3" or "bed.threads=4".
 *   - Every function returns a status; HAPTO_OK is 0. hapto_last_error() reports the reason. Nothing is printed,
 *     nothing is thrown, and no call ends the process.
 *   - [1 kHz]: may be called in a loop that must keep time. Such a function allocates nothing, takes no lock, writes no
 *     file, and on failure returns the status alone: hapto_last_error() is as it was.
 *   - Threads: a handle may be used by one thread at a time, different handles by any. A handle that another thread is
 *     using gives HAPTO_BUSY, a destroyed one HAPTO_DESTROYED while that is detectable.
 *   - Structs that begin with `size` may grow at their end: set it to sizeof the struct, and the rest to 0. The library
 *     accepts every size from that of the struct's first version on. It neither reads nor writes beyond the caller's size:
 *     what is missing counts as 0. Members that a later header has and this library does not know stay as they were.
 *   - A pose, a twist and a wrench are plain numbers and stay as they are, so that arrays of them are arrays of 7, 6 and 6
 *     doubles. hapto_array, hapto_device_limits and hapto_tick lie inside other structs or in arrays: they do not grow.
 *   - The same version, scene and movements give the same bits on every processor, for any number of threads. There are two
 *     sets of bits, called arithmetic: "fused" (AVX2, AVX-512, NEON, SCALAR) and "unfused" (SSE4, SSSE3, WebAssembly).
 *
 * Environment, read once: HAPTOLITH_CACHE (the folder where settled soil is kept between runs, or "off"), HAPTOLITH_SIMD
 * (an instruction set other than the machine's best).
 */
#ifndef HAPTOLITH_HAPTOLITH_H
#define HAPTOLITH_HAPTOLITH_H

#include <stdint.h>

#include <haptolith/version.h>

#if defined(_WIN32)
#if defined(HAPTO_BUILDING)
#define HAPTO_API __declspec(dllexport)
#else
#define HAPTO_API __declspec(dllimport)
#endif
#elif defined(__GNUC__)
#define HAPTO_API __attribute__((visibility("default")))
#else
#define HAPTO_API
#endif

/* A member that has been renamed: its old name is deprecated and goes with version 0.4. */
#if defined(__GNUC__)
#define HAPTO_RENAMED(now, was) __extension__ union { now; was; }
#else
#define HAPTO_RENAMED(now, was) union { now; was; }
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* --- version and errors ------------------------------------------------------------------------------------------- */

/* The library's: 1000000 * major + 1000 * minor + patch, as HAPTO_VERSION of the header. [1 kHz] */
HAPTO_API uint32_t hapto_version(void);
HAPTO_API const char *hapto_version_string(void);

enum {
  HAPTO_OK = 0,
  HAPTO_INVALID_PARAMETER = 1, /* a value is not valid: hapto_last_error() names key, value and what would be */
  HAPTO_FAILURE = 2,           /* understood, and could not be done: no file, no device, no solution */
  HAPTO_STOPPED = 3,           /* the progress function gave up */
  HAPTO_NOT_FINITE = 4,        /* the bed is no longer numbers; only another state helps */
  HAPTO_COLLAPSED = 5,         /* the bed has collapsed onto itself; only another state helps */
  HAPTO_BUSY = 6,              /* another thread or a loop is using the handle */
  HAPTO_DESTROYED = 7,         /* not a handle of this kind, or no longer */
  HAPTO_NULL = 8,              /* a pointer that must not be NULL is */
  HAPTO_WRONG_SIZE = 9,        /* a struct whose `size` is less than that of its first version */
  HAPTO_TOO_SMALL = 10,        /* the buffer; nothing has been written but how much is needed */
  HAPTO_NO_MEMORY = 11,
  HAPTO_ENDED = 12,     /* the loop has ended: hapto_loop_snapshot() says why */
  HAPTO_WRONG_TOOL = 13 /* the scene has no tool of this number, or not as many tools as there are poses */
};

/* The last error of a function that this thread has called. Texts are never NULL, may be empty, and are valid until
 * the thread's next failure. */
typedef struct hapto_error {
  uint32_t size;
  int32_t status;
  const char *message; /* a sentence */
  const char *key;     /* "bed.threads" */
  const char *value;   /* as it was given */
  const char *valid;   /* "a whole number, 1 to 256" */
} hapto_error;
HAPTO_API int32_t hapto_last_error(hapto_error *out);
/* For companion libraries: sets the text of hapto_last_error() for this thread, and returns the status. NULL is
 * "". */
HAPTO_API int32_t hapto_note_error(int32_t status, const char *message, const char *key, const char *value,
                                   const char *valid);
/* A status in words. [1 kHz] */
HAPTO_API const char *hapto_status_text(int32_t status);

/* --- plain numbers ------------------------------------------------------------------------------------------------ */

typedef struct hapto_pose {
  double position_m[3];
  double orientation[4]; /* w x y z, of norm 1 +- 1 % */
} hapto_pose;

typedef struct hapto_twist { /* velocity of the moving body's origin, in the frame of its pose */
  double linear_m_s[3];
  double angular_rad_s[3];
} hapto_twist;

typedef struct hapto_wrench { /* every use states the body, the point and the frame */
  double force_n[3];
  double torque_nm[3];
} hapto_wrench;

/* Elements in memory that belongs to the library. */
typedef struct hapto_array {
  uint32_t size;
  int32_t type;          /* HAPTO_FLOAT32, HAPTO_FLOAT64 or HAPTO_UINT8 */
  uint64_t count;        /* of elements */
  uint32_t components;   /* of each: 3 of a position */
  uint32_t stride_bytes; /* from one element to the next */
  const void *data;
} hapto_array;
enum { HAPTO_FLOAT32 = 1, HAPTO_FLOAT64 = 2, HAPTO_UINT8 = 3 };

/* Receives the current work and its progress, 0 to 1, or -1 where that is not known; return 0 to give up.
 * `what` is valid during the call. May come from another thread than the caller's, one at a time. */
typedef int32_t (*hapto_progress)(void *user, const char *what, double share);

typedef struct hapto_scene hapto_scene;
typedef struct hapto_batch hapto_batch;
typedef struct hapto_soil hapto_soil;
typedef struct hapto_result hapto_result;
typedef struct hapto_loop hapto_loop;
typedef struct hapto_safety hapto_safety;

/* --- results with more than one number ---------------------------------------------------------------------------- */

/* A JSON object, valid until the result is destroyed. */
HAPTO_API int32_t hapto_result_json(const hapto_result *result, const char **json);
/* A number of it, by its path: "residual_friction_angle_deg", "points.0.peak_pa". */
HAPTO_API int32_t hapto_result_value(const hapto_result *result, const char *path, double *out);
/* A column of its table, doubles. Names of the columns are in the JSON, under "columns". */
HAPTO_API int32_t hapto_result_column(const hapto_result *result, const char *name, hapto_array *out);
HAPTO_API int32_t hapto_result_destroy(hapto_result *result);

/* Available items, as {"names": [...]}: "scenes", "soils", "presets", "bodies", "lab tests" or "instruction set" (the one in use). */
HAPTO_API int32_t hapto_list(const char *what, hapto_result **out);

/* --- scenes: soil in a box and a tool, or several ------------------------------------------------------------------- */

/* A scene from the text of a scene file; NULL or "" is the scene icra2021.
 * name       its name in messages; NULL: "scene". Files that it names are relative to that name.
 * overrides  `count` texts "table.key=value" that replace keys of the file.
 * progress   may be NULL. Soil that settles takes seconds to minutes the first time.
 * Errors: HAPTO_INVALID_PARAMETER with key, value and valid range; HAPTO_FAILURE when soil does not settle. */
HAPTO_API int32_t hapto_scene_from_toml(const char *text, const char *name, const char *const *overrides, uint32_t count,
                                        hapto_progress progress, void *user, hapto_scene **out);
/* As above from a built-in scene of that name ("icra2021", "regolith": hapto_list("scenes")), or a file. "auto" is soil of the
 * Moon in the finest particles that this machine renders at 1 kHz with a core left to others: it measures the machine,
 * about a second the first time, and keeps the result with settled soil. Overrides of soil.radius_mm and bed.threads
 * count. */
HAPTO_API int32_t hapto_scene_from_file(const char *name_or_path, const char *const *overrides, uint32_t count,
                                        hapto_progress progress, void *user, hapto_scene **out);
/* Another scene that continues from here with the same bits. */
HAPTO_API int32_t hapto_scene_clone(const hapto_scene *scene, hapto_scene **out);
HAPTO_API int32_t hapto_scene_destroy(hapto_scene *scene);

typedef struct hapto_scene_info {
  uint32_t size;
  uint32_t substeps;  /* per tick */
  uint32_t threads;   /* that share one, at most */
  uint32_t friction;  /* friction model, 0: icra2021, 1: contact */
  uint64_t particles; /* the indices of all arrays */
  uint64_t held;      /* of these, that stand for ever where a box of settled soil ends */
  uint64_t awake;     /* that were worked on in the last tick, in whole groups of 16 */
  uint64_t steps;     /* substeps since the soil was made */
  double tick_s;      /* what a step advances time by */
  double radius_m;    /* of a particle */
  double mass_kg;     /* of one of that radius */
  double width_m, length_m;  /* of the box, along x and y */
  double surface_m;          /* height of the topmost particle's top above the floor */
  double opening_m;          /* between the jaws of the first tool */
  double tool_fade;          /* 1: the first tool touches the soil with all its stiffness */
  double energy_j;           /* kinetic, gravitational and of contacts; gravity's zero is the origin */
  double gravity_m_s2[3];
} hapto_scene_info;
/* Goes through all particles: not for a 1 kHz loop. */
HAPTO_API int32_t hapto_scene_get_info(const hapto_scene *scene, hapto_scene_info *out);

/* The scene as TOML, complete: hapto_scene_from_toml() makes one like it. With its zero byte it needs `needed` bytes;
 * when `capacity` is less, nothing is written and the status is HAPTO_TOO_SMALL. text may be NULL then. */
HAPTO_API int32_t hapto_scene_get_toml(const hapto_scene *scene, char *text, uint64_t capacity, uint64_t *needed);

/* Puts the tool somewhere without moving it there. Soil that finds itself inside is pushed out with full force: place it
 * above the soil. [1 kHz] */
HAPTO_API int32_t hapto_scene_place_tool(hapto_scene *scene, const hapto_pose *scene_T_tool);
HAPTO_API int32_t hapto_scene_get_tool_pose(const hapto_scene *scene, hapto_pose *scene_T_tool); /* [1 kHz] */

/* One tick of tick_s: moves the tool in a straight line to the pose while the soil answers.
 * twist        how fast the tool moves, for damping and friction; NULL: as the way from where it was says.
 * soil_wrench  wrench of the soil on the tool, mean over the tick, about the tool's origin, scene frame; may be NULL.
 * Errors: HAPTO_INVALID_PARAMETER for a pose that is not finite, not of norm 1, or further than 1 m outside the box or
 * 3 m above its floor; HAPTO_NOT_FINITE and HAPTO_COLLAPSED from then on until another state is set. [1 kHz] */
HAPTO_API int32_t hapto_scene_step(hapto_scene *scene, const hapto_pose *scene_T_tool, const hapto_twist *twist,
                                   hapto_wrench *soil_wrench);
/* `count` ticks: poses[i], twists[i] (or NULL) give soil_wrenches[i] (or NULL). Ends at the first failure; `done` (or NULL) is how
 * many went well. [1 kHz] in cost a tick. */
HAPTO_API int32_t hapto_scene_steps(hapto_scene *scene, uint64_t count, const hapto_pose *poses,
                                    const hapto_twist *twists, hapto_wrench *soil_wrenches, uint64_t *done);

/* Wrench of the soil on the tool in the last tick, about the tool's origin, scene frame. [1 kHz] */
HAPTO_API int32_t hapto_scene_get_wrench(const hapto_scene *scene, hapto_wrench *soil_wrench);
/* Derivative of the force for a small movement of the tool with unchanged velocities of the soil: dF = -K dx, K row by row in N/m, scene frame. To
 * extrapolate between ticks in a loop that is faster. [1 kHz] */
HAPTO_API int32_t hapto_scene_get_contact_stiffness(const hapto_scene *scene, double n_m[9]);
/* Sets the opening of the jaws at the end of the next tick, 0 to 1; without effect on other tools. [1 kHz] */
HAPTO_API int32_t hapto_scene_set_opening(hapto_scene *scene, double share);
/* Force of the soil that opened the jaws in the last tick. [1 kHz] */
HAPTO_API int32_t hapto_scene_get_grip_force(const hapto_scene *scene, double *n);
/* Sets the present fraction of the tool, 0 to 1, from the next tick on: a tool that grows slowly moves soil out of its way
 * gently. [1 kHz] */
HAPTO_API int32_t hapto_scene_set_tool_fade(hapto_scene *scene, double share);
/* Gravity from the next tick on, scene frame, 1000 m/s^2 at most: for a box on a vehicle. Another gravity wakes all soil that
 * sleeps. [1 kHz] */
HAPTO_API int32_t hapto_scene_set_gravity(hapto_scene *scene, const double m_s2[3]);

/* Changes soil, gravity or tools of the soil as it lies, by overrides: "gravity.body=Mars", "tool.diameter_mm=40" (every
 * tool), "tools.left.friction=0.4". HAPTO_INVALID_PARAMETER when that needs another bed: another particle radius, more
 * steps in a tick, any other table. */
HAPTO_API int32_t hapto_scene_change(hapto_scene *scene, const char *const *overrides, uint32_t count);

/* Scenes with several [[tools]], up to 16, have numbers for them from 0 on, in the order of the file. Each tool starts
 * [mapping] offset_mm above the soil. A tool other than the first does not touch the soil until it is placed or stepped
 * for the first time. Functions without a tool's number are for the first tool; the others then stay where they are. */
HAPTO_API int32_t hapto_scene_tools(const hapto_scene *scene, uint32_t *count); /* [1 kHz] */
/* Name of a tool, "tool" in a scene without [[tools]]; valid until the scene is destroyed. [1 kHz] */
HAPTO_API int32_t hapto_scene_tool_name(const hapto_scene *scene, uint32_t tool, const char **name);
/* Number of the tool with a name. HAPTO_INVALID_PARAMETER, which lists the names, for an unknown one. */
HAPTO_API int32_t hapto_scene_find_tool(const hapto_scene *scene, const char *name, uint32_t *tool);

/* One tick of all tools, as hapto_scene_step(): poses[k], twists[k] (or NULL) give soil_wrenches[k] (or NULL).
 * count  of poses: the number of tools, else HAPTO_WRONG_TOOL.
 * Nothing moves when a pose is not valid. [1 kHz] */
HAPTO_API int32_t hapto_scene_step_tools(hapto_scene *scene, const hapto_pose *poses, const hapto_twist *twists,
                                         uint32_t count, hapto_wrench *soil_wrenches);
/* `ticks` of it, as hapto_scene_steps(): poses[t * count + k]. [1 kHz] in cost a tick. */
HAPTO_API int32_t hapto_scene_steps_tools(hapto_scene *scene, uint64_t ticks, const hapto_pose *poses,
                                          const hapto_twist *twists, uint32_t count, hapto_wrench *soil_wrenches,
                                          uint64_t *done);
/* As hapto_scene_place_tool(), hapto_scene_set_opening(), hapto_scene_set_tool_fade(). [1 kHz] */
HAPTO_API int32_t hapto_scene_tool_place(hapto_scene *scene, uint32_t tool, const hapto_pose *scene_T_tool);
HAPTO_API int32_t hapto_scene_tool_set_opening(hapto_scene *scene, uint32_t tool, double share);
HAPTO_API int32_t hapto_scene_tool_set_fade(hapto_scene *scene, uint32_t tool, double share);
/* Sets the speed in rad/s or the torque in N m of a joint's drive from the next tick on, in the valid range of its key.
 * HAPTO_INVALID_PARAMETER also for a tool with neither. [1 kHz] */
HAPTO_API int32_t hapto_scene_tool_set_drive(hapto_scene *scene, uint32_t tool, double value);

enum { HAPTO_DRIVE_NONE = 0, HAPTO_DRIVE_SPEED = 1, HAPTO_DRIVE_TORQUE = 2, HAPTO_DRIVE_FREE = 3 };
/* A tool after the last tick. Means over that tick: soil_wrench, grip_force_n and the torques, which act on the tool about
 * the joint's axis. force_low_n to force_high_n: range, with a probability of 90 %, of the mean soil force over the last 0.25 s
 * in another specimen with particles half as large; NaN in the first 0.25 s, with ICRA 2021 friction and with particles of several
 * sizes. */
typedef struct hapto_tool_state {
  uint32_t size;
  int32_t in_soil;            /* 0: it has not been placed or stepped yet */
  int32_t drive;              /* of its joint: HAPTO_DRIVE_... */
  uint32_t reserved;
  hapto_pose scene_T_tool;    /* as given; of the hub that the hand holds, if it has a joint */
  hapto_pose scene_T_turned;  /* as its joint has turned it: where its shape is */
  hapto_wrench soil_wrench;   /* soil on tool, about the origin of scene_T_tool, scene frame, unfiltered */
  double angle_rad;           /* of the joint, -pi to pi */
  double speed_rad_s;
  double soil_torque_nm;
  double motor_torque_nm;
  double opening_m;           /* between jaws */
  double grip_force_n;        /* of the soil that opened them */
  double fade;
  double stiffness_n_m[9];    /* as hapto_scene_get_contact_stiffness() */
  double force_low_n;         /* band of the mean soil force over the last 0.25 s */
  double force_high_n;
} hapto_tool_state;
HAPTO_API int32_t hapto_scene_tool_get_state(const hapto_scene *scene, uint32_t tool, hapto_tool_state *out); /* [1 kHz] */

enum {
  HAPTO_POSITION = 1,     /* centres, m, 3 of HAPTO_FLOAT32; view and copy */
  HAPTO_VELOCITY = 2,     /* m/s, 3 of HAPTO_FLOAT32; view and copy */
  HAPTO_RADIUS = 3,       /* m, HAPTO_FLOAT32; copy */
  HAPTO_ASLEEP = 4,       /* 1: not worked on, since nothing near it moves; HAPTO_UINT8; copy */
  HAPTO_HELD = 5,         /* 1: fixed, outside the sides of a settled box; HAPTO_UINT8; copy */
  HAPTO_CONTACT_LOAD = 6, /* N, load by its neighbours: shows force chains; HAPTO_FLOAT32; copy */
  HAPTO_FIELDS = 6
};
/* Particles where they are, without copy. The numbers change, and the address too, with every step: fetch the view again
 * after each. The memory itself stays readable until the scene is destroyed. [1 kHz] */
HAPTO_API int32_t hapto_scene_view(const hapto_scene *scene, int32_t field, hapto_array *out);
/* A copy, packed: `bytes` must be what the field needs, particles * components * 4 or 1. */
HAPTO_API int32_t hapto_scene_copy(const hapto_scene *scene, int32_t field, void *out, uint64_t bytes);

/* The complete scene as bytes, its parameters included. Scenes with equal bytes continue with equal bits. `needed` as in
 * hapto_scene_get_toml(). The bytes are for this version of the library and one arithmetic, on any machine. */
HAPTO_API int32_t hapto_scene_get_state(const hapto_scene *scene, void *bytes, uint64_t capacity, uint64_t *needed);
/* Continues from there; the scene must have been made with the same parameters. It is unchanged when this fails. */
HAPTO_API int32_t hapto_scene_set_state(hapto_scene *scene, const void *bytes, uint64_t count);
/* A new scene that continues from there, without settling again. */
HAPTO_API int32_t hapto_scene_from_state(const void *bytes, uint64_t count, hapto_scene **out);
/* 64-bit hash of the particles and what their contacts remember, as `haptolith run --json` prints it. */
HAPTO_API int32_t hapto_scene_state_hash(const hapto_scene *scene, uint64_t *out);

/* --- batches: many scenes on several threads ------------------------------------------------------------------------ */

/* Threads that step scenes, which stay the caller's and must not be destroyed before the batch.
 * threads  0: as many as the machine has. */
HAPTO_API int32_t hapto_batch_create(hapto_scene *const *scenes, uint32_t count, uint32_t threads, hapto_batch **out);
/* `ticks` of each scene: that number i moves along poses[i * ticks + t], which gives soil_wrenches[i * ticks + t]. Bit-identical to
 * stepping one by one. status[i] is the status of scene i; each pointer but poses may be NULL. The first status that is not HAPTO_OK is
 * returned. */
HAPTO_API int32_t hapto_batch_step(hapto_batch *batch, uint64_t ticks, const hapto_pose *poses, const hapto_twist *twists,
                                   hapto_wrench *soil_wrenches, int32_t *status);
/* As above with the poses of all tools: for each scene, for each tick, for each tool one, in this order.
 * count  of poses, else HAPTO_WRONG_TOOL. */
HAPTO_API int32_t hapto_batch_step_tools(hapto_batch *batch, uint64_t ticks, const hapto_pose *poses,
                                         const hapto_twist *twists, uint64_t count, hapto_wrench *soil_wrenches,
                                         int32_t *status);
HAPTO_API int32_t hapto_batch_destroy(hapto_batch *batch);

/* --- soils ---------------------------------------------------------------------------------------------------------- */

/* A soil with a name (hapto_list("soils")), a preset of icra2021 ("P1" to "P6"), or a soil file. */
HAPTO_API int32_t hapto_soil_find(const char *name_or_path, hapto_soil **out);
HAPTO_API int32_t hapto_soil_from_toml(const char *text, const char *name, hapto_soil **out);
HAPTO_API int32_t hapto_soil_destroy(hapto_soil *soil);
/* A number of its file (docs/reference/soils.md): "target.friction_angle_deg", "soil.radius_mm", "reached.cohesion_pa".
 * HAPTO_INVALID_PARAMETER for a key that the soil has not. */
HAPTO_API int32_t hapto_soil_get(const hapto_soil *soil, const char *key, double *out);
/* As a soil file; as hapto_scene_get_toml(). HAPTO_INVALID_PARAMETER for a preset, of which nothing was measured. */
HAPTO_API int32_t hapto_soil_get_toml(const hapto_soil *soil, char *text, uint64_t capacity, uint64_t *needed);
/* Its layers under its own weight down to a depth (paper, Fig. 1): columns depth_m, top_m, bottom_m, spacing_m,
 * density_kg_m3. */
HAPTO_API int32_t hapto_soil_profile(const hapto_soil *soil, double gravity_m_s2, double depth_m, hapto_result **out);

/* Finds contact parameters with which a sheared bed matches measured values (docs/how-to/test-a-soil.md); takes minutes.
 * target  "friction_angle_deg = 42\ncohesion_pa = 520\nbulk_density_kg_m3 = 1500" in TOML, and if need be strength ("residual" or
 *         "peak"), density ("lunar", more of it deeper, or "constant"), radius_mm, stiffness_n_m, body or gravity_m_s2, seed,
 *         threads, specimens, name, source.
 * report  what the laboratory measured of it in the end, mean and standard deviation over specimens; may be NULL. */
HAPTO_API int32_t hapto_soil_calibrate(const char *target, hapto_progress progress, void *user, hapto_soil **out,
                                       hapto_result **report);

/* --- the laboratory --------------------------------------------------------------------------------------------------- */

/* A test of the soil laboratory, as `haptolith lab TEST` makes it (hapto_list("lab tests"); docs/how-to/test-a-soil.md).
 * options  keys in TOML, as the command's options with _ for -: "normal_pa = [300, 1000, 3000]\nseed = 2\nbody = 'Earth'"; NULL or
 *          "": the usual ones.
 * out      the numbers that `--json` prints, "findings" with their target values, and the trace as columns.
 * Errors: HAPTO_INVALID_PARAMETER with key, value and valid range; HAPTO_FAILURE; HAPTO_STOPPED. */
HAPTO_API int32_t hapto_lab_test(const char *test, const hapto_soil *soil, const char *options, hapto_progress progress,
                                 void *user, hapto_result **out);

/* Returns how far the force of a scene's movement can be believed, as `haptolith trust` prints it (docs/reports/trust.md): the soil
 * is simulated again with other specimens, a larger box, finer particles, shorter steps and so on. Takes minutes. The scene is
 * neither stepped nor changed; virtual hands make the movements that its file names.
 * options  TOML: tool, the name of the one whose force is judged; duration_s of the movement, 0.25 to 3600; specimens, 2 to 100;
 *          minutes, 0.1 to 10000; threads; NULL or "": the first, one motion of its hand, 5, 30, all.
 * out      the numbers that `--json` prints: "sentence", "mean_within" and "peak_within" (relative, 90 %), "complaints", "effects".
 * Errors: HAPTO_INVALID_PARAMETER with key, value and valid range; HAPTO_FAILURE; HAPTO_STOPPED. Not for the tick. */
HAPTO_API int32_t hapto_scene_trust(const hapto_scene *scene, const char *options, hapto_progress progress, void *user,
                                    hapto_result **out);

/* --- psychometric functions ----------------------------------------------------------------------------------------------- */

/* Fits a psychometric function to answers, as `haptolith study fit` does (docs/reference/psychometrics.md).
 * levels   `count` rows of three numbers: stimulus, positive answers, answers.
 * options  TOML: design, alternatives, sigmoid, log_x, falling, reference, free_threshold, lapse, guess, overdispersion (a number
 *          or "free"), method, confidence, simulations, pool_tolerance; NULL or "": sigmoid "weber", design "equal-asymptote".
 * The result has what the command prints with --json, and the function with its band as columns x, psi, psi_low, psi_high.
 * Errors: HAPTO_INVALID_PARAMETER for options and answers that make no sense. */
HAPTO_API int32_t hapto_psychometric_fit(const double *levels, uint64_t count, const char *options, hapto_result **out);

/* --- the loop: a device or a hand at 1 kHz ---------------------------------------------------------------------------- */

/* Limits that a device declares. hapto_device_limits_init() sets those of an ideal device; INFINITY: no limit. */
typedef struct hapto_device_limits {
  uint32_t size;
  int32_t turns;       /* whether the handle's turn is known */
  int32_t shows_force; /* as a force, not as a rumble */
  int32_t grips;       /* whether it has a gripper */
  int32_t delay_known; /* else the delay is anything up to delay_s */
  int32_t simulated;   /* no person's hand is at it: no soft start, and time may run at any speed */
  double max_force_n, max_torque_nm, max_gripper_force_n;
  double max_force_rate_n_s, max_torque_rate_nm_s, max_gripper_rate_n_s; /* except to zero */
  double max_stiffness_n_m, max_stiffness_nm_rad;                        /* that it shows without shaking */
  double damping_n_s_m;                                                  /* its own, in a hand that holds it loosely */
  double turn_rad[3]; /* turns its frame into that of a person before it: x right, y away, z up */
  double workspace_centre_m[3], workspace_radius_m; /* device frame */
  double rate_hz;      /* update rate of readings and forces */
  double delay_s;      /* from sending a force to a reading that shows its effect, beyond a tick */
  double resolution_m; /* positions come in steps, or with noise, of at most this; 0: exact */
} hapto_device_limits;
HAPTO_API int32_t hapto_device_limits_init(hapto_device_limits *out);

enum { HAPTO_DEVICE_LIVE = 0, HAPTO_DEVICE_STALE = 1, HAPTO_DEVICE_LOST = 2, HAPTO_DEVICE_FINISHED = 3 };
typedef struct hapto_device_input { /* the handle, device frame */
  uint32_t size;
  int32_t state;
  hapto_pose pose;
  hapto_twist twist;
  double gripper_open; /* 0 closed to 1 wide open */
  uint32_t buttons;    /* bit n: button n is down */
  uint32_t reserved;
} hapto_device_input;
typedef struct hapto_device_output { /* device wrench: device frame, about the handle's origin */
  uint32_t size;
  uint32_t reserved;
  hapto_wrench wrench;
  double gripper_force_n; /* > 0 opens the fingers */
} hapto_device_output;

/* A device of the caller's. read and write are called once a tick, in that order, from the loop's thread: they must not
 * wait, lock, allocate or throw. release_force and resume_force may be NULL. release_force means zero force at once and from
 * now on, and may come from any thread; resume_force ends it. */
typedef struct hapto_device {
  uint32_t size;
  uint32_t reserved;
  void *user;
  const char *name; /* copied */
  hapto_device_limits limits;
  void (*read)(void *user, hapto_device_input *out); /* `out` is as the call before left it, state live */
  void (*write)(void *user, const hapto_device_output *force);
  HAPTO_RENAMED(void (*release_force)(void *user), void (*let_go)(void *user));
  HAPTO_RENAMED(void (*resume_force)(void *user), void (*take_up)(void *user));
} hapto_device;

/* A loop that joins a scene and a device: mapping, coupling, filter and the safety layer as the scene's tables [mapping],
 * [coupling], [loop], [safety] say. The scene belongs to it until hapto_loop_destroy(): other calls give HAPTO_BUSY.
 * The device moves the first tool; others do not touch the soil until then (hapto_loop_create_tools() moves all).
 * device  the caller's; its zero is [mapping] offset_mm above the soil's surface, 85 mm unless the scene says otherwise.
 *         NULL: the device that the scene's [device] names, a virtual hand by default.
 * flags   HAPTO_LOOP_...; 0: hapto_loop_start() gives it a thread. */
HAPTO_API int32_t hapto_loop_create(hapto_scene *scene, const hapto_device *device, uint32_t flags, hapto_loop **out);
/* As above for all tools of a scene: devices[k] moves tool k; where it is NULL, the device that the tool's [tools.device]
 * names, a virtual hand by default. Each hand has its own mapping, coupling, safety layer and watchdog; the loop ends when
 * the last person's device is lost. Each tick gives `count` ticks, one for each tool.
 * count  number of the scene's tools; HAPTO_WRONG_TOOL for another. At most 4 devices are not virtual hands. */
HAPTO_API int32_t hapto_loop_create_tools(hapto_scene *scene, const hapto_device *const *devices, uint32_t count,
                                          uint32_t flags, hapto_loop **out);
enum {
  HAPTO_LOOP_TICKED_BY_CALLER = 1, /* hapto_loop_tick() is called once every tick_s */
  HAPTO_LOOP_KEEPS_TICKS = 2,      /* for hapto_loop_take_ticks() */
  HAPTO_LOOP_HASHES = 4            /* ticks hold hashes of the soil, of a part of it each */
};
/* Runs it on a separate thread, in step with the clock, with real-time priority and the process's memory locked where the
 * system grants that; as fast as it can when the scene says loop.real_time=false, which needs a simulated hand. A watchdog sets the
 * force on a person's hand to zero when 4 ms pass without a tick (safety.watchdog_timeout_ms). */
HAPTO_API int32_t hapto_loop_start(hapto_loop *loop);
/* One tick. late: whether the one before ended late (1). There is no watchdog: the caller has to set the
 * device's force to zero when it cannot tick. HAPTO_ENDED when it was the last. [1 kHz] */
HAPTO_API int32_t hapto_loop_tick(hapto_loop *loop, int32_t late);
/* Ends a started loop: the force on a person's hand fades, and the thread has ended on return. */
HAPTO_API int32_t hapto_loop_stop(hapto_loop *loop);
/* Stops it, if need be, and gives the scene back, with all changes that were asked for and a tool that is wholly there. */
HAPTO_API int32_t hapto_loop_destroy(hapto_loop *loop);

typedef struct hapto_snapshot {
  uint32_t size;
  int32_t running;    /* 0: not started, or ended */
  const char *end;    /* why it ended, in words; "" while it runs */
  const char *trip;   /* safety trip: why the force is zero; "" when it is not */
  uint32_t trips;     /* so far */
  int32_t paused;
  uint64_t ticks, deadline_misses, awake;
  double time_s;
  hapto_pose scene_T_tool;
  double opening_m;
  hapto_wrench felt; /* deprecated: device_wrench turned into the scene's axes; read device_wrench, or soil_wrench */
  double success_rate;                        /* share of the last 100 ticks that ended in time */
  double tick_us_p50, tick_us_p99, tick_us_max;
  double largest_speed_m_s;
  hapto_array position; /* as HAPTO_POSITION; of a large bed a part is copied in each tick */
  uint64_t misses_too_long;   /* of deadline_misses: the tick's own work took too long */
  uint64_t misses_woken_late; /* the machine woke the loop's thread late */
  uint64_t misses_preempted;  /* the processor was taken away during the tick */
  hapto_wrench soil_wrench;   /* of the last tick: of the soil on the tool, about its origin, scene frame, unfiltered */
  hapto_wrench device_wrench; /* of the last tick: sent to the device, about the handle's origin, device frame */
} hapto_snapshot;
/* The newest snapshot, about 60 per second; may be called while the loop runs, from one thread. Valid until the next call.
 * Before the first snapshot there are no positions. While time is paused the wrenches are those of the last tick, and the
 * device is sent zero. */
HAPTO_API int32_t hapto_loop_snapshot(hapto_loop *loop, hapto_snapshot *out);
/* A tool in the snapshot that hapto_loop_snapshot() gave last, without fade, grip_force_n and stiffness_n_m (0). From the
 * same thread. */
HAPTO_API int32_t hapto_loop_get_tool(hapto_loop *loop, uint32_t tool, hapto_tool_state *out);

/* Safety trips: why the safety layer sets the force to zero (docs/explanation/safety.md). */
enum {
  HAPTO_TRIP_NONE = 0,              /* no trip */
  HAPTO_TRIP_DEVICE_NOT_FINITE = 1, /* the device's pose or velocity is NaN or infinite */
  HAPTO_TRIP_STALE = 2,             /* no new reading from the device */
  HAPTO_TRIP_LOST = 3,              /* the device is gone */
  HAPTO_TRIP_WORKSPACE = 4,         /* the hand left the device's workspace, or the tool the space around the bed */
  HAPTO_TRIP_MISSED_DEADLINES = 5,  /* too many in a row */
  HAPTO_TRIP_HEARTBEAT = 6,         /* the loop did not answer the watchdog */
  HAPTO_TRIP_FORCE_NOT_FINITE = 7,  /* the force for the hand is NaN or infinite */
  HAPTO_TRIP_IMPLAUSIBLE = 8        /* no hand moves as the device reports */
};
/* Bits of hapto_tick.flags; those that HAPTO_SAFETY_... has as well are the safety layer's. */
enum {
  HAPTO_TICK_LATE = 1,             /* did not end in time */
  HAPTO_TICK_ZEROED = 2,           /* zero force, for the reason in `trip` */
  HAPTO_TICK_SATURATED = 4,        /* force was shortened to what the device can show */
  HAPTO_TICK_RATE_LIMITED = 8,     /* force changed no faster than the device may */
  HAPTO_TICK_SOFT_START = 16,      /* force was still rising after a start or a trip */
  HAPTO_TICK_DAMPED = 32,          /* energy in excess was damped */
  HAPTO_TICK_RESUMED = 64,         /* time was paused before it */
  HAPTO_TICK_HEARTBEAT_LOST = 128, /* the watchdog had set the force to zero before it */
  HAPTO_TICK_SCENE_CHANGED = 256,  /* soil, gravity, tool or bed were changed before it, or the tool fades for that */
  HAPTO_TICK_SOFT_STOP = 512,      /* the run was about to end */
  HAPTO_TICK_FAILED = 1024,        /* the run ended with it: device gone, hand away, or a bed that makes no sense */
  HAPTO_TICK_SOIL_ADJUSTED = 2048, /* soil and tool friction were changed a little: a model that learns */
  HAPTO_TICK_PARTICLE_MOVED = 4096, /* a particle was moved: a model's surface that is corrected */
  HAPTO_TICK_GRAIN_MOVED = 4096    /* deprecated: HAPTO_TICK_PARTICLE_MOVED */
};

/* One tick, as recordings hold it (docs/reference/recording-file.md). */
typedef struct hapto_tick {
  uint32_t size;
  uint32_t flags;              /* HAPTO_TICK_... */
  uint32_t trip;               /* HAPTO_TRIP_... */
  uint32_t buttons;
  int32_t device_state;
  uint32_t tool;               /* its number; 0: the first */
  double time_s;
  hapto_pose device_pose;      /* handle, as the device reported it, device frame */
  hapto_twist device_twist;    /* handle, device frame */
  double gripper_open;
  hapto_pose scene_T_tool;
  HAPTO_RENAMED(hapto_wrench soil_wrench, hapto_wrench soil); /* soil on tool, about its origin, scene frame, unfiltered */
  hapto_wrench rendered;       /* output before the safety layer, about the handle's origin, device frame */
  double rendered_gripper_n;   /* > 0 opens the fingers */
  HAPTO_RENAMED(hapto_wrench device_wrench, hapto_wrench felt); /* sent to the device, about the handle's origin, device frame */
  HAPTO_RENAMED(double device_gripper_n, double felt_gripper_n); /* sent to the gripper; > 0 opens the fingers */
  double injected_j;           /* energy that the hand was given beyond what it gave */
  double quick_injected_j;     /* the same by the quick account (docs/explanation/safety.md) */
  double tick_us, late_us;     /* work of this tick, and how late it began */
  uint64_t state_hash;         /* of a part of the soil; 0 without HAPTO_LOOP_HASHES */
} hapto_tick;
/* Takes up to `capacity` of the waiting ticks, the oldest first; `count` is their number, `lost` (or NULL) the number lost so far
 * because they were not taken in time: take them every second or more often. From the thread that takes snapshots. */
HAPTO_API int32_t hapto_loop_take_ticks(hapto_loop *loop, hapto_tick *out, uint64_t capacity, uint64_t *count,
                                        uint64_t *lost);

/* Description of this loop for a recording, as a JSON object: "scenario" (the scene as TOML), "title", "instruction_set",
 * "arithmetic", "device", "device_limits" (JSON), "seed", "threads", "hashed_parts", "start_tick" (0: soil and tool were as the
 * scene says when the loop was made), "tick_s", "paced". With the bytes needed, as hapto_scene_get_toml(). */
HAPTO_API int32_t hapto_loop_get_header(const hapto_loop *loop, char *json, uint64_t capacity, uint64_t *needed);

/* Pauses time and sets the force to zero (1), or resumes (0), between two ticks. From the thread that takes snapshots. */
HAPTO_API int32_t hapto_loop_pause(hapto_loop *loop, int32_t on);
/* As hapto_scene_change() while it runs: no hand feels a jump. From the thread that takes snapshots. */
HAPTO_API int32_t hapto_loop_change(hapto_loop *loop, const char *const *overrides, uint32_t count);

/* --- the safety layer alone, for hosts with their own loop and device --------------------------------------------------- */

/* Protection between a simulated force and a person's hand (docs/explanation/safety.md): plausibility of the input, soft start, the
 * device's limits and rates, passivity.
 * overrides      keys of [safety], "safety.soft_start_s=1".
 * tick_s         of the caller's loop, 0.0001 to 0.1.
 * stiffness_n_m  of the softest spring that stores what the hand presses with: the tool's contact, the soil's, or a virtual
 *                coupling's. */
HAPTO_API int32_t hapto_safety_create(const hapto_device_limits *limits, const char *const *overrides, uint32_t count,
                                      double tick_s, double stiffness_n_m, hapto_safety **out);
/* Each tick: the device's reading, whether the tick before ended late (1), and the requested output, which is replaced
 * by the permitted one: both device frame. [1 kHz] */
HAPTO_API int32_t hapto_safety_step(hapto_safety *safety, const hapto_device_input *input, int32_t late,
                                    hapto_device_output *inout);
typedef struct hapto_safety_info {
  uint32_t size;
  uint32_t trips;     /* so far */
  uint32_t flags;     /* of the last step: HAPTO_SAFETY_... */
  uint32_t reserved;
  const char *trip;   /* safety trip: why the force is zero; "" when it is not */
  double injected_j;  /* energy that the hand was given beyond what it gave */
} hapto_safety_info;
enum { /* explained at HAPTO_TICK_... */
  HAPTO_SAFETY_LATE = 1,
  HAPTO_SAFETY_ZEROED = 2,
  HAPTO_SAFETY_SATURATED = 4,
  HAPTO_SAFETY_RATE_LIMITED = 8,
  HAPTO_SAFETY_SOFT_START = 16,
  HAPTO_SAFETY_DAMPED = 32,
  HAPTO_SAFETY_SOFT_STOP = 512
};
HAPTO_API int32_t hapto_safety_get_info(const hapto_safety *safety, hapto_safety_info *out); /* [1 kHz] */
/* Force goes to nothing softly and stays there (1): the run is about to end. [1 kHz] */
HAPTO_API int32_t hapto_safety_stop(hapto_safety *safety);
HAPTO_API int32_t hapto_safety_destroy(hapto_safety *safety);

#ifdef __cplusplus
}
#endif

#endif
