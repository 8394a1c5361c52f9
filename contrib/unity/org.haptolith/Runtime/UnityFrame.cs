namespace Haptolith
{
  /// <summary>Frame of a copy of positions.</summary>
  public enum Frame
  {
    /// <summary>The library's frame: right-handed, z up.</summary>
    Scene,

    /// <summary>Unity's frame: left-handed, y up.</summary>
    Unity
  }

  /// <summary>
  /// Conversion between the scene's frame (right-handed, x right, y away, z up) and Unity's (left-handed, x right, y up, z away).
/// Unity's y is the scene's z, and vice versa. This is a reflection, so each function is its own inverse.
/// Polar vectors are reflected: positions, velocities, forces. Axial quantities also change their sign: rotations, angular
/// velocities, torques. So r x F is the torque in both frames.
  /// </summary>
  public static unsafe partial class UnityFrame
  {
    public static Vec3 Position(Vec3 m)
    {
      return Mirrored(m);
    }

    public static Vec3 Velocity(Vec3 m_s)
    {
      return Mirrored(m_s);
    }

    public static Vec3 Force(Vec3 n)
    {
      return Mirrored(n);
    }

    public static Vec3 Torque(Vec3 nm)
    {
      return MirroredAxis(nm);
    }

    public static Vec3 AngularVelocity(Vec3 rad_s)
    {
      return MirroredAxis(rad_s);
    }

    public static Quat Rotation(Quat q)
    {
      Vec3 axis = MirroredAxis(new Vec3(q.X, q.Y, q.Z));
      return new Quat(q.W, axis.X, axis.Y, axis.Z);
    }

    public static Pose Pose(Pose pose)
    {
      return new Pose(Position(pose.Position_m), Rotation(pose.Orientation));
    }

    public static Twist Twist(Twist twist)
    {
      return new Twist { Linear_m_s = Velocity(twist.Linear_m_s), Angular_rad_s = AngularVelocity(twist.Angular_rad_s) };
    }

    public static Wrench Wrench(Wrench wrench)
    {
      return new Wrench { Force_N = Force(wrench.Force_N), Torque_Nm = Torque(wrench.Torque_Nm) };
    }

    /// <summary>Packs vectors with a spacing of stride_bytes into consecutive x y z, in the given frame.</summary>
    internal static void Copy(hapto_array positions, float* xyz, Frame frame)
    {
      int second = frame == Frame.Unity ? 2 : 1;
      int third = frame == Frame.Unity ? 1 : 2;
      byte* from = (byte*)positions.data;
      for (ulong i = 0; i < positions.count; ++i)
      {
        float* one = (float*)from;
        xyz[0] = one[0];
        xyz[1] = one[second];
        xyz[2] = one[third];
        xyz += 3;
        from += positions.stride_bytes;
      }
    }

    static Vec3 Mirrored(Vec3 v)
    {
      return new Vec3(v.X, v.Z, v.Y);
    }

    static Vec3 MirroredAxis(Vec3 v)
    {
      return new Vec3(-v.X, -v.Z, -v.Y);
    }
  }
}
