using System;

namespace Haptolith
{
  /// <summary>The shared library itself.</summary>
  public static unsafe class Library
  {
    /// <summary>The library's version, "0.2.0".</summary>
    public static string Version
    {
      get
      {
        RequireSameVersion();
        return Text.From(Native.hapto_version_string());
      }
    }

    /// <summary>Lists the available "scenes", "soils", "presets", "bodies", "lab tests" or "instruction set", as JSON.</summary>
    public static string List(string what)
    {
      RequireSameVersion();
      fixed (byte* name = Text.Bytes(what))
      {
        IntPtr result;
        Check.Require(Native.hapto_list(name, &result));
        byte* json;
        int status = Native.hapto_result_json(result, &json);
        string text = status == Native.HAPTO_OK ? Text.From(json) : null;
        Native.hapto_result_destroy(result);
        Check.Require(status);
        return text;
      }
    }

    /// <summary>For versions 0.x, the layout of structs may change with the minor version.</summary>
    internal static void RequireSameVersion()
    {
      uint version;
      try
      {
        version = Native.hapto_version();
      }
      catch (DllNotFoundException error)
      {
        throw new DllNotFoundException(
          "libhaptolith.so, or a library that it needs, is not found: see Plugins/x86_64/README.md of this package", error);
      }
      if (version / 1000 != Native.HeaderVersion)
      {
        throw new HaptolithException(Status.WrongSize,
          "libhaptolith.so is version " + Text.From(Native.hapto_version_string()) + ", this package is for "
          + Native.HeaderVersion / 1000 + "." + Native.HeaderVersion % 1000);
      }
    }
  }
}
