#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/lab/laboratory.h"

namespace haptolith {

/// What one model of friction gave in one test.
struct ReportValue {
  std::string text;                ///< with unit and uncertainty
  std::optional<Verdict> verdict;  ///< none: not measured yet
};

/// One line of the report's table.
struct ReportRow {
  std::string test;
  std::string measured;  ///< what is measured, in words
  std::string target;    ///< with its source
  ReportValue contact;   ///< FrictionModel::kContact
  ReportValue paper;     ///< FrictionModel::kPaper
};

/// How the tests were run, for example {"Gravity", "1.625 m/s^2"}.
struct ReportFact {
  std::string name;
  std::string value;
};

/// A picture in an .svg or .png file, which is copied into the page.
struct ReportFigure {
  std::filesystem::path file;
  std::string caption;
};

/// All that stands on the page, in this order. Texts are plain: what looks like HTML is shown as it is.
struct ReportPage {
  std::string title;
  std::vector<std::string> introduction{};  ///< paragraphs
  std::vector<ReportFact> facts{};
  std::vector<ReportRow> rows{};
  std::vector<ReportFigure> figures{};
};

/// `text` as it must be written between tags and in quoted attributes.
[[nodiscard]] std::string htmlEscaped(std::string_view text);

/// The page as one HTML document that needs no other file: figures are inside, there are no scripts, and it follows the
/// reader's choice of light or dark. The same page gives the same bytes.
/// @throws InvalidParameter when a figure is neither .svg nor .png; Failure when it cannot be read. Not for the tick.
[[nodiscard]] std::string reportHtml(const ReportPage& page);

/// Writes reportHtml() to a file that appears whole or not at all.
/// @throws as reportHtml() and AtomicFile.
void saveReport(const OutputFile& path, const ReportPage& page);

}  // namespace haptolith
