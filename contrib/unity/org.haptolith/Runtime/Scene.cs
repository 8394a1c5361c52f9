using System;
using System.Runtime.InteropServices;

namespace Haptolith
{
  /// <summary>
  /// Soil in a box and a tool, or several. Poses, forces and torques are in the scene's frame (UnityFrame converts to Unity's). Not thread-safe:
/// a concurrent call gets Status.Busy.
  /// </summary>
  public sealed unsafe partial class Scene : IDisposable
  {
    readonly SceneHandle handle_;

    Scene(IntPtr scene)
    {
      handle_ = new SceneHandle(scene);
    }

    /// <summary>Handle for functions of Native that are missing in this class.</summary>
    public SceneHandle Handle
    {
      get { return handle_; }
    }

    // --- creation ---

    /// <summary>A built-in scene ("icra2021", "regolith") or a file, with overrides "table.key=value". "auto" is lunar soil
/// with the finest particles that this machine renders at 1 kHz; this is measured once, within 1 s.</summary>
    public static Scene FromFile(string name_or_path, string[] overrides = null, Progress progress = null)
    {
      Library.RequireSameVersion();
      fixed (byte* name = Text.Bytes(name_or_path))
      using (TextList texts = new TextList(overrides))
      using (ProgressCall call = new ProgressCall(progress))
      {
        IntPtr made = IntPtr.Zero;
        int status = Native.hapto_scene_from_file(name, texts.Pointer, texts.Count, call.Function, call.User, &made);
        return Made(status, made, call);
      }
    }

    /// <summary>Creates a scene from the text of a scene file; "" is the scene of icra2021.</summary>
    public static Scene FromToml(string text, string[] overrides = null, Progress progress = null)
    {
      Library.RequireSameVersion();
      fixed (byte* toml = Text.Bytes(text))
      using (TextList texts = new TextList(overrides))
      using (ProgressCall call = new ProgressCall(progress))
      {
        IntPtr made = IntPtr.Zero;
        int status = Native.hapto_scene_from_toml(toml, null, texts.Pointer, texts.Count, call.Function, call.User, &made);
        return Made(status, made, call);
      }
    }

    /// <summary>Creates a scene from the result of GetState(), bit-identical and without settling.</summary>
    public static Scene FromState(byte[] state)
    {
      Library.RequireSameVersion();
      IntPtr made = IntPtr.Zero;
      fixed (byte* bytes = state)
      {
        Check.Require(Native.hapto_scene_from_state(bytes, state == null ? 0 : (ulong)state.Length, &made));
      }
      return new Scene(made);
    }

    /// <summary>Returns a bit-identical copy of the scene.</summary>
    public Scene Clone()
    {
      IntPtr made = IntPtr.Zero;
      using (Borrowed scene = new Borrowed(handle_))
      {
        Check.Require(Native.hapto_scene_clone(scene.Address, &made));
      }
      return new Scene(made);
    }

    /// <summary>Frees the memory; repeated calls have no effect. A scene in use by a loop is kept until the loop ends.</summary>
    public void Dispose()
    {
      handle_.Dispose();
    }

    static Scene Made(int status, IntPtr made, ProgressCall call)
    {
      Scene scene = status == Native.HAPTO_OK ? new Scene(made) : null;
      try
      {
        call.Rethrow();
      }
      catch
      {
        if (scene != null)
        {
          scene.Dispose();
        }
        throw;
      }
      Check.Require(status);
      return scene;
    }

    // --- moving the tool ---

    /// <summary>
    /// Runs one tick of 1 ms: moves the tool in a straight line to the pose. Returns the wrench of the soil on the tool, about the
/// tool's origin, scene frame.
    /// </summary>
    public Wrench Step(Pose scene_T_tool)
    {
      Wrench felt;
      using (Borrowed scene = new Borrowed(handle_))
      {
        Check.RequireOfTick(Native.hapto_scene_step(scene.Address, (hapto_pose*)&scene_T_tool, null, (hapto_wrench*)&felt));
      }
      return felt;
    }

    /// <summary>As above, with the tool's velocity for damping and friction.</summary>
    public Wrench Step(Pose scene_T_tool, Twist twist)
    {
      Wrench felt;
      using (Borrowed scene = new Borrowed(handle_))
      {
        Check.RequireOfTick(Native.hapto_scene_step(scene.Address, (hapto_pose*)&scene_T_tool, (hapto_twist*)&twist, (hapto_wrench*)&felt));
      }
      return felt;
    }

    /// <summary>Runs many ticks; each pointer except poses may be null. For NativeArray: its GetUnsafePtr(). Returns the number of successful ticks.</summary>
    public long Steps(Pose* poses, Twist* twists, Wrench* felt, long count)
    {
      ulong done = 0;
      using (Borrowed scene = new Borrowed(handle_))
      {
        Check.RequireOfTick(Native.hapto_scene_steps(scene.Address, Size(count), (hapto_pose*)poses, (hapto_twist*)twists,
                                                     (hapto_wrench*)felt, &done));
      }
      return (long)done;
    }

