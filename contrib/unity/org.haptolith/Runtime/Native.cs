// Made by contrib/unity/make_native.py from include/haptolith/haptolith.h: do not edit. It names everything as C does, and explains it in
// C's words. Handles and functions are IntPtr; structs are plain memory and go to the library as they are.
#pragma warning disable IDE1006, CS0649
using System;
using System.Runtime.InteropServices;

namespace Haptolith
{
  /// <summary>
  /// The last error of a function that this thread has called. Texts are never NULL, may be empty, and are valid until
  /// the thread's next failure.
  /// </summary>
  [StructLayout(LayoutKind.Sequential)]
  public unsafe struct hapto_error
  {
    public uint size;
    public int status;
    public byte* message;  // a sentence
    public byte* key;  // "bed.threads"
    public byte* value;  // as it was given
    public byte* valid;  // "a whole number, 1 to 256"
  }

  [StructLayout(LayoutKind.Sequential)]
  public unsafe struct hapto_pose
  {
    public fixed double position_m[3];
    public fixed double orientation[4];  // w x y z, of norm 1 +- 1 %
  }

  /// <summary>velocity of the moving body's origin, in the frame of its pose</summary>
  [StructLayout(LayoutKind.Sequential)]
  public unsafe struct hapto_twist
  {
    public fixed double linear_m_s[3];
    public fixed double angular_rad_s[3];
  }

  /// <summary>every use states the body, the point and the frame</summary>
  [StructLayout(LayoutKind.Sequential)]
  public unsafe struct hapto_wrench
  {
    public fixed double force_n[3];
    public fixed double torque_nm[3];
  }

  /// <summary>Elements in memory that belongs to the library.</summary>
  [StructLayout(LayoutKind.Sequential)]
  public unsafe struct hapto_array
  {
    public uint size;
    public int type;  // HAPTO_FLOAT32, HAPTO_FLOAT64 or HAPTO_UINT8
    public ulong count;  // of elements
    public uint components;  // of each: 3 of a position
    public uint stride_bytes;  // from one element to the next
    public void* data;
  }

  /// <summary>
  /// Receives the current work and its progress, 0 to 1, or -1 where that is not known; return 0 to give up.
  /// `what` is valid during the call. May come from another thread than the caller's, one at a time.
  /// </summary>
  [UnmanagedFunctionPointer(CallingConvention.Cdecl)]
  public unsafe delegate int hapto_progress(void* user, byte* what, double share);

  [StructLayout(LayoutKind.Sequential)]
  public unsafe struct hapto_scene_info
  {
    public uint size;
    public uint substeps;  // per tick
    public uint threads;  // that share one, at most
    public uint friction;  // friction model, 0: icra2021, 1: contact
    public ulong particles;  // the indices of all arrays
    public ulong held;  // of these, that stand for ever where a box of settled soil ends
    public ulong awake;  // that were worked on in the last tick, in whole groups of 16
    public ulong steps;  // substeps since the soil was made
    public double tick_s;  // what a step advances time by
    public double radius_m;  // of a particle
    public double mass_kg;  // of one of that radius
    public double width_m;  // of the box, along x and y
    public double length_m;
    public double surface_m;  // height of the topmost particle's top above the floor
    public double opening_m;  // between the jaws of the first tool
    public double tool_fade;  // 1: the first tool touches the soil with all its stiffness
    public double energy_j;  // kinetic, gravitational and of contacts; gravity's zero is the origin
    public fixed double gravity_m_s2[3];
  }

  /// <summary>
  /// A tool after the last tick. Means over that tick: soil_wrench, grip_force_n and the torques, which act on the tool about
  /// the joint's axis. force_low_n to force_high_n: range, with a probability of 90 %, of the mean soil force over the last 0.25 s
  /// in another specimen with particles half as large; NaN in the first 0.25 s, with ICRA 2021 friction and with particles of several
  /// sizes.
  /// </summary>
  [StructLayout(LayoutKind.Sequential)]
  public unsafe struct hapto_tool_state
  {
    public uint size;
    public int in_soil;  // 0: it has not been placed or stepped yet
    public int drive;  // of its joint: HAPTO_DRIVE_...
    public uint reserved;
    public hapto_pose scene_T_tool;  // as given; of the hub that the hand holds, if it has a joint
    public hapto_pose scene_T_turned;  // as its joint has turned it: where its shape is
    public hapto_wrench soil_wrench;  // soil on tool, about the origin of scene_T_tool, scene frame, unfiltered
    public double angle_rad;  // of the joint, -pi to pi
    public double speed_rad_s;
    public double soil_torque_nm;
    public double motor_torque_nm;
    public double opening_m;  // between jaws
    public double grip_force_n;  // of the soil that opened them
    public double fade;
    public fixed double stiffness_n_m[9];  // as hapto_scene_get_contact_stiffness()
    public double force_low_n;  // band of the mean soil force over the last 0.25 s
    public double force_high_n;
  }

