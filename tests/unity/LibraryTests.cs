using System;
using System.Diagnostics;
using System.Runtime.InteropServices;
using System.Threading;
using Haptolith;

/// <summary>What the package does with the library that has been built.</summary>
static unsafe class LibraryTests
{
  /// <summary>Soil that falls and has to settle.</summary>
  public const string Rain = "[bed]\nstart = 'rain'\nparticles = 300\n";

  /// <summary>What state_hash.c prints.</summary>
  public static string StateHash()
  {
    using (Scene scene = Scene.FromFile("icra2021", new[] { "loop.real_time=false", "loop.duration_s=1" }))
    {
      using (Loop loop = new Loop(scene))
      {
        loop.Start();
        while (loop.Poll().Running)
        {
          Thread.Sleep(1);
        }
      }
      return scene.StateHash.ToString("x16");
    }
  }

  /// <summary>What dig.c prints.</summary>
  public static string Dig()
  {
    string text = "";
    using (Scene scene = Scene.FromFile("icra2021", new[] { "soil.preset=P3", "gravity.body=Moon" }))
    {
      double surface_m = scene.Info.surface_m;
      Pose tool = Pose.At(0, 0, surface_m + 0.01);
      scene.PlaceTool(tool);
      for (int tick = 0; tick <= 400; ++tick)
      {
        Wrench felt = scene.Step(tool);
        if (tick % 100 == 0)
        {
          text += string.Format(System.Globalization.CultureInfo.InvariantCulture, "{0,5:F1} mm  {1,6:F3} N\n",
                                (surface_m - tool.Position_m.Z) * 1e3, felt.Force_N.Z);
        }
        tool.Position_m.Z -= 1e-4;
      }
    }
    return text;
  }

  public static void Run()
  {
    Expect.Test("The library has the package's version", () => Expect.That(Library.Version.StartsWith("0."), Library.Version));
    Expect.Test("The library tells what there is", () => Expect.That(Library.List("scenes").Contains("\"icra2021\""), Library.List("scenes")));
    Errors();
    Moving();
    Tools();
    Buffers();
    States();
    Loops();
    Frames();
    Handles();
    Progresses();
    Expect.Test("A step and a poll make no garbage", NoGarbage);
  }

  static void Errors()
  {
    Expect.Test("A wrong value is told with key, value and what would be valid", () =>
    {
      var error = Expect.Throws<InvalidParameterException>(() => Scene.FromFile("icra2021", new[] { "bed.threads=0" }));
      Expect.Equal(error.Status, Status.InvalidParameter, "status");
      Expect.Equal(error.Key, "bed.threads", "key");
      Expect.Equal(error.Value, "0", "value");
      Expect.That(error.Valid.Length > 0 && error.Message.Contains("bed.threads"), error.Message + " | " + error.Valid);
    });
    Expect.Test("A file that is not there is told by its name", () =>
    {
      var error = Expect.Throws<HaptolithException>(() => Scene.FromFile("/no/such/scène.toml"));
      Expect.That(error.Message.Contains("/no/such/scène.toml"), error.Message);
    });
    Expect.Test("A wrong pose does not bring up an older error", () =>
    {
      using (Scene scene = Small())
      {
        Expect.Throws<InvalidParameterException>(() => scene.Change("gravity.body=Nowhere"));
        var error = Expect.Throws<HaptolithException>(() => scene.Step(new Pose()));
        Expect.Equal(error.Status, Status.InvalidParameter, "status");
        Expect.That(!error.Message.Contains("Nowhere"), error.Message);
      }
    });
    Expect.Test("No name is refused", () => Expect.Equal(
      Expect.Throws<HaptolithException>(() => Scene.FromFile(null)).Status, Status.Null, "status"));
    Expect.Test("A text that C would cut off is refused", () => Expect.Throws<ArgumentException>(() => Scene.FromFile("icra2021\0")));
  }

