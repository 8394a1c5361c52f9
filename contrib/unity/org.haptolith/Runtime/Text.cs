using System;
using System.Runtime.InteropServices;
using System.Text;

namespace Haptolith
{
  /// <summary>Strings of C: UTF-8, zero-terminated.</summary>
  static unsafe class Text
  {
    public static string From(byte* text)
    {
      if (text == null)
      {
        return string.Empty;
      }
      int length = 0;
      while (text[length] != 0)
      {
        ++length;
      }
      return length == 0 ? string.Empty : Encoding.UTF8.GetString(text, length);
    }

    /// <summary>Returns bytes for a fixed statement; null stays null.</summary>
    public static byte[] Bytes(string text)
    {
      if (text == null)
      {
        return null;
      }
      if (text.IndexOf('\0') >= 0)
      {
        throw new ArgumentException("a text for the library has no zero character in it");
      }
      return Encoding.UTF8.GetBytes(text + '\0');
    }
  }

  /// <summary>A pinned array of strings, for the duration of a call.</summary>
  sealed unsafe class TextList : IDisposable
  {
    readonly byte[][] texts_;
    readonly GCHandle[] pins_;

    public TextList(string[] texts)
    {
      Count = texts == null ? 0 : (uint)texts.Length;
      texts_ = new byte[Count][];
      for (int i = 0; i < Count; ++i)
      {
        texts_[i] = Text.Bytes(texts[i]);
      }
      pins_ = new GCHandle[Count];
      Pointer = (byte**)Marshal.AllocHGlobal((int)(Count + 1) * sizeof(byte*));
      for (int i = 0; i < Count; ++i)
      {
        pins_[i] = GCHandle.Alloc(texts_[i], GCHandleType.Pinned);
        Pointer[i] = (byte*)pins_[i].AddrOfPinnedObject();
      }
    }

    public uint Count { get; private set; }

    public byte** Pointer { get; private set; }

    public void Dispose()
    {
      foreach (GCHandle pin in pins_)
      {
        pin.Free();
      }
      Marshal.FreeHGlobal((IntPtr)Pointer);
    }
  }
}