  /// <summary>Limits that a device declares. hapto_device_limits_init() sets those of an ideal device; INFINITY: no limit.</summary>
  [StructLayout(LayoutKind.Sequential)]
  public unsafe struct hapto_device_limits
  {
    public uint size;
    public int turns;  // whether the handle's turn is known
    public int shows_force;  // as a force, not as a rumble
    public int grips;  // whether it has a gripper
    public int delay_known;  // else the delay is anything up to delay_s
    public int simulated;  // no person's hand is at it: no soft start, and time may run at any speed
    public double max_force_n;
    public double max_torque_nm;
    public double max_gripper_force_n;
    public double max_force_rate_n_s;  // except to zero
    public double max_torque_rate_nm_s;
    public double max_gripper_rate_n_s;
    public double max_stiffness_n_m;  // that it shows without shaking
    public double max_stiffness_nm_rad;
    public double damping_n_s_m;  // its own, in a hand that holds it loosely
    public fixed double turn_rad[3];  // turns its frame into that of a person before it: x right, y away, z up
    public fixed double workspace_centre_m[3];  // device frame
    public double workspace_radius_m;
    public double rate_hz;  // update rate of readings and forces
    public double delay_s;  // from sending a force to a reading that shows its effect, beyond a tick
    public double resolution_m;  // positions come in steps, or with noise, of at most this; 0: exact
  }

  /// <summary>the handle, device frame</summary>
  [StructLayout(LayoutKind.Sequential)]
  public unsafe struct hapto_device_input
  {
    public uint size;
    public int state;
    public hapto_pose pose;
    public hapto_twist twist;
    public double gripper_open;  // 0 closed to 1 wide open
    public uint buttons;  // bit n: button n is down
    public uint reserved;
  }

  /// <summary>device wrench: device frame, about the handle's origin</summary>
  [StructLayout(LayoutKind.Sequential)]
  public unsafe struct hapto_device_output
  {
    public uint size;
    public uint reserved;
    public hapto_wrench wrench;
    public double gripper_force_n;  // > 0 opens the fingers
  }

  [UnmanagedFunctionPointer(CallingConvention.Cdecl)]
  public unsafe delegate void hapto_device_read(void* user, hapto_device_input* @out);

  [UnmanagedFunctionPointer(CallingConvention.Cdecl)]
  public unsafe delegate void hapto_device_write(void* user, hapto_device_output* force);

  [UnmanagedFunctionPointer(CallingConvention.Cdecl)]
  public unsafe delegate void hapto_device_release_force(void* user);

  [UnmanagedFunctionPointer(CallingConvention.Cdecl)]
  public unsafe delegate void hapto_device_resume_force(void* user);

  /// <summary>
  /// A device of the caller's. read and write are called once a tick, in that order, from the loop's thread: they must not
  /// wait, lock, allocate or throw. release_force and resume_force may be NULL. release_force means zero force at once and from
  /// now on, and may come from any thread; resume_force ends it.
  /// </summary>
  [StructLayout(LayoutKind.Sequential)]
  public unsafe struct hapto_device
  {
    public uint size;
    public uint reserved;
    public void* user;
    public byte* name;  // copied
    public hapto_device_limits limits;
    public IntPtr read;  // hapto_device_read; `out` is as the call before left it, state live
    public IntPtr write;  // hapto_device_write
    public IntPtr release_force;  // hapto_device_release_force
    public IntPtr resume_force;  // hapto_device_resume_force
  }

  [StructLayout(LayoutKind.Sequential)]
  public unsafe struct hapto_snapshot
  {
    public uint size;
    public int running;  // 0: not started, or ended
    public byte* end;  // why it ended, in words; "" while it runs
    public byte* trip;  // safety trip: why the force is zero; "" when it is not
    public uint trips;  // so far
    public int paused;
    public ulong ticks;
    public ulong deadline_misses;
    public ulong awake;
    public double time_s;
    public hapto_pose scene_T_tool;
    public double opening_m;
    public hapto_wrench felt;  // deprecated: device_wrench turned into the scene's axes; read device_wrench, or soil_wrench
    public double success_rate;  // share of the last 100 ticks that ended in time
    public double tick_us_p50;
    public double tick_us_p99;
    public double tick_us_max;
    public double largest_speed_m_s;
    public hapto_array position;  // as HAPTO_POSITION; of a large bed a part is copied in each tick
    public ulong misses_too_long;  // of deadline_misses: the tick's own work took too long
    public ulong misses_woken_late;  // the machine woke the loop's thread late
    public ulong misses_preempted;  // the processor was taken away during the tick
    public hapto_wrench soil_wrench;  // of the last tick: of the soil on the tool, about its origin, scene frame, unfiltered
    public hapto_wrench device_wrench;  // of the last tick: sent to the device, about the handle's origin, device frame
  }