  static void Moving()
  {
    Expect.Test("Many ticks are as one by one, to the last bit", () =>
    {
      using (Scene one = Small())
      using (Scene many = one.Clone())
      {
        Pose[] poses = Way(one, 200);
        many.PlaceTool(poses[0]);
        Wrench[] felt = new Wrench[poses.Length];
        many.Steps(poses, felt);
        for (int i = 0; i < poses.Length; ++i)
        {
          Expect.Equal(felt[i].Force_N.Z, one.Step(poses[i]).Force_N.Z, "force in tick " + i);
        }
        Expect.Equal(many.StateHash, one.StateHash, "hash");
        Expect.That(one.Felt.Force_N.Z > 0, "the soil pushes up");
      }
    });
    Expect.Test("Poses may lie in memory of somebody else's, as Unity's NativeArray", () =>
    {
      using (Scene pinned = Small())
      using (Scene unmanaged = pinned.Clone())
      {
        Pose[] poses = Way(pinned, 50);
        unmanaged.PlaceTool(poses[0]);
        Pose* own = (Pose*)Marshal.AllocHGlobal(poses.Length * sizeof(Pose));
        for (int i = 0; i < poses.Length; ++i)
        {
          own[i] = poses[i];
        }
        Expect.Equal(unmanaged.Steps(own, null, null, poses.Length), 50L, "ticks done");
        Marshal.FreeHGlobal((IntPtr)own);
        pinned.Steps(poses, null);
        Expect.Equal(unmanaged.StateHash, pinned.StateHash, "hash");
      }
    });
    Expect.Test("A frame's ticks go evenly to the pose", () =>
    {
      using (Scene evenly = Small())
      using (Scene scene = evenly.Clone())
      {
        Pose begin = Pose.At(0, 0, evenly.Info.surface_m + 0.002);
        Pose end = Pose.At(0.001, 0, evenly.Info.surface_m - 0.006);
        end.Orientation = new Quat(Math.Cos(0.05), 0, 0, Math.Sin(0.05));
        evenly.PlaceTool(begin);
        scene.PlaceTool(begin);
        Wrench mean = evenly.MoveTool(end, 16);
        double sum_n = 0;
        for (int tick = 1; tick <= 16; ++tick)
        {
          double share = tick / 16.0;
          Pose to = Pose.At(0.001 * share, 0, begin.Position_m.Z - 0.008 * share);
          to.Orientation = new Quat(Math.Cos(0.05 * share), 0, 0, Math.Sin(0.05 * share));
          sum_n += scene.Step(to).Force_N.Z;
        }
        Expect.That(mean.Force_N.Z > 0.01, "the soil is met: " + mean.Force_N.Z + " N");
        Expect.That(Math.Abs(mean.Force_N.Z - sum_n / 16) < 1e-3 * sum_n, mean.Force_N.Z + " N is " + sum_n / 16 + " N");
        Expect.Near(evenly.ToolPose.Position_m.Z, end.Position_m.Z, "height of the tool");
        Expect.Near(evenly.ToolPose.Orientation.Z, end.Orientation.Z, "turn of the tool");
        Expect.Throws<ArgumentOutOfRangeException>(() => evenly.MoveTool(end, 0));
      }
    });
    Expect.Test("A twist, gravity, an opening, a fade and a change arrive", () =>
    {
      using (Scene scene = Small())
      {
        Pose above = Pose.At(0, 0, scene.Info.surface_m + 0.02);
        scene.PlaceTool(above);
        scene.Step(above, new Twist { Linear_m_s = new Vec3(0, 0, -0.1) });
        scene.SetOpening(0.5);
        scene.SetToolFade(0.5);
        scene.SetGravity(new Vec3(0, 0, -1));
        scene.Step(above);
        hapto_scene_info info = scene.Info;
        Expect.Near(info.tool_fade, 0.5, "fade");
        Expect.Near(info.gravity_m_s2[2], -1, "gravity");
        scene.Change("gravity.body=Mars");
        info = scene.Info;
        Expect.That(info.gravity_m_s2[2] < -3.6, "Mars pulls");
      }
    });
  }

