using System;

namespace Haptolith
{
  /// <summary>Cause of a safety trip: hapto_tick.trip.</summary>
  public enum Trip : uint
  {
    None = Native.HAPTO_TRIP_NONE,
    DeviceNotFinite = Native.HAPTO_TRIP_DEVICE_NOT_FINITE,
    Stale = Native.HAPTO_TRIP_STALE,
    Lost = Native.HAPTO_TRIP_LOST,
    Workspace = Native.HAPTO_TRIP_WORKSPACE,
    MissedDeadlines = Native.HAPTO_TRIP_MISSED_DEADLINES,
    Heartbeat = Native.HAPTO_TRIP_HEARTBEAT,
    ForceNotFinite = Native.HAPTO_TRIP_FORCE_NOT_FINITE,
    Implausible = Native.HAPTO_TRIP_IMPLAUSIBLE
  }

  /// <summary>Events in a tick or before it: hapto_tick.flags.</summary>
  [Flags]
  public enum TickFlags : uint
  {
    None = 0,
    Late = Native.HAPTO_TICK_LATE,
    Zeroed = Native.HAPTO_TICK_ZEROED,
    Saturated = Native.HAPTO_TICK_SATURATED,
    RateLimited = Native.HAPTO_TICK_RATE_LIMITED,
    SoftStart = Native.HAPTO_TICK_SOFT_START,
    Damped = Native.HAPTO_TICK_DAMPED,
    Resumed = Native.HAPTO_TICK_RESUMED,
    HeartbeatLost = Native.HAPTO_TICK_HEARTBEAT_LOST,
    SceneChanged = Native.HAPTO_TICK_SCENE_CHANGED,
    SoftStop = Native.HAPTO_TICK_SOFT_STOP,
    Failed = Native.HAPTO_TICK_FAILED,
    SoilAdjusted = Native.HAPTO_TICK_SOIL_ADJUSTED,
    ParticleMoved = Native.HAPTO_TICK_PARTICLE_MOVED
  }

  /// <summary>A snapshot of a running loop.</summary>
  public struct LoopSnapshot
  {
    /// <summary>Whether the loop is running; false before the start and after the end.</summary>
    public bool Running;

    /// <summary>Reason for the end of the loop; "" while it runs.</summary>
    public string End;

    /// <summary>Reason for the current safety trip; "" without one.</summary>
    public string Trip;

    public bool Paused;
    public ulong Ticks;
    public ulong DeadlineMisses;

    /// <summary>Part of DeadlineMisses: the tick's work took too long, for example because the soil is too fine for this machine.</summary>
    public ulong MissesTooLong;

    /// <summary>Part of DeadlineMisses: the system woke the loop's thread late.</summary>
    public ulong MissesWokenLate;

    /// <summary>Part of DeadlineMisses: the thread was preempted during the tick.</summary>
    public ulong MissesPreempted;

    public double Time_s;
    public Pose Scene_T_Tool;
    public double Opening_m;

    /// <summary>Wrench of the soil on the tool in the last tick, about the tool's origin, scene frame, unfiltered.</summary>
    public Wrench SoilWrench;

    /// <summary>Wrench sent to the device in the last tick, about the handle's origin, device frame.</summary>
    public Wrench DeviceWrench;

    /// <summary>Deprecated: DeviceWrench rotated into the scene's axes. Use DeviceWrench or SoilWrench.</summary>
    public Wrench Felt;

    /// <summary>Fraction of the last 100 ticks that ended in time.</summary>
    public double SuccessRate;

    public double TickP99_us;

    /// <summary>Number of positions in this snapshot; 0 before the first one.</summary>
    public long Particles;
  }

  /// <summary>
  /// Connects a scene with its device at 1 kHz, on a thread of the library, with the safety layer. No C# code runs in the loop: one
/// thread, such as Unity's main thread, polls it once per frame. The scene belongs to the loop until Dispose().
  /// </summary>
  public sealed unsafe class Loop : IDisposable
  {
    readonly LoopHandle handle_;
    hapto_snapshot latest_;