  /// <summary>One tick, as recordings hold it (docs/reference/recording-file.md).</summary>
  [StructLayout(LayoutKind.Sequential)]
  public unsafe struct hapto_tick
  {
    public uint size;
    public uint flags;  // HAPTO_TICK_...
    public uint trip;  // HAPTO_TRIP_...
    public uint buttons;
    public int device_state;
    public uint tool;  // its number; 0: the first
    public double time_s;
    public hapto_pose device_pose;  // handle, as the device reported it, device frame
    public hapto_twist device_twist;  // handle, device frame
    public double gripper_open;
    public hapto_pose scene_T_tool;
    public hapto_wrench soil_wrench;  // soil on tool, about its origin, scene frame, unfiltered
    public hapto_wrench rendered;  // output before the safety layer, about the handle's origin, device frame
    public double rendered_gripper_n;  // > 0 opens the fingers
    public hapto_wrench device_wrench;  // sent to the device, about the handle's origin, device frame
    public double device_gripper_n;  // sent to the gripper; > 0 opens the fingers
    public double injected_j;  // energy that the hand was given beyond what it gave
    public double quick_injected_j;  // the same by the quick account (docs/explanation/safety.md)
    public double tick_us;  // work of this tick, and how late it began
    public double late_us;
    public ulong state_hash;  // of a part of the soil; 0 without HAPTO_LOOP_HASHES
  }

  [StructLayout(LayoutKind.Sequential)]
  public unsafe struct hapto_safety_info
  {
    public uint size;
    public uint trips;  // so far
    public uint flags;  // of the last step: HAPTO_SAFETY_...
    public uint reserved;
    public byte* trip;  // safety trip: why the force is zero; "" when it is not
    public double injected_j;  // energy that the hand was given beyond what it gave
  }

  /// <summary>The functions of libhaptolith, as they are in C.</summary>
  public static unsafe class Native
  {
    /// <summary>The system makes libhaptolith.so of it.</summary>
    public const string Library = "haptolith";

    /// <summary>1000 * major + minor of the header: a library of another minor version is laid out otherwise.</summary>
    public const uint HeaderVersion = 2;

    public const int HAPTO_OK = 0;
    public const int HAPTO_INVALID_PARAMETER = 1;  // a value is not valid: hapto_last_error() names key, value and what would be
    public const int HAPTO_FAILURE = 2;  // understood, and could not be done: no file, no device, no solution
    public const int HAPTO_STOPPED = 3;  // the progress function gave up
    public const int HAPTO_NOT_FINITE = 4;  // the bed is no longer numbers; only another state helps
    public const int HAPTO_COLLAPSED = 5;  // the bed has collapsed onto itself; only another state helps
    public const int HAPTO_BUSY = 6;  // another thread or a loop is using the handle
    public const int HAPTO_DESTROYED = 7;  // not a handle of this kind, or no longer
    public const int HAPTO_NULL = 8;  // a pointer that must not be NULL is
    public const int HAPTO_WRONG_SIZE = 9;  // a struct whose `size` is less than that of its first version
    public const int HAPTO_TOO_SMALL = 10;  // the buffer; nothing has been written but how much is needed
    public const int HAPTO_NO_MEMORY = 11;
    public const int HAPTO_ENDED = 12;  // the loop has ended: hapto_loop_snapshot() says why
    public const int HAPTO_WRONG_TOOL = 13;  // the scene has no tool of this number, or not as many tools as there are poses

    public const int HAPTO_FLOAT32 = 1;
    public const int HAPTO_FLOAT64 = 2;
    public const int HAPTO_UINT8 = 3;

    public const int HAPTO_DRIVE_NONE = 0;
    public const int HAPTO_DRIVE_SPEED = 1;
    public const int HAPTO_DRIVE_TORQUE = 2;
    public const int HAPTO_DRIVE_FREE = 3;

    public const int HAPTO_POSITION = 1;  // centres, m, 3 of HAPTO_FLOAT32; view and copy
    public const int HAPTO_VELOCITY = 2;  // m/s, 3 of HAPTO_FLOAT32; view and copy
    public const int HAPTO_RADIUS = 3;  // m, HAPTO_FLOAT32; copy
    public const int HAPTO_ASLEEP = 4;  // 1: not worked on, since nothing near it moves; HAPTO_UINT8; copy
    public const int HAPTO_HELD = 5;  // 1: fixed, outside the sides of a settled box; HAPTO_UINT8; copy
    public const int HAPTO_CONTACT_LOAD = 6;  // N, load by its neighbours: shows force chains; HAPTO_FLOAT32; copy
    public const int HAPTO_FIELDS = 6;

    public const int HAPTO_DEVICE_LIVE = 0;
    public const int HAPTO_DEVICE_STALE = 1;
    public const int HAPTO_DEVICE_LOST = 2;
    public const int HAPTO_DEVICE_FINISHED = 3;

    public const int HAPTO_LOOP_TICKED_BY_CALLER = 1;  // hapto_loop_tick() is called once every tick_s
    public const int HAPTO_LOOP_KEEPS_TICKS = 2;  // for hapto_loop_take_ticks()
    public const int HAPTO_LOOP_HASHES = 4;  // ticks hold hashes of the soil, of a part of it each

