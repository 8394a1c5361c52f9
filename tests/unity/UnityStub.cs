// As much of Unity as the package and its sample use, written for this test: it shows that they compile, and what they call.
// Unity itself was not there.
using System;
using System.Collections.Generic;
using System.Runtime.InteropServices;

namespace AOT
{
  [AttributeUsage(AttributeTargets.Method)]
  public sealed class MonoPInvokeCallbackAttribute : Attribute
  {
    public MonoPInvokeCallbackAttribute(Type type)
    {
    }
  }
}

namespace Unity.Collections
{
  public enum Allocator
  {
    Persistent = 4
  }

  public struct NativeArray<T> : IDisposable where T : struct
  {
    internal IntPtr memory_;

    public NativeArray(int length, Allocator allocator)
    {
      Length = length;
      memory_ = Marshal.AllocHGlobal(length * Marshal.SizeOf(typeof(T)));
    }

    public int Length { get; private set; }

    public bool IsCreated
    {
      get { return memory_ != IntPtr.Zero; }
    }

    public T this[int i]
    {
      get { return (T)Marshal.PtrToStructure(memory_ + i * Marshal.SizeOf(typeof(T)), typeof(T)); }
    }

    public void Dispose()
    {
      Marshal.FreeHGlobal(memory_);
      memory_ = IntPtr.Zero;
    }
  }
}

namespace Unity.Collections.LowLevel.Unsafe
{
  public static unsafe class NativeArrayUnsafeUtility
  {
    public static void* GetUnsafePtr<T>(this NativeArray<T> array) where T : struct
    {
      return (void*)array.memory_;
    }
  }
}

namespace UnityEngine
{
  public struct Vector3
  {
    public float x, y, z;

    public Vector3(float x, float y, float z)
    {
      this.x = x;
      this.y = y;
      this.z = z;
    }
  }

  public struct Quaternion
  {
    public float x, y, z, w;

    public Quaternion(float x, float y, float z, float w)
    {
      this.x = x;
      this.y = y;
      this.z = z;
      this.w = w;
    }

    public static Quaternion identity
    {
      get { return new Quaternion(0, 0, 0, 1); }
    }
  }

  /// <summary>Here to be of the same name as the package's.</summary>
  public struct Pose
  {
    public Vector3 position;
    public Quaternion rotation;
  }

  /// <summary>Position and size, for the test.</summary>
  public struct Matrix4x4
  {
    public Vector3 position, scale;

    public static Matrix4x4 TRS(Vector3 position, Quaternion rotation, Vector3 scale)
    {
      return new Matrix4x4 { position = position, scale = scale };
    }

    public static Matrix4x4 operator *(Matrix4x4 a, Matrix4x4 b)
    {
      return b;
    }
  }

  [AttributeUsage(AttributeTargets.Field)]
  public sealed class TooltipAttribute : Attribute
  {
    public TooltipAttribute(string tooltip)
    {
    }
  }

  public class Object
  {
    public static void Destroy(Object it)
    {
    }
  }

  public class Component : Object
  {
    public Transform transform = null;
  }

  public class Transform : Component
  {
    public Vector3 localPosition { get; set; }

    public Quaternion localRotation { get; set; }

    public Matrix4x4 localToWorldMatrix
    {
      get { return new Matrix4x4(); }
    }
  }

  public class MonoBehaviour : Component
  {
    public bool enabled { get; set; }
  }

  public class Mesh : Object
  {
  }

  public class Material : Object
  {
  }

  public class MeshFilter : Component
  {
    public Mesh sharedMesh { get; set; }
  }

  public enum PrimitiveType
  {
    Sphere
  }

  public class GameObject : Object
  {
    public static GameObject CreatePrimitive(PrimitiveType type)
    {
      return new GameObject();
    }

    public T GetComponent<T>() where T : new()
    {
      return new T();
    }
  }

  public static class Graphics
  {
    public static readonly List<Matrix4x4> Drawn = new List<Matrix4x4>();

    public static void DrawMeshInstanced(Mesh mesh, int submesh, Material material, Matrix4x4[] matrices, int count)
    {
      for (int i = 0; i < count; ++i)
      {
        Drawn.Add(matrices[i]);
      }
    }
  }

  public static class Time
  {
    public static float deltaTime = 1f / 60;
  }

  public static class Debug
  {
    public static readonly List<string> Errors = new List<string>();

    public static void LogError(object message, Object context)
    {
      Errors.Add(message.ToString());
    }
  }

  public static class Mathf
  {
    public static int RoundToInt(float value)
    {
      return (int)Math.Round(value);
    }

    public static int Clamp(int value, int lowest, int highest)
    {
      return Math.Min(highest, Math.Max(lowest, value));
    }

    public static int Min(int a, int b)
    {
      return Math.Min(a, b);
    }
  }
}
