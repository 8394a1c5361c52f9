#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/lab/laboratory.h"

namespace haptolith {

/// Result of one friction model in one test.
struct ReportValue {
  std::string text;                ///< value with unit and uncertainty
  std::optional<Verdict> verdict;  ///< empty: not simulated yet
};

/// One line of the report's table.
struct ReportRow {
  std::string test;
  std::string measured;  ///< description of the quantity
  std::string target;    ///< target with its source
  ReportValue contact;   ///< result of FrictionModel::kContact
  ReportValue icra2021;  ///< result of FrictionModel::kIcra2021
};

/// One condition of the tests, for example {"Gravity", "1.625 m/s^2"}.
struct ReportFact {
  std::string name;
  std::string value;
};

/// Figure in an .svg or .png file, which is copied into the page.
struct ReportFigure {
  std::filesystem::path file;
  std::string caption;
};

/// Content of the page, in this order. Texts are plain: HTML in them is escaped.
struct ReportPage {
  std::string title;
  std::vector<std::string> introduction{};  ///< paragraphs
  std::vector<ReportFact> facts{};
  std::vector<ReportRow> rows{};
  std::vector<ReportFigure> figures{};
};

/// Escapes `text` for HTML content and quoted attributes.
[[nodiscard]] std::string htmlEscaped(std::string_view text);

/// Returns the page as one self-contained HTML document: figures are embedded, there are no scripts, and it follows the
/// reader's choice of light or dark mode. Equal pages give identical bytes.
/// @throws InvalidParameter when a figure is neither .svg nor .png; Failure when it cannot be read. Not for the tick.
[[nodiscard]] std::string reportHtml(const ReportPage& page);

/// Writes reportHtml() to a file atomically.
/// @throws as reportHtml() and AtomicFile.
void saveReport(const OutputFile& path, const ReportPage& page);

}  // namespace haptolith