  static void Tools()
  {
    const string two = "[[tools]]\nname = 'left'\n[[tools]]\nname = 'wheel'\nshape = 'cylinder'\njoint_drive = 'speed'\n" +
                       "joint_axis = [0, 0, 1]\njoint_speed_rad_s = 3\n";
    Expect.Test("Several tools are stepped together", () =>
    {
      using (Scene scene = Scene.FromToml(two, new[] { "bed.particles=256" }))
      using (Scene single = Small())
      {
        Expect.Equal(scene.ToolCount, 2, "tools");
        Expect.Equal(scene.ToolName(1), "wheel", "name");
        Expect.Equal(scene.FindTool("left"), 0, "number");
        Expect.Equal(Expect.Throws<InvalidParameterException>(() => scene.FindTool("hoe")).Valid, "one of left, wheel", "valid");
        Pose above = Pose.At(0, 0, scene.Info.surface_m + 0.1);
        Pose[] way = Way(single, 60);
        scene.PlaceTool(way[0]);
        foreach (Pose pose in way)
        {
          Expect.Equal(scene.Step(pose).Force_N.Z, single.Step(pose).Force_N.Z, "the first tool's force with old calls");
        }
        Expect.Equal(scene.ToolState(1).in_soil, 0, "the second is not in the soil");
        Wrench[] felt = new Wrench[2];
        scene.PlaceTool(1, above);
        foreach (Pose pose in way)
        {
          scene.StepTools(new[] { pose, above }, felt);
          Expect.Equal(felt[0].Force_N.Z, single.Step(pose).Force_N.Z, "the first tool's force");
        }
        Expect.That(felt[0].Force_N.Z > 0 && felt[1].Force_N.Z == 0, "only the first is in the soil");
        Expect.Near(scene.ToolState(1).speed_rad_s, 3, "speed of the wheel");
        scene.SetDrive(1, -1);
        scene.SetToolFade(1, 0.5);
        scene.SetOpening(1, 0.5);
        scene.StepTools(new[] { above, above }, null, new Twist[2]);
        Expect.Near(scene.ToolState(1).speed_rad_s, -1, "speed of the wheel");
        ulong hash = scene.StateHash;
        Expect.Throws<ArgumentException>(() => scene.StepTools(new[] { above }, felt));
        Expect.Throws<ArgumentException>(() => scene.StepTools(new[] { above, above }, new Wrench[1]));
        Expect.Equal(Expect.Throws<HaptolithException>(() => scene.ToolState(2)).Status, Status.WrongTool, "status");
        Expect.Equal(Expect.Throws<HaptolithException>(() =>
        {
          Pose one = above;
          scene.StepTools(&one, null, null, 1);
        }).Status, Status.WrongTool, "status");
        Expect.Equal(Expect.Throws<HaptolithException>(() => scene.StepTools(new Pose[2], felt)).Status, Status.InvalidParameter, "status");
        Expect.Equal(scene.StateHash, hash, "nothing has moved:");
      }
    });
  }

  static void Buffers()
  {
    Expect.Test("Positions are copied into a caller's buffer, with either frame's axes", () =>
    {
      using (Scene scene = Small())
      {
        long count = scene.ParticleCount;
        float[] ours = new float[3 * count], unity = new float[3 * count], packed = new float[3 * count];
        Expect.Equal(scene.CopyPositions(ours, Frame.Scene), count, "count");
        Expect.Equal(scene.CopyPositions(unity, Frame.Unity), count, "count");
        fixed (float* to = packed)
        {
          scene.Copy(Field.Position, to, 4 * packed.Length);
        }
        for (long i = 0; i < count; ++i)
        {
          Expect.That(ours[3 * i] == packed[3 * i] && ours[3 * i + 1] == packed[3 * i + 1] && ours[3 * i + 2] == packed[3 * i + 2], "C's copy");
          Vec3 m = UnityFrame.Position(new Vec3(ours[3 * i], ours[3 * i + 1], ours[3 * i + 2]));
          Expect.That(unity[3 * i] == m.X && unity[3 * i + 1] == m.Y && unity[3 * i + 2] == m.Z, "Unity's axes");
        }
        Expect.That(scene.Info.surface_m > 0.01 && Array.Exists(ours, m => m != 0), "there is soil");
      }
    });
    Expect.Test("A buffer that is too small is refused, and nothing is written", () =>
    {
      using (Scene scene = Small())
      {
        float[] little = new float[30];
        Expect.Equal(Expect.Throws<HaptolithException>(() => scene.CopyPositions(little, Frame.Unity)).Status, Status.TooSmall, "status");
        Expect.That(Array.TrueForAll(little, m => m == 0), "nothing is written");
        Expect.Throws<HaptolithException>(() =>
        {
          byte asleep;
          scene.Copy(Field.Asleep, &asleep, 1);
        });
      }
    });
    Expect.Test("Positions can be read where they are", () =>
    {
      using (Scene scene = Small())
      {
        hapto_array view = scene.View(Field.Position);
        float[] copy = new float[3 * view.count];
        scene.CopyPositions(copy, Frame.Scene);
        float* last = (float*)((byte*)view.data + (view.count - 1) * view.stride_bytes);
        Expect.Equal(last[2], copy[copy.Length - 1], "height of the last particle");
      }
    });
  }