    public const int HAPTO_TRIP_NONE = 0;  // no trip
    public const int HAPTO_TRIP_DEVICE_NOT_FINITE = 1;  // the device's pose or velocity is NaN or infinite
    public const int HAPTO_TRIP_STALE = 2;  // no new reading from the device
    public const int HAPTO_TRIP_LOST = 3;  // the device is gone
    public const int HAPTO_TRIP_WORKSPACE = 4;  // the hand left the device's workspace, or the tool the space around the bed
    public const int HAPTO_TRIP_MISSED_DEADLINES = 5;  // too many in a row
    public const int HAPTO_TRIP_HEARTBEAT = 6;  // the loop did not answer the watchdog
    public const int HAPTO_TRIP_FORCE_NOT_FINITE = 7;  // the force for the hand is NaN or infinite
    public const int HAPTO_TRIP_IMPLAUSIBLE = 8;  // no hand moves as the device reports

    public const int HAPTO_TICK_LATE = 1;  // did not end in time
    public const int HAPTO_TICK_ZEROED = 2;  // zero force, for the reason in `trip`
    public const int HAPTO_TICK_SATURATED = 4;  // force was shortened to what the device can show
    public const int HAPTO_TICK_RATE_LIMITED = 8;  // force changed no faster than the device may
    public const int HAPTO_TICK_SOFT_START = 16;  // force was still rising after a start or a trip
    public const int HAPTO_TICK_DAMPED = 32;  // energy in excess was damped
    public const int HAPTO_TICK_RESUMED = 64;  // time was paused before it
    public const int HAPTO_TICK_HEARTBEAT_LOST = 128;  // the watchdog had set the force to zero before it
    public const int HAPTO_TICK_SCENE_CHANGED = 256;  // soil, gravity, tool or bed were changed before it, or the tool fades for that
    public const int HAPTO_TICK_SOFT_STOP = 512;  // the run was about to end
    public const int HAPTO_TICK_FAILED = 1024;  // the run ended with it: device gone, hand away, or a bed that makes no sense
    public const int HAPTO_TICK_SOIL_ADJUSTED = 2048;  // soil and tool friction were changed a little: a model that learns
    public const int HAPTO_TICK_PARTICLE_MOVED = 4096;  // a particle was moved: a model's surface that is corrected
    public const int HAPTO_TICK_GRAIN_MOVED = 4096;  // deprecated: HAPTO_TICK_PARTICLE_MOVED

    public const int HAPTO_SAFETY_LATE = 1;
    public const int HAPTO_SAFETY_ZEROED = 2;
    public const int HAPTO_SAFETY_SATURATED = 4;
    public const int HAPTO_SAFETY_RATE_LIMITED = 8;
    public const int HAPTO_SAFETY_SOFT_START = 16;
    public const int HAPTO_SAFETY_DAMPED = 32;
    public const int HAPTO_SAFETY_SOFT_STOP = 512;

    // version and errors

    /// <summary>The library's: 1000000 * major + 1000 * minor + patch, as HAPTO_VERSION of the header. [1 kHz]</summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern uint hapto_version();

    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern byte* hapto_version_string();

    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_last_error(hapto_error* @out);

    /// <summary>
    /// For companion libraries: sets the text of hapto_last_error() for this thread, and returns the status. NULL is
    /// "".
    /// </summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_note_error(int status, byte* message, byte* key, byte* value, byte* valid);

    /// <summary>A status in words. [1 kHz]</summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern byte* hapto_status_text(int status);

    // results with more than one number

    /// <summary>A JSON object, valid until the result is destroyed.</summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_result_json(IntPtr result, byte** json);

    /// <summary>A number of it, by its path: "residual_friction_angle_deg", "points.0.peak_pa".</summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_result_value(IntPtr result, byte* path, double* @out);

    /// <summary>A column of its table, doubles. Names of the columns are in the JSON, under "columns".</summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_result_column(IntPtr result, byte* name, hapto_array* @out);

    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_result_destroy(IntPtr result);

    /// <summary>Available items, as {"names": [...]}: "scenes", "soils", "presets", "bodies", "lab tests" or "instruction set" (the one in use).</summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_list(byte* what, IntPtr* @out);

    // scenes: soil in a box and a tool, or several

    /// <summary>
    /// A scene from the text of a scene file; NULL or "" is the scene icra2021.
    /// name       its name in messages; NULL: "scene". Files that it names are relative to that name.
    /// overrides  `count` texts "table.key=value" that replace keys of the file.
    /// progress   may be NULL. Soil that settles takes seconds to minutes the first time.
    /// Errors: HAPTO_INVALID_PARAMETER with key, value and valid range; HAPTO_FAILURE when soil does not settle.
    /// </summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_scene_from_toml(byte* text, byte* name, byte** overrides, uint count, IntPtr progress, void* user, IntPtr* @out);

