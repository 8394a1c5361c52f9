// What other people's libraries leak is not ours to mend: under the address sanitizer it must not fail the program.
// Nobody calls this otherwise.

extern "C" [[gnu::visibility("default")]] const char* __lsan_default_suppressions();  // NOLINT: the sanitizer's name
extern "C" const char* __lsan_default_suppressions() {                                // NOLINT
  return "leak:spnav\nleak:libhdf5\nleak:libSDL2\nleak:libX11\nleak:libdbus\n";
}
