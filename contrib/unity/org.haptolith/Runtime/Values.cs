using System.Runtime.InteropServices;

namespace Haptolith
{
  /// <summary>Three numbers; quantity, unit and frame are in the variable's name.</summary>
  [StructLayout(LayoutKind.Sequential)]
  public struct Vec3
  {
    public double X, Y, Z;

    public Vec3(double x, double y, double z)
    {
      X = x;
      Y = y;
      Z = z;
    }

    public override string ToString()
    {
      return "(" + X + ", " + Y + ", " + Z + ")";
    }
  }

  /// <summary>A rotation as a unit quaternion, in the order of C.</summary>
  [StructLayout(LayoutKind.Sequential)]
  public struct Quat
  {
    public double W, X, Y, Z;

    public Quat(double w, double x, double y, double z)
    {
      W = w;
      X = x;
      Y = y;
      Z = z;
    }

    public static Quat Identity
    {
      get { return new Quat(1, 0, 0, 0); }
    }

    public override string ToString()
    {
      return "(w " + W + ", " + X + ", " + Y + ", " + Z + ")";
    }
  }

  /// <summary>Pose of one frame in another: scene_T_tool. Has the memory layout of hapto_pose.</summary>
  [StructLayout(LayoutKind.Sequential)]
  public struct Pose
  {
    public Vec3 Position_m;
    public Quat Orientation;

    public Pose(Vec3 position_m, Quat orientation)
    {
      Position_m = position_m;
      Orientation = orientation;
    }

    /// <summary>Pose at a position, without rotation.</summary>
    public static Pose At(double x_m, double y_m, double z_m)
    {
      return new Pose(new Vec3(x_m, y_m, z_m), Quat.Identity);
    }
  }

  /// <summary>Velocities at the tool's origin. Has the memory layout of hapto_twist.</summary>
  [StructLayout(LayoutKind.Sequential)]
  public struct Twist
  {
    public Vec3 Linear_m_s;
    public Vec3 Angular_rad_s;
  }

  /// <summary>Force and torque about a point; each use documents the point and the frame. Has the memory layout of hapto_wrench.</summary>
  [StructLayout(LayoutKind.Sequential)]
  public struct Wrench
  {
    public Vec3 Force_N;
    public Vec3 Torque_Nm;
  }

  /// <summary>Data of each particle.</summary>
  public enum Field
  {
    Position = Native.HAPTO_POSITION,
    Velocity = Native.HAPTO_VELOCITY,
    Radius = Native.HAPTO_RADIUS,
    Asleep = Native.HAPTO_ASLEEP,
    Held = Native.HAPTO_HELD,
    ContactLoad = Native.HAPTO_CONTACT_LOAD
  }
}
