using System;
using System.Runtime.InteropServices;

namespace Haptolith
{
  /// <summary>Owns a hapto_scene. The runtime destroys it when it unloads this code, or earlier.</summary>
  public sealed class SceneHandle : SafeHandle
  {
    internal SceneHandle(IntPtr scene) : base(IntPtr.Zero, true)
    {
      SetHandle(scene);
    }

    public override bool IsInvalid
    {
      get { return handle == IntPtr.Zero; }
    }

    protected override bool ReleaseHandle()
    {
      return Native.hapto_scene_destroy(handle) == Native.HAPTO_OK;
    }
  }

  /// <summary>Owns a hapto_loop, and keeps its scene alive.</summary>
  public sealed class LoopHandle : SafeHandle
  {
    readonly SceneHandle scene_;

    /// <summary>DangerousAddRef() of the scene has already been called.</summary>
    internal LoopHandle(IntPtr loop, SceneHandle scene) : base(IntPtr.Zero, true)
    {
      scene_ = scene;
      SetHandle(loop);
    }

    public override bool IsInvalid
    {
      get { return handle == IntPtr.Zero; }
    }

    protected override bool ReleaseHandle()
    {
      int status = Native.hapto_loop_destroy(handle);
      scene_.DangerousRelease();
      return status == Native.HAPTO_OK;
    }
  }

  /// <summary>A handle for the duration of a call, protected from destruction. Throws ObjectDisposedException if it is destroyed.</summary>
  struct Borrowed : IDisposable
  {
    public readonly IntPtr Address;
    readonly SafeHandle handle_;

    public Borrowed(SafeHandle handle)
    {
      bool added = false;
      handle.DangerousAddRef(ref added);
      handle_ = handle;
      Address = handle.DangerousGetHandle();
    }

    public void Dispose()
    {
      handle_.DangerousRelease();
    }
  }
}
