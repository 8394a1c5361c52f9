#include <CLI/CLI.hpp>

int main(int argc, char** argv) {
  CLI::App app{"haptolith: lunar and planetary regolith, felt through a haptic device at 1 kHz"};
  CLI11_PARSE(app, argc, argv);
  return 0;
}
