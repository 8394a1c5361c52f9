#include "haptolith/scene_file/toml/toml_writer.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <sstream>

namespace haptolith {

std::string tomlNumber(double value) {
  // Without a point it would be read as a whole number, of which there is but one 0.
  return value == 0 && std::signbit(value) ? "-0.0" : fmt::format("{}", value);
}

std::string tomlText(std::string_view text) {
  std::ostringstream out;
  out << toml::toml_formatter{toml::value<std::string>{std::string(text)}, toml::format_flags::none};
  return out.str();
}

}  // namespace haptolith
