using System;
using System.Collections.Generic;

/// <summary>Runs tests, each a sentence and its check, and reports failures.</summary>
static class Expect
{
  static readonly List<string> failed_ = new List<string>();

  public static int Failures
  {
    get { return failed_.Count; }
  }

  public static void Test(string sentence, Action test)
  {
    try
    {
      test();
      Console.WriteLine("ok      " + sentence);
    }
    catch (Exception error)
    {
      failed_.Add(sentence);
      Console.WriteLine("FAILED  " + sentence + "\n" + error);
    }
  }

  public static void That(bool holds, string what)
  {
    if (!holds)
    {
      throw new Exception("does not hold: " + what);
    }
  }

  public static void Equal<T>(T is_now, T should_be, string what)
  {
    That(EqualityComparer<T>.Default.Equals(is_now, should_be), what + " is " + is_now + ", not " + should_be);
  }

  public static void Near(double is_now, double should_be, string what)
  {
    That(Math.Abs(is_now - should_be) < 1e-9, what + " is " + is_now + ", not " + should_be);
  }

  public static E Throws<E>(Action what) where E : Exception
  {
    try
    {
      what();
    }
    catch (E error)
    {
      return error;
    }
    throw new Exception("nothing of " + typeof(E).Name + " was thrown");
  }
}
