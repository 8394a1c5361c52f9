#pragma once

#include <CLI/App.hpp>
#include <CLI/Formatter.hpp>

#include <string>

namespace haptolith {

/// Says of every option what its user is to write and what is taken otherwise: "--friction contact|paper", "--threads N
/// ... 1 to 256 [all]", for CLI11 would say ENUM, TEXT or FLOAT and "=1". An option_text() of an option's own stays.
class HelpFormatter final : public CLI::Formatter {
 public:
  std::string make_option_opts(const CLI::Option* option) const override;
  std::string make_option_desc(const CLI::Option* option) const override;
};

}  // namespace haptolith
