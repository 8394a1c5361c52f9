// renameat2(), which emscripten's C library lacks. It detects a file that another process creates at the same moment,
// which cannot happen here.
#pragma once

#include <cstdio>

#define RENAME_NOREPLACE 1U

inline int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned /*flags*/) {
  return renameat(from_folder, from, to_folder, to);
}