  static void States()
  {
    Expect.Test("A state goes on with the same bits", () =>
    {
      using (Scene scene = Small())
      {
        Pose[] way = Way(scene, 100);
        scene.Steps(way, null);
        byte[] state = scene.GetState();
        using (Scene other = Scene.FromState(state))
        {
          scene.Steps(way, null);
          other.Steps(way, null);
          Expect.Equal(other.StateHash, scene.StateHash, "hash");
          scene.SetState(state);
          other.SetState(state);
          Expect.Equal(other.StateHash, scene.StateHash, "hash");
        }
        Expect.Throws<HaptolithException>(() => scene.SetState(new byte[] { 1, 2, 3 }));
        Expect.Throws<HaptolithException>(() => Scene.FromState(null));
      }
    });
  }

  static void Loops()
  {
    Expect.Test("A loop runs on its own thread, is polled, and tells what it feels", () =>
    {
      using (Scene scene = Small("hand.motion=press", "hand.period_s=0.4"))
      using (Loop loop = new Loop(scene, keep_ticks: true))
      {
        Expect.That(!loop.Poll().Running, "it has not begun");
        loop.Start();
        LoopSnapshot now = loop.Poll();
        double strongest_n = 0, strongest_soil_n = 0;
        float[] positions_m = new float[3 * 256];
        Stopwatch clock = Stopwatch.StartNew();
        while (now.Time_s < 0.8 && clock.Elapsed.TotalSeconds < 30)
        {
          Thread.Sleep(16);
          now = loop.Poll();
          strongest_n = Math.Max(strongest_n, now.Felt.Force_N.Z);
          strongest_soil_n = Math.Max(strongest_soil_n, now.SoilWrench.Force_N.Z);
          Expect.Equal(loop.CopyPositions(positions_m, Frame.Unity), now.Particles, "particles of the picture");
        }
        Expect.That(now.Running && now.End == "" && now.Ticks > 700 && now.Particles == 256, "it runs: " + now.Ticks + " ticks");
        Expect.That(strongest_n > 0.1, "the hand felt " + strongest_n + " N");
        Expect.Equal(now.Felt.Force_N.Z, now.DeviceWrench.Force_N.Z, "the virtual hand's frame is the scene's");
        Expect.That(strongest_soil_n > 0.1, "the soil pushed with " + strongest_soil_n + " N");
        Expect.That(positions_m[1] > 0 && now.Scene_T_Tool.Orientation.W > 0.5, "the picture has soil and a tool");
        Expect.Equal(Expect.Throws<HaptolithException>(() => scene.Step(Pose.At(0, 0, 0.3))).Status, Status.Busy, "the scene is the loop's:");
        loop.Change("gravity.body=Earth");
        loop.Pause(true);
        hapto_tick* ticks = stackalloc hapto_tick[8];
        ulong lost;
        Expect.Equal(loop.TakeTicks(ticks, 8, out lost), 8L, "ticks taken");
        Expect.That(ticks[1].time_s > ticks[0].time_s && ticks[0].state_hash != 0, "they are of this loop");
        loop.Stop();
        now = loop.Poll();
        Expect.That(!now.Running && now.End.Length > 0, "it has ended: " + now.End);
        Expect.Equal(now.MissesTooLong + now.MissesWokenLate + now.MissesPreempted, now.DeadlineMisses, "causes of missed deadlines");
        loop.Dispose();
        scene.Step(scene.ToolPose);  // given back
      }
    });
  }

