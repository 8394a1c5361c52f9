using System;
using System.Diagnostics;
using Haptolith;

/// <summary>
/// Program.exe hash | dig     prints what examples/c/state_hash.c and dig.c print.
/// Program.exe tests HASH     runs the tests; HASH is what state_hash.c has printed.
/// Program.exe cost           prints the cost of a step through C#.
/// </summary>
static unsafe class Program
{
  static int Main(string[] arguments)
  {
    switch (arguments[0])
    {
      case "hash":
        Console.WriteLine(LibraryTests.StateHash());
        return 0;
      case "dig":
        Console.Write(LibraryTests.Dig());
        return 0;
      case "cost":
        Cost();
        return 0;
      default:
        FrameTests.Run();
        LibraryTests.Run();
        ReloadTests.Run(arguments[1]);
        return Expect.Failures == 0 ? 0 : 1;
    }
  }

  /// <summary>Medians of interleaved rounds, of a scene that is asleep: the call alone.</summary>
  static void Cost()
  {
    const int rounds = 15, count = 20000;
    double[] in_c_us = new double[rounds], step_us = new double[rounds];
    Pose[] poses = new Pose[count];
    for (int i = 0; i < count; ++i)
    {
      poses[i] = Pose.At(0, 0, 0.3);
    }
    using (Scene scene = Scene.FromToml("[bed]\nparticles = 16\nlayers = 1\n"))
    {
      scene.Steps(poses, null);
      for (int round = 0; round < rounds; ++round)
      {
        in_c_us[round] = Took(() => scene.Steps(poses, null)) / count;
        step_us[round] = Took(() =>
        {
          for (int i = 0; i < count; ++i)
          {
            scene.Step(poses[i]);
          }
        }) / count;
      }
    }
    Array.Sort(in_c_us);
    Array.Sort(step_us);
    Console.WriteLine("Steps (in C)  {0:F3} us\nStep          {1:F3} us  +{2:F3} us", in_c_us[rounds / 2], step_us[rounds / 2],
                      step_us[rounds / 2] - in_c_us[rounds / 2]);
  }

  static double Took(Action action)
  {
    Stopwatch clock = Stopwatch.StartNew();
    action();
    return clock.Elapsed.TotalMilliseconds * 1e3;
  }
}