    /// <summary>
    /// As above from a built-in scene of that name ("icra2021", "regolith": hapto_list("scenes")), or a file. "auto" is soil of the
    /// Moon in the finest particles that this machine renders at 1 kHz with a core left to others: it measures the machine,
    /// about a second the first time, and keeps the result with settled soil. Overrides of soil.radius_mm and bed.threads
    /// count.
    /// </summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_scene_from_file(byte* name_or_path, byte** overrides, uint count, IntPtr progress, void* user, IntPtr* @out);

    /// <summary>Another scene that continues from here with the same bits.</summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_scene_clone(IntPtr scene, IntPtr* @out);

    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_scene_destroy(IntPtr scene);

    /// <summary>Goes through all particles: not for a 1 kHz loop.</summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_scene_get_info(IntPtr scene, hapto_scene_info* @out);

    /// <summary>
    /// The scene as TOML, complete: hapto_scene_from_toml() makes one like it. With its zero byte it needs `needed` bytes;
    /// when `capacity` is less, nothing is written and the status is HAPTO_TOO_SMALL. text may be NULL then.
    /// </summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_scene_get_toml(IntPtr scene, byte* text, ulong capacity, ulong* needed);

    /// <summary>
    /// Puts the tool somewhere without moving it there. Soil that finds itself inside is pushed out with full force: place it
    /// above the soil. [1 kHz]
    /// </summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_scene_place_tool(IntPtr scene, hapto_pose* scene_T_tool);

    /// <summary>[1 kHz]</summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_scene_get_tool_pose(IntPtr scene, hapto_pose* scene_T_tool);

    /// <summary>
    /// One tick of tick_s: moves the tool in a straight line to the pose while the soil answers.
    /// twist        how fast the tool moves, for damping and friction; NULL: as the way from where it was says.
    /// soil_wrench  wrench of the soil on the tool, mean over the tick, about the tool's origin, scene frame; may be NULL.
    /// Errors: HAPTO_INVALID_PARAMETER for a pose that is not finite, not of norm 1, or further than 1 m outside the box or
    /// 3 m above its floor; HAPTO_NOT_FINITE and HAPTO_COLLAPSED from then on until another state is set. [1 kHz]
    /// </summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_scene_step(IntPtr scene, hapto_pose* scene_T_tool, hapto_twist* twist, hapto_wrench* soil_wrench);

    /// <summary>
    /// `count` ticks: poses[i], twists[i] (or NULL) give soil_wrenches[i] (or NULL). Ends at the first failure; `done` (or NULL) is how
    /// many went well. [1 kHz] in cost a tick.
    /// </summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_scene_steps(IntPtr scene, ulong count, hapto_pose* poses, hapto_twist* twists, hapto_wrench* soil_wrenches, ulong* done);

    /// <summary>Wrench of the soil on the tool in the last tick, about the tool's origin, scene frame. [1 kHz]</summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_scene_get_wrench(IntPtr scene, hapto_wrench* soil_wrench);

    /// <summary>
    /// Derivative of the force for a small movement of the tool with unchanged velocities of the soil: dF = -K dx, K row by row in N/m, scene frame. To
    /// extrapolate between ticks in a loop that is faster. [1 kHz]
    /// </summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_scene_get_contact_stiffness(IntPtr scene, double* n_m);

    /// <summary>Sets the opening of the jaws at the end of the next tick, 0 to 1; without effect on other tools. [1 kHz]</summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_scene_set_opening(IntPtr scene, double share);

    /// <summary>Force of the soil that opened the jaws in the last tick. [1 kHz]</summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_scene_get_grip_force(IntPtr scene, double* n);

    /// <summary>
    /// Sets the present fraction of the tool, 0 to 1, from the next tick on: a tool that grows slowly moves soil out of its way
    /// gently. [1 kHz]
    /// </summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_scene_set_tool_fade(IntPtr scene, double share);

    /// <summary>
    /// Gravity from the next tick on, scene frame, 1000 m/s^2 at most: for a box on a vehicle. Another gravity wakes all soil that
    /// sleeps. [1 kHz]
    /// </summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_scene_set_gravity(IntPtr scene, double* m_s2);

    /// <summary>
    /// Changes soil, gravity or tools of the soil as it lies, by overrides: "gravity.body=Mars", "tool.diameter_mm=40" (every
    /// tool), "tools.left.friction=0.4". HAPTO_INVALID_PARAMETER when that needs another bed: another particle radius, more
    /// steps in a tick, any other table.
    /// </summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_scene_change(IntPtr scene, byte** overrides, uint count);

    /// <summary>
    /// Scenes with several [[tools]], up to 16, have numbers for them from 0 on, in the order of the file. Each tool starts
    /// [mapping] offset_mm above the soil. A tool other than the first does not touch the soil until it is placed or stepped
    /// for the first time. Functions without a tool's number are for the first tool; the others then stay where they are.
    /// </summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_scene_tools(IntPtr scene, uint* count);

