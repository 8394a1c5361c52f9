#pragma once

#include <CLI/App.hpp>
#include <CLI/Formatter.hpp>

#include <string>

namespace haptolith {

/// Prints the valid values and the default of every option: "--friction contact|paper", "--threads N ... 1 to 256
/// [all]". CLI11 would print ENUM, TEXT or FLOAT and "=1". An option_text() of an option is kept.
class HelpFormatter final : public CLI::Formatter {
 public:
  std::string make_option_opts(const CLI::Option* option) const override;
  std::string make_option_desc(const CLI::Option* option) const override;
};

}  // namespace haptolith