    /// <summary>Runs many ticks; felt receives the soil wrench of each, scene frame, and may be null.</summary>
    public void Steps(Pose[] poses, Wrench[] felt)
    {
      if (felt != null && felt.Length < poses.Length)
      {
        throw new ArgumentException("there is less room for what is felt than there are poses");
      }
      fixed (Pose* to = poses)
      fixed (Wrench* from = felt)
      {
        if (poses.Length > 0)
        {
          Steps(to, null, from, poses.Length);
        }
      }
    }

    /// <summary>
    /// Moves the tool uniformly from its current pose to the given one within a number of ticks: for one frame of a host, 16 or 17
/// ticks at 60 Hz. Returns the mean soil wrench, scene frame.
    /// </summary>
    public Wrench MoveTool(Pose scene_T_tool, int ticks)
    {
      if (ticks < 1)
      {
        throw new ArgumentOutOfRangeException("ticks", ticks, "must be 1 or more");
      }
      Wrench sum = new Wrench();
      using (Borrowed scene = new Borrowed(handle_))
      {
        Pose begin;
        Check.RequireOfTick(Native.hapto_scene_get_tool_pose(scene.Address, (hapto_pose*)&begin));
        for (int tick = 1; tick <= ticks; ++tick)
        {
          Pose to = tick == ticks ? scene_T_tool : Between(begin, scene_T_tool, (double)tick / ticks);
          Wrench felt;
          Check.RequireOfTick(Native.hapto_scene_step(scene.Address, (hapto_pose*)&to, null, (hapto_wrench*)&felt));
          sum.Force_N = Sum(sum.Force_N, felt.Force_N, 1.0 / ticks);
          sum.Torque_Nm = Sum(sum.Torque_Nm, felt.Torque_Nm, 1.0 / ticks);
        }
      }
      return sum;
    }

    /// <summary>Places the tool at a pose without moving it there; the pose should be above the soil.</summary>
    public void PlaceTool(Pose scene_T_tool)
    {
      using (Borrowed scene = new Borrowed(handle_))
      {
        Check.RequireOfTick(Native.hapto_scene_place_tool(scene.Address, (hapto_pose*)&scene_T_tool));
      }
    }

    public Pose ToolPose
    {
      get
      {
        Pose scene_T_tool;
        using (Borrowed scene = new Borrowed(handle_))
        {
          Check.RequireOfTick(Native.hapto_scene_get_tool_pose(scene.Address, (hapto_pose*)&scene_T_tool));
        }
        return scene_T_tool;
      }
    }

    /// <summary>Wrench of the soil on the tool in the last tick, about the tool's origin, scene frame.</summary>
    public Wrench Felt
    {
      get
      {
        Wrench felt;
        using (Borrowed scene = new Borrowed(handle_))
        {
          Check.RequireOfTick(Native.hapto_scene_get_wrench(scene.Address, (hapto_wrench*)&felt));
        }
        return felt;
      }
    }

    /// <summary>Opening of jaws at the end of the next tick, 0 to 1.</summary>
    public void SetOpening(double share)
    {
      using (Borrowed scene = new Borrowed(handle_))
      {
        Check.RequireOfTick(Native.hapto_scene_set_opening(scene.Address, share));
      }
    }

    /// <summary>Sets the factor on the tool's contact stiffness, 0 to 1, from the next tick on.</summary>
    public void SetToolFade(double share)
    {
      using (Borrowed scene = new Borrowed(handle_))
      {
        Check.RequireOfTick(Native.hapto_scene_set_tool_fade(scene.Address, share));
      }
    }

    /// <summary>Sets gravity from the next tick on, scene frame.</summary>
    public void SetGravity(Vec3 m_s2)
    {
      using (Borrowed scene = new Borrowed(handle_))
      {
        Check.RequireOfTick(Native.hapto_scene_set_gravity(scene.Address, (double*)&m_s2));
      }
    }

    /// <summary>Changes soil, gravity or tool without moving particles: "gravity.body=Mars".</summary>
    public void Change(params string[] overrides)
    {
      using (TextList texts = new TextList(overrides))
      using (Borrowed scene = new Borrowed(handle_))
      {
        Check.Require(Native.hapto_scene_change(scene.Address, texts.Pointer, texts.Count));
      }
    }

    // --- reading ---

    /// <summary>Returns numbers of the scene as in C; iterates over all particles.</summary>
    public hapto_scene_info Info
    {
      get
      {
        hapto_scene_info info = new hapto_scene_info { size = (uint)sizeof(hapto_scene_info) };
        using (Borrowed scene = new Borrowed(handle_))
        {
          Check.Require(Native.hapto_scene_get_info(scene.Address, &info));
        }
        return info;
      }
    }