    /// <summary>Name of a tool, "tool" in a scene without [[tools]]; valid until the scene is destroyed. [1 kHz]</summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_scene_tool_name(IntPtr scene, uint tool, byte** name);

    /// <summary>Number of the tool with a name. HAPTO_INVALID_PARAMETER, which lists the names, for an unknown one.</summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_scene_find_tool(IntPtr scene, byte* name, uint* tool);

    /// <summary>
    /// One tick of all tools, as hapto_scene_step(): poses[k], twists[k] (or NULL) give soil_wrenches[k] (or NULL).
    /// count  of poses: the number of tools, else HAPTO_WRONG_TOOL.
    /// Nothing moves when a pose is not valid. [1 kHz]
    /// </summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_scene_step_tools(IntPtr scene, hapto_pose* poses, hapto_twist* twists, uint count, hapto_wrench* soil_wrenches);

    /// <summary>`ticks` of it, as hapto_scene_steps(): poses[t * count + k]. [1 kHz] in cost a tick.</summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_scene_steps_tools(IntPtr scene, ulong ticks, hapto_pose* poses, hapto_twist* twists, uint count, hapto_wrench* soil_wrenches, ulong* done);

    /// <summary>As hapto_scene_place_tool(), hapto_scene_set_opening(), hapto_scene_set_tool_fade(). [1 kHz]</summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_scene_tool_place(IntPtr scene, uint tool, hapto_pose* scene_T_tool);

    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_scene_tool_set_opening(IntPtr scene, uint tool, double share);

    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_scene_tool_set_fade(IntPtr scene, uint tool, double share);

    /// <summary>
    /// Sets the speed in rad/s or the torque in N m of a joint's drive from the next tick on, in the valid range of its key.
    /// HAPTO_INVALID_PARAMETER also for a tool with neither. [1 kHz]
    /// </summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_scene_tool_set_drive(IntPtr scene, uint tool, double value);

    /// <summary>[1 kHz]</summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_scene_tool_get_state(IntPtr scene, uint tool, hapto_tool_state* @out);

    /// <summary>
    /// Particles where they are, without copy. The numbers change, and the address too, with every step: fetch the view again
    /// after each. The memory itself stays readable until the scene is destroyed. [1 kHz]
    /// </summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_scene_view(IntPtr scene, int field, hapto_array* @out);

    /// <summary>A copy, packed: `bytes` must be what the field needs, particles * components * 4 or 1.</summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_scene_copy(IntPtr scene, int field, void* @out, ulong bytes);

    /// <summary>
    /// The complete scene as bytes, its parameters included. Scenes with equal bytes continue with equal bits. `needed` as in
    /// hapto_scene_get_toml(). The bytes are for this version of the library and one arithmetic, on any machine.
    /// </summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_scene_get_state(IntPtr scene, void* bytes, ulong capacity, ulong* needed);

    /// <summary>Continues from there; the scene must have been made with the same parameters. It is unchanged when this fails.</summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_scene_set_state(IntPtr scene, void* bytes, ulong count);

    /// <summary>A new scene that continues from there, without settling again.</summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_scene_from_state(void* bytes, ulong count, IntPtr* @out);

    /// <summary>64-bit hash of the particles and what their contacts remember, as `haptolith run --json` prints it.</summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_scene_state_hash(IntPtr scene, ulong* @out);

    // batches: many scenes on several threads

    /// <summary>
    /// Threads that step scenes, which stay the caller's and must not be destroyed before the batch.
    /// threads  0: as many as the machine has.
    /// </summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_batch_create(IntPtr* scenes, uint count, uint threads, IntPtr* @out);

    /// <summary>
    /// `ticks` of each scene: that number i moves along poses[i * ticks + t], which gives soil_wrenches[i * ticks + t]. Bit-identical to
    /// stepping one by one. status[i] is the status of scene i; each pointer but poses may be NULL. The first status that is not HAPTO_OK is
    /// returned.
    /// </summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_batch_step(IntPtr batch, ulong ticks, hapto_pose* poses, hapto_twist* twists, hapto_wrench* soil_wrenches, int* status);

    /// <summary>
    /// As above with the poses of all tools: for each scene, for each tick, for each tool one, in this order.
    /// count  of poses, else HAPTO_WRONG_TOOL.
    /// </summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_batch_step_tools(IntPtr batch, ulong ticks, hapto_pose* poses, hapto_twist* twists, ulong count, hapto_wrench* soil_wrenches, int* status);

    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_batch_destroy(IntPtr batch);

    // soils

    /// <summary>A soil with a name (hapto_list("soils")), a preset of icra2021 ("P1" to "P6"), or a soil file.</summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_soil_find(byte* name_or_path, IntPtr* @out);

    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_soil_from_toml(byte* text, byte* name, IntPtr* @out);

    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_soil_destroy(IntPtr soil);

