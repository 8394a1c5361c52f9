// What emscripten's C library lacks of Linux: it is asked for a file that somebody made at the same moment, and here
// nobody does.
#pragma once

#include <cstdio>

#define RENAME_NOREPLACE 1U

inline int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned /*flags*/) {
  return renameat(from_folder, from, to_folder, to);
}
