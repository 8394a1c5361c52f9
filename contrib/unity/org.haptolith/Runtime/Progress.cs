using System;
using System.Runtime.ExceptionServices;
using System.Runtime.InteropServices;
#if UNITY_5_3_OR_NEWER
using AOT;
#endif

namespace Haptolith
{
  /// <summary>
  /// Receives the name of the current work and its completed fraction, 0 to 1, or -1 if unknown. Returning false cancels.
/// Called from any thread, by one at a time.
  /// </summary>
  public delegate bool Progress(string what, double share);

#if !UNITY_5_3_OR_NEWER
  /// <summary>Unity's ahead-of-time compiler needs an attribute of this name; elsewhere it has no effect.</summary>
  [AttributeUsage(AttributeTargets.Method)]
  sealed class MonoPInvokeCallbackAttribute : Attribute
  {
    public MonoPInvokeCallbackAttribute(Type type)
    {
    }
  }
#endif

  /// <summary>A progress function for the library: a static function and a pointer to its target, for the duration of a call.</summary>
  sealed unsafe class ProgressCall : IDisposable
  {
    // Keeps the object alive while the library refers to it.
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

    /// <summary>Function pointer for the library; NULL without a progress function.</summary>
    public IntPtr Function { get; private set; }

    public void* User { get; private set; }

    /// <summary>Rethrows the exception of the progress function, which must not pass through the library.</summary>
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