  static void Handles()
  {
    Expect.Test("Disposing twice does no harm", () =>
    {
      Scene scene = Small();
      Loop loop = new Loop(scene);
      loop.Start();
      loop.Dispose();
      loop.Dispose();
      scene.Dispose();
      scene.Dispose();
      Expect.Throws<ObjectDisposedException>(() => scene.Step(Pose.At(0, 0, 0.3)));
      Expect.Throws<ObjectDisposedException>(() => loop.Poll());
      Expect.Throws<ObjectDisposedException>(() => new Loop(scene));
    });
    Expect.Test("A scene that is disposed before its loop lives on until the loop is", () =>
    {
      Scene scene = Small();
      IntPtr address = scene.Handle.DangerousGetHandle();
      using (Loop loop = new Loop(scene))
      {
        scene.Dispose();
        loop.Start();
        Thread.Sleep(20);
        Expect.That(loop.Poll().Running, "the loop runs");
        Expect.Equal(StatusOf(address), Status.Busy, "the scene");
      }
      Expect.Equal(StatusOf(address), Status.Destroyed, "the scene");
    });
    Expect.Test("What nobody disposes the collector gives back, the loop first", () =>
    {
      IntPtr[] forgotten = new IntPtr[1];
      Thread thread = new Thread(() =>
      {
        Scene scene = Small();
        forgotten[0] = scene.Handle.DangerousGetHandle();
        new Loop(scene).Start();
      });
      thread.Start();
      thread.Join();
      for (int i = 0; i < 100 && StatusOf(forgotten[0]) != Status.Destroyed; ++i)
      {
        GC.Collect();
        GC.WaitForPendingFinalizers();
        Thread.Sleep(10);
      }
      Expect.Equal(StatusOf(forgotten[0]), Status.Destroyed, "the scene");
    });
    Expect.Test("A second loop of a scene is refused, and keeps nothing", () =>
    {
      Scene scene = Small();
      IntPtr address = scene.Handle.DangerousGetHandle();
      using (new Loop(scene))
      {
        Expect.Equal(Expect.Throws<HaptolithException>(() => new Loop(scene)).Status, Status.Busy, "status");
      }
      scene.Dispose();
      Expect.Equal(StatusOf(address), Status.Destroyed, "the scene");
    });
  }

  static void Progresses()
  {
    Expect.Test("Soil that settles tells how far it is", () =>
    {
      int told = 0;
      double most = -1;
      using (Scene scene = Scene.FromToml(Rain, null, (what, share) =>
      {
        Expect.That(what.Length > 0, "what is being done");
        ++told;
        most = Math.Max(most, share);
        return true;
      }))
      {
        Expect.That(told > 0 && most <= 1, told + " times, " + most);
        Expect.That(scene.ParticleCount > 100, "there is soil");
      }
    });
    Expect.Test("A progress function can give up", () => Expect.Equal(
      Expect.Throws<HaptolithException>(() => Scene.FromToml(Rain, null, (what, share) => false)).Status, Status.Stopped, "status"));
    Expect.Test("What a progress function throws arrives, and does not go through the library", () => Expect.Equal(
      Expect.Throws<InvalidOperationException>(() => Scene.FromToml(Rain, null, (what, share) =>
      {
        throw new InvalidOperationException("mine");
      })).Message, "mine", "message"));
  }

  static void NoGarbage()
  {
    using (Scene scene = Small())
    using (Scene watched = Small())
    using (Loop loop = new Loop(watched))
    {
      loop.Start();
      Pose above = Pose.At(0, 0, 0.3);
      scene.PlaceTool(above);
      float[] positions_m = new float[3 * scene.ParticleCount];
      Action frame = () =>
      {
        scene.Step(above);
        scene.MoveTool(above, 2);
        scene.CopyPositions(positions_m, Frame.Unity);
        loop.Poll();
        loop.CopyPositions(positions_m, Frame.Unity);
      };
      for (int i = 0; i < 200; ++i)
      {
        frame();
        Thread.Sleep(1);
      }
      GC.Collect();
      int collections = GC.CollectionCount(0);
      long before_bytes = GC.GetTotalMemory(false);
      for (int i = 0; i < 20000; ++i)
      {
        frame();
      }
      long made_bytes = GC.GetTotalMemory(false) - before_bytes;
      Expect.That(made_bytes < 100000 && GC.CollectionCount(0) == collections, made_bytes + " bytes in 20000 frames");
    }
  }