    /// <summary>
    /// A number of its file (docs/reference/soils.md): "target.friction_angle_deg", "soil.radius_mm", "reached.cohesion_pa".
    /// HAPTO_INVALID_PARAMETER for a key that the soil has not.
    /// </summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_soil_get(IntPtr soil, byte* key, double* @out);

    /// <summary>As a soil file; as hapto_scene_get_toml(). HAPTO_INVALID_PARAMETER for a preset, of which nothing was measured.</summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_soil_get_toml(IntPtr soil, byte* text, ulong capacity, ulong* needed);

    /// <summary>
    /// Its layers under its own weight down to a depth (paper, Fig. 1): columns depth_m, top_m, bottom_m, spacing_m,
    /// density_kg_m3.
    /// </summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_soil_profile(IntPtr soil, double gravity_m_s2, double depth_m, IntPtr* @out);

    /// <summary>
    /// Finds contact parameters with which a sheared bed matches measured values (docs/how-to/test-a-soil.md); takes minutes.
    /// target  "friction_angle_deg = 42\ncohesion_pa = 520\nbulk_density_kg_m3 = 1500" in TOML, and if need be strength ("residual" or
    ///         "peak"), density ("lunar", more of it deeper, or "constant"), radius_mm, stiffness_n_m, body or gravity_m_s2, seed,
    ///         threads, specimens, name, source.
    /// report  what the laboratory measured of it in the end, mean and standard deviation over specimens; may be NULL.
    /// </summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_soil_calibrate(byte* target, IntPtr progress, void* user, IntPtr* @out, IntPtr* report);

    // the laboratory

    /// <summary>
    /// A test of the soil laboratory, as `haptolith lab TEST` makes it (hapto_list("lab tests"); docs/how-to/test-a-soil.md).
    /// options  keys in TOML, as the command's options with _ for -: "normal_pa = [300, 1000, 3000]\nseed = 2\nbody = 'Earth'"; NULL or
    ///          "": the usual ones.
    /// out      the numbers that `--json` prints, "findings" with their target values, and the trace as columns.
    /// Errors: HAPTO_INVALID_PARAMETER with key, value and valid range; HAPTO_FAILURE; HAPTO_STOPPED.
    /// </summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_lab_test(byte* test, IntPtr soil, byte* options, IntPtr progress, void* user, IntPtr* @out);

    /// <summary>
    /// Returns how far the force of a scene's movement can be believed, as `haptolith trust` prints it (docs/reports/trust.md): the soil
    /// is simulated again with other specimens, a larger box, finer particles, shorter steps and so on. Takes minutes. The scene is
    /// neither stepped nor changed; virtual hands make the movements that its file names.
    /// options  TOML: tool, the name of the one whose force is judged; duration_s of the movement, 0.25 to 3600; specimens, 2 to 100;
    ///          minutes, 0.1 to 10000; threads; NULL or "": the first, one motion of its hand, 5, 30, all.
    /// out      the numbers that `--json` prints: "sentence", "mean_within" and "peak_within" (relative, 90 %), "complaints", "effects".
    /// Errors: HAPTO_INVALID_PARAMETER with key, value and valid range; HAPTO_FAILURE; HAPTO_STOPPED. Not for the tick.
    /// </summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_scene_trust(IntPtr scene, byte* options, IntPtr progress, void* user, IntPtr* @out);

    // psychometric functions

    /// <summary>
    /// Fits a psychometric function to answers, as `haptolith study fit` does (docs/reference/psychometrics.md).
    /// levels   `count` rows of three numbers: stimulus, positive answers, answers.
    /// options  TOML: design, alternatives, sigmoid, log_x, falling, reference, free_threshold, lapse, guess, overdispersion (a number
    ///          or "free"), method, confidence, simulations, pool_tolerance; NULL or "": sigmoid "weber", design "equal-asymptote".
    /// The result has what the command prints with --json, and the function with its band as columns x, psi, psi_low, psi_high.
    /// Errors: HAPTO_INVALID_PARAMETER for options and answers that make no sense.
    /// </summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_psychometric_fit(double* levels, ulong count, byte* options, IntPtr* @out);

    // the loop: a device or a hand at 1 kHz

    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_device_limits_init(hapto_device_limits* @out);

    /// <summary>
    /// A loop that joins a scene and a device: mapping, coupling, filter and the safety layer as the scene's tables [mapping],
    /// [coupling], [loop], [safety] say. The scene belongs to it until hapto_loop_destroy(): other calls give HAPTO_BUSY.
    /// The device moves the first tool; others do not touch the soil until then (hapto_loop_create_tools() moves all).
    /// device  the caller's; its zero is [mapping] offset_mm above the soil's surface, 85 mm unless the scene says otherwise.
    ///         NULL: the device that the scene's [device] names, a virtual hand by default.
    /// flags   HAPTO_LOOP_...; 0: hapto_loop_start() gives it a thread.
    /// </summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_loop_create(IntPtr scene, hapto_device* device, uint flags, IntPtr* @out);