    /// <summary>keep_ticks: keeps records of ticks for TakeTicks().</summary>
    public Loop(Scene scene, bool keep_ticks = false)
    {
      bool added = false;
      scene.Handle.DangerousAddRef(ref added);
      IntPtr made;
      try
      {
        uint flags = keep_ticks ? (uint)(Native.HAPTO_LOOP_KEEPS_TICKS | Native.HAPTO_LOOP_HASHES) : 0;
        Check.Require(Native.hapto_loop_create(scene.Handle.DangerousGetHandle(), null, flags, &made));
      }
      catch
      {
        scene.Handle.DangerousRelease();
        throw;
      }
      handle_ = new LoopHandle(made, scene.Handle);
    }

    /// <summary>Handle for functions of Native that are missing in this class.</summary>
    public LoopHandle Handle
    {
      get { return handle_; }
    }

    /// <summary>Starts the loop on a separate thread, paced by the clock unless the scene has loop.real_time=false.</summary>
    public void Start()
    {
      using (Borrowed loop = new Borrowed(handle_))
      {
        Check.Require(Native.hapto_loop_start(loop.Address));
      }
    }

    /// <summary>Ends the loop: the force on a person's hand fades out, and the thread has ended on return.</summary>
    public void Stop()
    {
      using (Borrowed loop = new Borrowed(handle_))
      {
        Check.Require(Native.hapto_loop_stop(loop.Address));
      }
    }

    /// <summary>Pauses or resumes time.</summary>
    public void Pause(bool on)
    {
      using (Borrowed loop = new Borrowed(handle_))
      {
        Check.Require(Native.hapto_loop_pause(loop.Address, on ? 1 : 0));
      }
    }

    /// <summary>As Scene.Change(), in the running loop, without a jump of the force.</summary>
    public void Change(params string[] overrides)
    {
      using (TextList texts = new TextList(overrides))
      using (Borrowed loop = new Borrowed(handle_))
      {
        Check.Require(Native.hapto_loop_change(loop.Address, texts.Pointer, texts.Count));
      }
    }

    /// <summary>Returns the newest snapshot, about 60 per second. Allocates no memory while the loop runs without a safety trip.</summary>
    public LoopSnapshot Poll()
    {
      hapto_snapshot now = new hapto_snapshot { size = (uint)sizeof(hapto_snapshot) };
      using (Borrowed loop = new Borrowed(handle_))
      {
        Check.Require(Native.hapto_loop_snapshot(loop.Address, &now));
        latest_ = now;
        return new LoopSnapshot
        {
          Running = now.running != 0,
          End = Text.From(now.end),
          Trip = Text.From(now.trip),
          Paused = now.paused != 0,
          Ticks = now.ticks,
          DeadlineMisses = now.deadline_misses,
          MissesTooLong = now.misses_too_long,
          MissesWokenLate = now.misses_woken_late,
          MissesPreempted = now.misses_preempted,
          Time_s = now.time_s,
          Scene_T_Tool = *(Pose*)&now.scene_T_tool,
          Opening_m = now.opening_m,
          SoilWrench = *(Wrench*)&now.soil_wrench,
          DeviceWrench = *(Wrench*)&now.device_wrench,
          Felt = *(Wrench*)&now.felt,
          SuccessRate = now.success_rate,
          TickP99_us = now.tick_us_p99,
          Particles = (long)now.position.count
        };
      }
    }

    /// <summary>Copies the particle centres of the last Poll(), m, as consecutive x y z; room is the capacity in particles.</summary>
    public long CopyPositions(float* xyz_m, long room, Frame frame)
    {
      using (Borrowed loop = new Borrowed(handle_))
      {
        Scene.RequireRoom(latest_.position, room);
        UnityFrame.Copy(latest_.position, xyz_m, frame);
        return (long)latest_.position.count;
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

    /// <summary>Takes up to room waiting ticks, the oldest first; lost is the number lost so far. Returns their number.</summary>
    public long TakeTicks(hapto_tick* ticks, long room, out ulong lost)
    {
      ulong count = 0, missed = 0;
      using (Borrowed loop = new Borrowed(handle_))
      {
        Check.Require(Native.hapto_loop_take_ticks(loop.Address, ticks, (ulong)Math.Max(0, room), &count, &missed));
      }
      lost = missed;
      return (long)count;
    }

    /// <summary>Stops the loop and releases the scene; repeated calls have no effect.</summary>
    public void Dispose()
    {
      handle_.Dispose();
    }
  }
}
