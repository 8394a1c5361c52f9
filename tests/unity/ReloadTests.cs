using System;
using System.IO;
using System.Threading;
using Haptolith;

/// <summary>Lives in a separate domain, as a script does between two reloads of Unity's editor.</summary>
sealed class Script : MarshalByRefObject
{
  static Scene scene_;
  static Loop loop_;

  /// <summary>Leaves a scene and a running loop behind, and returns their addresses.</summary>
  public long[] Play()
  {
    scene_ = Scene.FromToml("[bed]\nparticles = 256\n");
    loop_ = new Loop(scene_);
    loop_.Start();
    while (loop_.Poll().Ticks < 20)
    {
      Thread.Sleep(1);
    }
    return new[] { scene_.Handle.DangerousGetHandle().ToInt64(), loop_.Handle.DangerousGetHandle().ToInt64() };
  }

  public string StateHash()
  {
    return LibraryTests.StateHash();
  }

  /// <summary>A progress function of this domain's.</summary>
  public int TimesTold()
  {
    int told = 0;
    Scene.FromToml(LibraryTests.Rain, null, (what, share) => ++told > 0).Dispose();
    return told;
  }
}

/// <summary>Unity's editor loads changed scripts in a new AppDomain, and the native library stays: so does mono.</summary>
static unsafe class ReloadTests
{
  public static void Run(string hash_of_c)
  {
    Expect.Test("A domain that is unloaded takes its scene and its running loop with it, three times", () =>
    {
      int threads_before = Threads();
      for (int i = 0; i < 3; ++i)
      {
        long[] left = null;
        InDomain(script => left = script.Play());
        hapto_pose pose;
        Expect.Equal((Status)Native.hapto_loop_pause((IntPtr)left[1], 1), Status.Destroyed, "the loop");
        Expect.Equal((Status)Native.hapto_scene_get_tool_pose((IntPtr)left[0], &pose), Status.Destroyed, "the scene");
      }
      for (int i = 0; i < 200 && Threads() > threads_before + 1; ++i)
      {
        Thread.Sleep(10);
      }
      Expect.That(Threads() <= threads_before + 1, Threads() + " threads, and " + threads_before + " before");
    });
    Expect.Test("After a reload the same scene gives the same hash as C", () =>
    {
      InDomain(script => Expect.Equal(script.StateHash(), hash_of_c, "hash"));
      InDomain(script => Expect.Equal(script.StateHash(), hash_of_c, "hash"));
      Expect.Equal(LibraryTests.StateHash(), hash_of_c, "hash");
    });
    Expect.Test("A progress function of a domain that is gone is not called any more", () =>
    {
      InDomain(script => Expect.That(script.TimesTold() > 0, "told"));
      InDomain(script => Expect.That(script.TimesTold() > 0, "told"));
      Expect.That(new Script().TimesTold() > 0, "told");
    });
  }

  static void InDomain(Action<Script> play)
  {
    AppDomain domain = AppDomain.CreateDomain("scripts");
    play((Script)domain.CreateInstanceAndUnwrap(typeof(Script).Assembly.FullName, typeof(Script).FullName));
    AppDomain.Unload(domain);
  }

  static int Threads()
  {
    return Directory.GetDirectories("/proc/self/task").Length;
  }
}
