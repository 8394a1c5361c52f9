// Suppresses leaks of third-party libraries, which must not fail the program under the address sanitizer. Only the
// sanitizer calls this function.

extern "C" [[gnu::visibility("default")]] const char* __lsan_default_suppressions();  // NOLINT: the sanitizer's name
extern "C" const char* __lsan_default_suppressions() {                                // NOLINT
  return "leak:spnav\nleak:libhdf5\nleak:libSDL2\nleak:libX11\nleak:libdbus\n";
}
