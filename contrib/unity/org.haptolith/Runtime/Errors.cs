using System;

namespace Haptolith
{
  /// <summary>Reasons for a failure.</summary>
  public enum Status
  {
    Ok = Native.HAPTO_OK,
    InvalidParameter = Native.HAPTO_INVALID_PARAMETER,
    Failure = Native.HAPTO_FAILURE,
    Stopped = Native.HAPTO_STOPPED,
    NotFinite = Native.HAPTO_NOT_FINITE,
    Collapsed = Native.HAPTO_COLLAPSED,
    Busy = Native.HAPTO_BUSY,
    Destroyed = Native.HAPTO_DESTROYED,
    Null = Native.HAPTO_NULL,
    WrongSize = Native.HAPTO_WRONG_SIZE,
    TooSmall = Native.HAPTO_TOO_SMALL,
    NoMemory = Native.HAPTO_NO_MEMORY,
    Ended = Native.HAPTO_ENDED,
    WrongTool = Native.HAPTO_WRONG_TOOL
  }

  /// <summary>A failure, with the library's message.</summary>
  public class HaptolithException : Exception
  {
    public HaptolithException(Status status, string message) : base(message)
    {
      Status = status;
    }

    public Status Status { get; private set; }
  }

  /// <summary>An invalid value.</summary>
  public sealed class InvalidParameterException : HaptolithException
  {
    public InvalidParameterException(string message, string key, string value, string valid)
      : base(Status.InvalidParameter, message)
    {
      Key = key;
      Value = value;
      Valid = valid;
    }

    /// <summary>Name of the key: "bed.threads".</summary>
    public string Key { get; private set; }

    /// <summary>The given value.</summary>
    public string Value { get; private set; }

    /// <summary>Valid values: "a whole number, 1 to 256".</summary>
    public string Valid { get; private set; }
  }

  /// <summary>Converts statuses to exceptions.</summary>
  static unsafe class Check
  {
    /// <summary>For functions that store an error message; to be called immediately, on the thread of the call.</summary>
    public static void Require(int status)
    {
      if (status != Native.HAPTO_OK)
      {
        throw Noted(status);
      }
    }

    /// <summary>For functions marked [1 kHz], which report only the status: a stored message belongs to an earlier call.</summary>
    public static void RequireOfTick(int status)
    {
      if (status != Native.HAPTO_OK)
      {
        throw new HaptolithException((Status)status, Text.From(Native.hapto_status_text(status)));
      }
    }

    static HaptolithException Noted(int status)
    {
      hapto_error error = new hapto_error { size = (uint)sizeof(hapto_error) };
      bool noted = Native.hapto_last_error(&error) == Native.HAPTO_OK && error.status == status;
      string message = Text.From(noted ? error.message : Native.hapto_status_text(status));
      if (noted && status == Native.HAPTO_INVALID_PARAMETER)
      {
        return new InvalidParameterException(message, Text.From(error.key), Text.From(error.value), Text.From(error.valid));
      }
      return new HaptolithException((Status)status, message);
    }
  }
}