    /// <summary>
    /// As above for all tools of a scene: devices[k] moves tool k; where it is NULL, the device that the tool's [tools.device]
    /// names, a virtual hand by default. Each hand has its own mapping, coupling, safety layer and watchdog; the loop ends when
    /// the last person's device is lost. Each tick gives `count` ticks, one for each tool.
    /// count  number of the scene's tools; HAPTO_WRONG_TOOL for another. At most 4 devices are not virtual hands.
    /// </summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_loop_create_tools(IntPtr scene, hapto_device** devices, uint count, uint flags, IntPtr* @out);

    /// <summary>
    /// Runs it on a separate thread, in step with the clock, with real-time priority and the process's memory locked where the
    /// system grants that; as fast as it can when the scene says loop.real_time=false, which needs a simulated hand. A watchdog sets the
    /// force on a person's hand to zero when 4 ms pass without a tick (safety.watchdog_timeout_ms).
    /// </summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_loop_start(IntPtr loop);

    /// <summary>
    /// One tick. late: whether the one before ended late (1). There is no watchdog: the caller has to set the
    /// device's force to zero when it cannot tick. HAPTO_ENDED when it was the last. [1 kHz]
    /// </summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_loop_tick(IntPtr loop, int late);

    /// <summary>Ends a started loop: the force on a person's hand fades, and the thread has ended on return.</summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_loop_stop(IntPtr loop);

    /// <summary>Stops it, if need be, and gives the scene back, with all changes that were asked for and a tool that is wholly there.</summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_loop_destroy(IntPtr loop);

    /// <summary>
    /// The newest snapshot, about 60 per second; may be called while the loop runs, from one thread. Valid until the next call.
    /// Before the first snapshot there are no positions. While time is paused the wrenches are those of the last tick, and the
    /// device is sent zero.
    /// </summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_loop_snapshot(IntPtr loop, hapto_snapshot* @out);

    /// <summary>
    /// A tool in the snapshot that hapto_loop_snapshot() gave last, without fade, grip_force_n and stiffness_n_m (0). From the
    /// same thread.
    /// </summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_loop_get_tool(IntPtr loop, uint tool, hapto_tool_state* @out);

    /// <summary>
    /// Takes up to `capacity` of the waiting ticks, the oldest first; `count` is their number, `lost` (or NULL) the number lost so far
    /// because they were not taken in time: take them every second or more often. From the thread that takes snapshots.
    /// </summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_loop_take_ticks(IntPtr loop, hapto_tick* @out, ulong capacity, ulong* count, ulong* lost);

    /// <summary>
    /// Description of this loop for a recording, as a JSON object: "scenario" (the scene as TOML), "title", "instruction_set",
    /// "arithmetic", "device", "device_limits" (JSON), "seed", "threads", "hashed_parts", "start_tick" (0: soil and tool were as the
    /// scene says when the loop was made), "tick_s", "paced". With the bytes needed, as hapto_scene_get_toml().
    /// </summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_loop_get_header(IntPtr loop, byte* json, ulong capacity, ulong* needed);

    /// <summary>Pauses time and sets the force to zero (1), or resumes (0), between two ticks. From the thread that takes snapshots.</summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_loop_pause(IntPtr loop, int on);

    /// <summary>As hapto_scene_change() while it runs: no hand feels a jump. From the thread that takes snapshots.</summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_loop_change(IntPtr loop, byte** overrides, uint count);

    // the safety layer alone, for hosts with their own loop and device

    /// <summary>
    /// Protection between a simulated force and a person's hand (docs/explanation/safety.md): plausibility of the input, soft start, the
    /// device's limits and rates, passivity.
    /// overrides      keys of [safety], "safety.soft_start_s=1".
    /// tick_s         of the caller's loop, 0.0001 to 0.1.
    /// stiffness_n_m  of the softest spring that stores what the hand presses with: the tool's contact, the soil's, or a virtual
    ///                coupling's.
    /// </summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_safety_create(hapto_device_limits* limits, byte** overrides, uint count, double tick_s, double stiffness_n_m, IntPtr* @out);

    /// <summary>
    /// Each tick: the device's reading, whether the tick before ended late (1), and the requested output, which is replaced
    /// by the permitted one: both device frame. [1 kHz]
    /// </summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_safety_step(IntPtr safety, hapto_device_input* input, int late, hapto_device_output* inout);

    /// <summary>[1 kHz]</summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_safety_get_info(IntPtr safety, hapto_safety_info* @out);

    /// <summary>Force goes to nothing softly and stays there (1): the run is about to end. [1 kHz]</summary>
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_safety_stop(IntPtr safety);

    [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
    public static extern int hapto_safety_destroy(IntPtr safety);
  }
}
