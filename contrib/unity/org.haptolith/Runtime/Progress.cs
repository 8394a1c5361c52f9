using System;
using System.Runtime.ExceptionServices;
using System.Runtime.InteropServices;
#if UNITY_5_3_OR_NEWER
using AOT;
#endif

namespace Haptolith
{
  /// <summary>
  /// Told now and then what is being done and how much of it is, 0 to 1, or -1 where that is not known. False gives up.
  /// May come from another thread than the caller's, one at a time.
  /// </summary>
  public delegate bool Progress(string what, double share);

#if !UNITY_5_3_OR_NEWER
  /// <summary>Unity's compiler ahead of time looks for an attribute of this name; elsewhere it says nothing.</summary>
  [AttributeUsage(AttributeTargets.Method)]
  sealed class MonoPInvokeCallbackAttribute : Attribute
  {
    public MonoPInvokeCallbackAttribute(Type type)
    {
    }
  }
#endif

  /// <summary>A progress function as the library calls it: a static function, and a pointer that says which. For the time of a call.</summary>
  sealed unsafe class ProgressCall : IDisposable
  {
    // Nothing else refers to it while the library does.
    static readonly hapto_progress told_function_ = Told;

    readonly Progress progress_;
    GCHandle self_;
    ExceptionDispatchInfo thrown_;

    public ProgressCall(Progress progress)
    {
      progress_ = progress;
      if (progress != null)
      {
        self_ = GCHandle.Alloc(this);
        Function = Marshal.GetFunctionPointerForDelegate(told_function_);
        User = (void*)GCHandle.ToIntPtr(self_);
      }
    }

    /// <summary>NULL without a progress function.</summary>
    public IntPtr Function { get; private set; }

    public void* User { get; private set; }

    /// <summary>What the progress function threw goes on here: it must not go through the library.</summary>
    public void Rethrow()
    {
      if (thrown_ != null)
      {
        thrown_.Throw();
      }
    }

    public void Dispose()
    {
      if (self_.IsAllocated)
      {
        self_.Free();
      }
    }

    [MonoPInvokeCallback(typeof(hapto_progress))]
    static int Told(void* user, byte* what, double share)
    {
      ProgressCall call = (ProgressCall)GCHandle.FromIntPtr((IntPtr)user).Target;
      if (call.thrown_ != null)
      {
        return 0;
      }
      try
      {
        return call.progress_(Text.From(what), share) ? 1 : 0;
      }
      catch (Exception error)
      {
        call.thrown_ = ExceptionDispatchInfo.Capture(error);
        return 0;
      }
    }
  }
}
