#pragma once

#ifndef NDEBUG
#include <cstdio>
#include <cstdlib>
#endif

/// Checks what the code relies on, in debug and sanitizer builds: prints the condition with its place and aborts. A
/// release build does not evaluate it, so it may stand in the tick. Not for input: that is refused with a message.
#ifdef NDEBUG
#define HAPTO_ASSERT(condition) static_cast<void>(sizeof((condition) ? 1 : 0))
#else
#define HAPTO_ASSERT(condition) \
  (static_cast<bool>(condition) \
       ? static_cast<void>(0)   \
       : static_cast<void>(     \
             (std::fprintf(stderr, "%s:%d: not true: %s\n", __FILE__, __LINE__, #condition), std::abort())))
#endif
