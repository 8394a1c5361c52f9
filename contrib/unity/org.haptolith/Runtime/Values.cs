using System.Runtime.InteropServices;

namespace Haptolith
{
  /// <summary>Three numbers; the name of the variable says which, in what unit and in what frame.</summary>
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

  /// <summary>A rotation as a unit quaternion, in C's order.</summary>
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

  /// <summary>Where one frame stands in another: scene_T_tool. Lies in memory as hapto_pose.</summary>
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

    /// <summary>There, and not turned.</summary>
    public static Pose At(double x_m, double y_m, double z_m)
    {
      return new Pose(new Vec3(x_m, y_m, z_m), Quat.Identity);
    }
  }

  /// <summary>How the tool's origin moves. Lies in memory as hapto_twist.</summary>
  [StructLayout(LayoutKind.Sequential)]
  public struct Twist
  {
    public Vec3 Linear_m_s;
    public Vec3 Angular_rad_s;
  }

  /// <summary>Force and torque about a point; where one is given it is said whose and in which frame. Lies in memory as hapto_wrench.</summary>
  [StructLayout(LayoutKind.Sequential)]
  public struct Wrench
  {
    public Vec3 Force_N;
    public Vec3 Torque_Nm;
  }

  /// <summary>What is known of each particle.</summary>
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