  /// <summary>The scene icra2021 with few particles.</summary>
  static int sweep_ticks;
  static double sweep_turn_rad;
  static Vec3 sweep_sent_n;

  /// <summary>A handle that goes along the scene's x, whose axes are the device's turned by sweep_turn_rad about z.</summary>
  static void ReadSweep(void* user, hapto_device_input* told)
  {
    double x_m = 6e-5 * ++sweep_ticks - 0.012;
    told->pose.position_m[0] = Math.Cos(sweep_turn_rad) * x_m;
    told->pose.position_m[1] = -Math.Sin(sweep_turn_rad) * x_m;
    told->twist.linear_m_s[0] = Math.Cos(sweep_turn_rad) * 0.06;
    told->twist.linear_m_s[1] = -Math.Sin(sweep_turn_rad) * 0.06;
  }

  static void WriteSweep(void* user, hapto_device_output* force)
  {
    sweep_sent_n = *(Vec3*)force->wrench.force_n;
  }

  static void Frames()
  {
    Expect.Test("Each wrench has one frame, whichever way the device is turned", () =>
    {
      hapto_device_read read = ReadSweep;
      hapto_device_write write = WriteSweep;
      foreach (int degrees in new[] { 0, 90, 180 })
      {
        using (Scene scene = Small("mapping.offset_mm=[0, 0, -15]", "mapping.turn_deg=[0, 0, " + degrees + "]"))
        {
          sweep_ticks = 0;
          sweep_turn_rad = degrees * Math.PI / 180;
          hapto_device device = new hapto_device { size = (uint)sizeof(hapto_device) };
          Expect.Equal(Native.hapto_device_limits_init(&device.limits), Native.HAPTO_OK, "limits");
          device.limits.simulated = 1;
          device.read = Marshal.GetFunctionPointerForDelegate(read);
          device.write = Marshal.GetFunctionPointerForDelegate(write);
          IntPtr loop;
          Expect.Equal(Native.hapto_loop_create(scene.Handle.DangerousGetHandle(), &device, Native.HAPTO_LOOP_TICKED_BY_CALLER, &loop), Native.HAPTO_OK, "loop");
          for (int tick = 0; tick < 385; ++tick)  // the first tick, and every 16th after it, is shown
          {
            Expect.Equal(Native.hapto_loop_tick(loop, 0), Native.HAPTO_OK, "tick");
          }
          hapto_snapshot now = new hapto_snapshot { size = (uint)sizeof(hapto_snapshot) };
          Expect.Equal(Native.hapto_loop_snapshot(loop, &now), Native.HAPTO_OK, "snapshot");
          double along_n = now.device_wrench.force_n[0] * Math.Cos(sweep_turn_rad) - now.device_wrench.force_n[1] * Math.Sin(sweep_turn_rad);
          Expect.That(now.soil_wrench.force_n[0] < -0.1, "the soil pushes back along x: " + now.soil_wrench.force_n[0] + " N");
          Expect.That(along_n < -0.1, "so does the device: " + along_n + " N");
          Expect.Equal(now.device_wrench.force_n[0], sweep_sent_n.X, "what the device was sent along its x");
          Expect.Equal(now.device_wrench.force_n[1], sweep_sent_n.Y, "along its y");
          Expect.That(Math.Abs(now.felt.force_n[0] - along_n) < 1e-12, "felt is the same in the scene's axes");
          Native.hapto_loop_destroy(loop);
        }
      }
      GC.KeepAlive(read);
      GC.KeepAlive(write);
    });
  }

  static Scene Small(params string[] overrides)
  {
    return Scene.FromToml("[bed]\nparticles = 256\n", overrides);
  }

  /// <summary>From above the soil into it.</summary>
  static Pose[] Way(Scene scene, int ticks)
  {
    double surface_m = scene.Info.surface_m;
    scene.PlaceTool(Pose.At(0, 0, surface_m + 0.002));
    Pose[] poses = new Pose[ticks];
    for (int i = 0; i < ticks; ++i)
    {
      poses[i] = Pose.At(0, 0, surface_m + 0.002 - 1e-4 * i);
    }
    return poses;
  }

  static Status StatusOf(IntPtr scene)
  {
    hapto_pose pose;
    return (Status)Native.hapto_scene_get_tool_pose(scene, &pose);
  }
}
