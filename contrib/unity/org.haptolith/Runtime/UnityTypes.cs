// Overloads with Unity's types, for scripts in Unity; not compiled elsewhere.
#if UNITY_5_3_OR_NEWER
using Unity.Collections;
using Unity.Collections.LowLevel.Unsafe;
using UnityEngine;

namespace Haptolith
{
  public static unsafe partial class UnityFrame
  {
    public static Vector3 ToUnityPosition(Vec3 scene_m)
    {
      return ToVector3(Position(scene_m));
    }

    public static Vector3 ToUnityForce(Vec3 scene_n)
    {
      return ToVector3(Force(scene_n));
    }

    public static Vector3 ToUnityTorque(Vec3 scene_nm)
    {
      return ToVector3(Torque(scene_nm));
    }

    public static Quaternion ToUnityRotation(Quat scene)
    {
      Quat q = Rotation(scene);
      return new Quaternion((float)q.X, (float)q.Y, (float)q.Z, (float)q.W);
    }

    public static Pose FromUnity(Vector3 position_m, Quaternion rotation)
    {
      return Pose(new Pose(new Vec3(position_m.x, position_m.y, position_m.z),
                           new Quat(rotation.w, rotation.x, rotation.y, rotation.z)));
    }

    /// <summary>Copies the centres of the particles in Unity's frame, m. Returns the number of particles.</summary>
    public static int CopyPositions(this Scene scene, NativeArray<Vector3> into)
    {
      return (int)scene.CopyPositions((float*)into.GetUnsafePtr(), into.Length, Frame.Unity);
    }

    /// <summary>Copies the centres of the last Poll() in Unity's frame, m. Returns the number of particles.</summary>
    public static int CopyPositions(this Loop loop, NativeArray<Vector3> into)
    {
      return (int)loop.CopyPositions((float*)into.GetUnsafePtr(), into.Length, Frame.Unity);
    }

    static Vector3 ToVector3(Vec3 v)
    {
      return new Vector3((float)v.X, (float)v.Y, (float)v.Z);
    }
  }
}
#endif
