using System;

namespace Haptolith
{
  /// <summary>Why the safety layer makes the hand feel nothing: hapto_tick.trip.</summary>
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

  /// <summary>What happened in a tick or before it: hapto_tick.flags.</summary>
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

  /// <summary>A picture of a running loop.</summary>
  public struct LoopSnapshot
  {
    /// <summary>False: not started, or ended.</summary>
    public bool Running;

    /// <summary>Why it ended, in words; "" while it runs.</summary>
    public string End;

    /// <summary>Why the hand feels nothing just now; "" when it does.</summary>
    public string Trip;

    public bool Paused;
    public ulong Ticks;
    public ulong DeadlineMisses;

    /// <summary>Of DeadlineMisses: the tick's own work took too long, as with soil too fine for this machine.</summary>
    public ulong MissesTooLong;

    /// <summary>Of DeadlineMisses: the machine woke the loop's thread late.</summary>
    public ulong MissesWokenLate;

    /// <summary>Of DeadlineMisses: the processor was taken away during the tick.</summary>
    public ulong MissesPreempted;

    public double Time_s;
    public Pose Scene_T_Tool;
    public double Opening_m;

    /// <summary>Of the last tick: what the soil does to the tool, about the tool's origin, scene frame, unfiltered.</summary>
    public Wrench SoilWrench;

    /// <summary>Of the last tick: what the device was sent, about the handle's origin, device frame.</summary>
    public Wrench DeviceWrench;

    /// <summary>Deprecated: DeviceWrench turned into the scene's axes. Read DeviceWrench, or SoilWrench.</summary>
    public Wrench Felt;

    /// <summary>Share of the last 100 ticks that ended in time.</summary>
    public double SuccessRate;

    public double TickP99_us;

    /// <summary>How many positions this picture has; 0 before the first.</summary>
    public long Particles;
  }

  /// <summary>
  /// Joins a scene and the device that it names at 1 kHz, on a thread of the library's, with the safety layer. No C# runs in it: one
  /// thread, such as Unity's main thread, polls it once a frame. The scene belongs to the loop until Dispose().
  /// </summary>
  public sealed unsafe class Loop : IDisposable
  {
    readonly LoopHandle handle_;
    hapto_snapshot latest_;

    /// <summary>keep_ticks: for TakeTicks().</summary>
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

    /// <summary>For functions of Native that this class does not have.</summary>
    public LoopHandle Handle
    {
      get { return handle_; }
    }

    /// <summary>Runs it on a thread of its own, in step with the clock unless the scene says loop.paced=false.</summary>
    public void Start()
    {
      using (Borrowed loop = new Borrowed(handle_))
      {
        Check.Require(Native.hapto_loop_start(loop.Address));
      }
    }

    /// <summary>Ends it: a person's hand is let go softly, and the thread has ended on return.</summary>
    public void Stop()
    {
      using (Borrowed loop = new Borrowed(handle_))
      {
        Check.Require(Native.hapto_loop_stop(loop.Address));
      }
    }

    /// <summary>Lets time stand still, or go on.</summary>
    public void Pause(bool on)
    {
      using (Borrowed loop = new Borrowed(handle_))
      {
        Check.Require(Native.hapto_loop_pause(loop.Address, on ? 1 : 0));
      }
    }

    /// <summary>As Scene.Change() while it runs: no hand feels a jump.</summary>
    public void Change(params string[] overrides)
    {
      using (TextList texts = new TextList(overrides))
      using (Borrowed loop = new Borrowed(handle_))
      {
        Check.Require(Native.hapto_loop_change(loop.Address, texts.Pointer, texts.Count));
      }
    }

    /// <summary>The newest picture, some 60 a second. Makes no garbage while the loop runs and the hand feels something.</summary>
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

    /// <summary>Copies the centres of the picture that Poll() fetched, as x y z after x y z, m; room is for how many particles.</summary>
    public long CopyPositions(float* xyz_m, long room, Frame frame)
    {
      using (Borrowed loop = new Borrowed(handle_))
      {
        Scene.RequireRoom(latest_.position, room);
        UnityFrame.Copy(latest_.position, xyz_m, frame);
        return (long)latest_.position.count;
      }
    }

    /// <summary>The same into an array of three numbers for each particle.</summary>
    public long CopyPositions(float[] xyz_m, Frame frame)
    {
      fixed (float* to = xyz_m)
      {
        return CopyPositions(to, xyz_m.Length / 3, frame);
      }
    }

    /// <summary>The ticks that wait, the oldest first, at most room of them; lost is how many nobody took in time. Tells how many.</summary>
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

    /// <summary>Stops it and gives the scene back; a second time does nothing.</summary>
    public void Dispose()
    {
      handle_.Dispose();
    }
  }
}