    public long ParticleCount
    {
      get { return (long)View(Field.Position).count; }
    }

    /// <summary>Copies the centres, m, as consecutive x y z; room is the capacity in particles. Returns the number of particles.</summary>
    public long CopyPositions(float* xyz_m, long room, Frame frame)
    {
      using (Borrowed scene = new Borrowed(handle_))
      {
        hapto_array positions = View(Field.Position);
        RequireRoom(positions, room);
        UnityFrame.Copy(positions, xyz_m, frame);
        return (long)positions.count;
      }
    }

    /// <summary>As above, into an array of three numbers per particle.</summary>
    public long CopyPositions(float[] xyz_m, Frame frame)
    {
      fixed (float* to = xyz_m)
      {
        return CopyPositions(to, xyz_m.Length / 3, frame);
      }
    }

    /// <summary>Copies a field as in C, packed, scene frame; bytes must be the size of the field.</summary>
    public void Copy(Field field, void* to, long bytes)
    {
      using (Borrowed scene = new Borrowed(handle_))
      {
        Check.Require(Native.hapto_scene_copy(scene.Address, (int)field, to, Size(bytes)));
      }
    }

    /// <summary>
    /// Positions or velocities in the library's memory, without a copy, scene frame. Outdated after the next step; invalid after the
/// scene is disposed.
    /// </summary>
    public hapto_array View(Field field)
    {
      hapto_array view = new hapto_array { size = (uint)sizeof(hapto_array) };
      using (Borrowed scene = new Borrowed(handle_))
      {
        Check.RequireOfTick(Native.hapto_scene_view(scene.Address, (int)field, &view));
      }
      return view;
    }

    // --- state ---

    /// <summary>64-bit hash of the particles and their contact history, as printed by `haptolith run --json`.</summary>
    public ulong StateHash
    {
      get
      {
        ulong hash;
        using (Borrowed scene = new Borrowed(handle_))
        {
          Check.Require(Native.hapto_scene_state_hash(scene.Address, &hash));
        }
        return hash;
      }
    }

    /// <summary>Returns the complete scene with its parameters, for one version and arithmetic, on any machine.</summary>
    public byte[] GetState()
    {
      using (Borrowed scene = new Borrowed(handle_))
      {
        ulong needed = 0;
        int status = Native.hapto_scene_get_state(scene.Address, null, 0, &needed);
        if (status != Native.HAPTO_TOO_SMALL)
        {
          Check.Require(status);
        }
        byte[] state = new byte[needed];
        fixed (byte* bytes = state)
        {
          Check.Require(Native.hapto_scene_get_state(scene.Address, bytes, needed, &needed));
        }
        return state;
      }
    }

    /// <summary>Restores a state; the scene must have been created with equal parameters.</summary>
    public void SetState(byte[] state)
    {
      fixed (byte* bytes = state)
      using (Borrowed scene = new Borrowed(handle_))
      {
        Check.Require(Native.hapto_scene_set_state(scene.Address, bytes, state == null ? 0 : (ulong)state.Length));
      }
    }

    internal static void RequireRoom(hapto_array positions, long room)
    {
      if (room < 0 || (ulong)room < positions.count)
      {
        throw new HaptolithException(Status.TooSmall,
          "the buffer has room for " + room + " particles, and there are " + positions.count);
      }
    }

    static ulong Size(long count)
    {
      if (count < 0)
      {
        throw new ArgumentOutOfRangeException("count", count, "must not be negative");
      }
      return (ulong)count;
    }

    static Vec3 Sum(Vec3 sum, Vec3 more, double share)
    {
      return new Vec3(sum.X + share * more.X, sum.Y + share * more.Y, sum.Z + share * more.Z);
    }

    /// <summary>Interpolates positions linearly and rotations along the shorter way.</summary>
    static Pose Between(Pose a, Pose b, double share)
    {
      Vec3 way_m = new Vec3(b.Position_m.X - a.Position_m.X, b.Position_m.Y - a.Position_m.Y, b.Position_m.Z - a.Position_m.Z);
      Quat p = a.Orientation, q = b.Orientation;
      double sign = p.W * q.W + p.X * q.X + p.Y * q.Y + p.Z * q.Z < 0 ? -1 : 1;
      double rest = 1 - share, to = sign * share;
      Quat r = new Quat(rest * p.W + to * q.W, rest * p.X + to * q.X, rest * p.Y + to * q.Y, rest * p.Z + to * q.Z);
      double norm = Math.Sqrt(r.W * r.W + r.X * r.X + r.Y * r.Y + r.Z * r.Z);
      return new Pose(Sum(a.Position_m, way_m, share), new Quat(r.W / norm, r.X / norm, r.Y / norm, r.Z / norm));
    }
  }
}
