#pragma once

#include <nlohmann/json.hpp>

#include <optional>
#include <string>
#include <vector>

#include "haptolith/lab/catalogue/lab_test.h"
#include "haptolith/lab/laboratory.h"
#include "haptolith/lab/report/report_page.h"

namespace haptolith {

/// Result of one test with one friction model and one seed, as far as the page needs it.
struct ReportResult {
  std::vector<Finding> findings;  ///< empty when the test failed
  std::string why_not;            ///< cause of the failure
  double took_s = 0;
};

// Conversions to JSON; the functions below read it back bit-identically.
[[nodiscard]] nlohmann::ordered_json jsonOf(const Finding& finding);
[[nodiscard]] nlohmann::ordered_json jsonOf(const ReportResult& result);

/// @throws nlohmann::json::exception for anything else.
[[nodiscard]] Finding findingFrom(const nlohmann::ordered_json& json);

/// @throws nlohmann::json::exception for anything else.
[[nodiscard]] ReportResult resultFrom(const nlohmann::ordered_json& json);

/// Results of one test with one friction model, one per seed; empty where the test has not been done yet.
using ReportCell = std::vector<std::optional<ReportResult>>;

/// Returns the test's name in the report.
[[nodiscard]] std::string reportName(const LabTest& test);

/// Returns the table rows of one test: its findings, with both models side by side.
[[nodiscard]] std::vector<ReportRow> reportRows(const LabTest& test, const ReportCell& contact,
                                                const ReportCell& icra2021);

}  // namespace haptolith
