using System;
using Haptolith;

/// <summary>The scene's frame and Unity's: what is true in one is true in the other.</summary>
static class FrameTests
{
  static readonly Vec3 right_ = new Vec3(1, 0, 0);
  static readonly Vec3 away_ = new Vec3(0, 1, 0);
  static readonly Vec3 up_ = new Vec3(0, 0, 1);
  static readonly Vec3 unity_right_ = new Vec3(1, 0, 0);
  static readonly Vec3 unity_up_ = new Vec3(0, 1, 0);
  static readonly Vec3 unity_away_ = new Vec3(0, 0, 1);

  public static void Run()
  {
    Expect.Test("Right, away and up are right, away and up", () =>
    {
      Same(UnityFrame.Position(right_), unity_right_);
      Same(UnityFrame.Position(away_), unity_away_);
      Same(UnityFrame.Position(up_), unity_up_);
      Same(UnityFrame.Velocity(new Vec3(1, 2, 3)), new Vec3(1, 3, 2));
    });
    Expect.Test("A force that lifts in the scene lifts in Unity", () => Same(UnityFrame.Force(new Vec3(0, 0, 5)), new Vec3(0, 5, 0)));

    // By hand: seen from above, a quarter turn to the right takes what points away to the right.
    Expect.Test("A turn about up is the same turn", () =>
    {
      Same(Turned(About(up_, -90), away_), right_);
      Same(Turned(About(unity_up_, 90), unity_away_), unity_right_);
      Same(UnityFrame.Rotation(About(up_, -90)), About(unity_up_, 90));
    });
    Expect.Test("A turn about right is the same turn", () =>
    {
      Same(Turned(About(right_, 90), away_), up_);
      Same(Turned(About(unity_right_, -90), unity_away_), unity_up_);
      Same(UnityFrame.Rotation(About(right_, 90)), About(unity_right_, -90));
    });
    Expect.Test("A turn about away is the same turn", () =>
    {
      Same(Turned(About(away_, 90), up_), right_);
      Same(Turned(About(unity_away_, -90), unity_up_), unity_right_);
      Same(UnityFrame.Rotation(About(away_, 90)), About(unity_away_, -90));
    });
    Expect.Test("A point of a tool is where it is, in whatever pose", () => Often(random =>
    {
      Pose pose = new Pose(Any(random), About(Any(random), 360 * random.NextDouble()));
      Vec3 on_tool_m = Any(random);
      Pose in_unity = UnityFrame.Pose(pose);
      Vec3 scene_m = Sum(pose.Position_m, Turned(pose.Orientation, on_tool_m));
      Vec3 unity_m = Sum(in_unity.Position_m, Turned(in_unity.Orientation, UnityFrame.Position(on_tool_m)));
      Same(unity_m, UnityFrame.Position(scene_m));
    }));
    Expect.Test("A torque is r x F in both frames", () => Often(random =>
    {
      Vec3 lever_m = Any(random), force_n = Any(random);
      Same(UnityFrame.Torque(Cross(lever_m, force_n)), Cross(UnityFrame.Position(lever_m), UnityFrame.Force(force_n)));
    }));
    Expect.Test("A point moves with w x r in both frames", () => Often(random =>
    {
      Vec3 rad_s = Any(random), arm_m = Any(random);
      Same(UnityFrame.Velocity(Cross(rad_s, arm_m)), Cross(UnityFrame.AngularVelocity(rad_s), UnityFrame.Position(arm_m)));
    }));
    Expect.Test("There and back is where it was", () => Often(random =>
    {
      Pose pose = new Pose(Any(random), About(Any(random), 70));
      Pose back = UnityFrame.Pose(UnityFrame.Pose(pose));
      Same(back.Position_m, pose.Position_m);
      Same(back.Orientation, pose.Orientation);
      Wrench wrench = new Wrench { Force_N = Any(random), Torque_Nm = Any(random) };
      Same(UnityFrame.Wrench(UnityFrame.Wrench(wrench)).Torque_Nm, wrench.Torque_Nm);
      Twist twist = new Twist { Linear_m_s = Any(random), Angular_rad_s = Any(random) };
      Same(UnityFrame.Twist(UnityFrame.Twist(twist)).Angular_rad_s, twist.Angular_rad_s);
      Same(UnityFrame.Twist(twist).Linear_m_s, UnityFrame.Velocity(twist.Linear_m_s));
      Same(UnityFrame.Wrench(wrench).Force_N, UnityFrame.Force(wrench.Force_N));
    }));
  }

  static void Often(Action<Random> test)
  {
    Random random = new Random(1);
    for (int i = 0; i < 100; ++i)
    {
      test(random);
    }
  }

  static Vec3 Any(Random random)
  {
    return new Vec3(2 * random.NextDouble() - 1, 2 * random.NextDouble() - 1, 2 * random.NextDouble() - 1);
  }

  /// <summary>cos(a/2) and the axis times sin(a/2): so in the scene, and so in Unity, whose axes are left-handed.</summary>
  static Quat About(Vec3 axis, double deg)
  {
    double half = deg * Math.PI / 360;
    double length = Math.Sqrt(axis.X * axis.X + axis.Y * axis.Y + axis.Z * axis.Z);
    double s = Math.Sin(half) / length;
    return new Quat(Math.Cos(half), s * axis.X, s * axis.Y, s * axis.Z);
  }

  static Vec3 Turned(Quat q, Vec3 v)
  {
    Vec3 u = new Vec3(q.X, q.Y, q.Z);
    Vec3 t = Times(2, Cross(u, v));
    return Sum(Sum(v, Times(q.W, t)), Cross(u, t));
  }

  static Vec3 Cross(Vec3 a, Vec3 b)
  {
    return new Vec3(a.Y * b.Z - a.Z * b.Y, a.Z * b.X - a.X * b.Z, a.X * b.Y - a.Y * b.X);
  }

  static Vec3 Sum(Vec3 a, Vec3 b)
  {
    return new Vec3(a.X + b.X, a.Y + b.Y, a.Z + b.Z);
  }

  static Vec3 Times(double k, Vec3 v)
  {
    return new Vec3(k * v.X, k * v.Y, k * v.Z);
  }

  static void Same(Vec3 is_now, Vec3 should_be)
  {
    Expect.That(Math.Abs(is_now.X - should_be.X) + Math.Abs(is_now.Y - should_be.Y) + Math.Abs(is_now.Z - should_be.Z) < 1e-12,
                is_now + " is " + should_be);
  }

  static void Same(Quat is_now, Quat should_be)
  {
    Expect.Near(is_now.W, should_be.W, "w");
    Same(new Vec3(is_now.X, is_now.Y, is_now.Z), new Vec3(should_be.X, should_be.Y, should_be.Z));
  }
}
