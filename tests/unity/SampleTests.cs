using System.Reflection;
using System.Threading;
using Haptolith;
using UnityEngine;

/// <summary>The package's sample, called as Unity would call it, with a mock of Unity.</summary>
static class SampleTests
{
  static int Main()
  {
    Expect.Test("The sample shows the soil, and the tool where the scene's hand has it", () =>
    {
      BedAndTool sample = Sample(false);
      Call(sample, "OnEnable");
      Vector3 began_m = sample.Tool.localPosition;
      for (int frame = 0; frame < 600 && Same(sample.Tool.localPosition, began_m); ++frame)
      {
        Graphics.Drawn.Clear();
        Call(sample, "Update");
        Thread.Sleep(16);
      }
      Expect.That(!Same(sample.Tool.localPosition, began_m), "the tool moves");
      Expect.Equal(Graphics.Drawn.Count, 256, "grains drawn");
      Matrix4x4 grain = Graphics.Drawn[0];
      Expect.That(grain.position.y > 0 && grain.position.y < 0.1 && grain.scale.x > 0.001, "a grain lies above the floor, at y = " + grain.position.y);
      Call(sample, "OnDisable");
      Call(sample, "OnDisable");
      Expect.Equal(Debug.Errors.Count, 0, "errors");
    });
    Expect.Test("The sample's tool goes where its object is, and feels the soil push up", () =>
    {
      BedAndTool sample = Sample(true);
      Call(sample, "OnEnable");
      for (int frame = 0; frame < 60; ++frame)
      {
        Vector3 at_m = sample.Tool.localPosition;
        at_m.y -= 0.0015f;
        sample.Tool.localPosition = at_m;
        Call(sample, "Update");
      }
      Expect.That(sample.Force_N.y > 0.1, "up is y: " + sample.Force_N.y + " N");
      Call(sample, "OnDisable");
      Call(sample, "OnEnable");  // as after a reload
      Call(sample, "Update");
      Expect.Equal(Debug.Errors.Count, 0, "errors");
      sample.Tool.localPosition = new Vector3(1000, 0, 0);
      Call(sample, "Update");
      Expect.That(Debug.Errors.Count == 1 && !sample.enabled, "what is wrong is told, once");
      Call(sample, "OnDisable");
    });
    return Expect.Failures == 0 ? 0 : 1;
  }

  static BedAndTool Sample(bool moved_in_unity)
  {
    return new BedAndTool
    {
      transform = new Transform(),
      enabled = true,
      Tool = new Transform(),
      ToolIsMovedInUnity = moved_in_unity,
      Overrides = new[] { "bed.particles=256", "hand.motion=press" }
    };
  }

  static void Call(BedAndTool sample, string name)
  {
    typeof(BedAndTool).GetMethod(name, BindingFlags.Instance | BindingFlags.NonPublic).Invoke(sample, null);
  }

  static bool Same(Vector3 a, Vector3 b)
  {
    return a.x == b.x && a.y == b.y && a.z == b.z;
  }
}
