#pragma once

#include <nlohmann/json.hpp>

#include <optional>
#include <string>
#include <vector>

#include "haptolith/lab/catalogue/lab_test.h"
#include "haptolith/lab/laboratory.h"
#include "haptolith/lab/report/report_page.h"

namespace haptolith {

/// What one test gave with one model of friction and one seed, as far as the page needs it.
struct ReportResult {
  std::vector<Finding> findings;  ///< none when the test failed outright
  std::string why_not;            ///< then
  double took_s = 0;
};

// As JSON, which the functions below read back to the last bit.
[[nodiscard]] nlohmann::ordered_json jsonOf(const Finding& finding);
[[nodiscard]] nlohmann::ordered_json jsonOf(const ReportResult& result);

/// @throws nlohmann::json::exception for anything else.
[[nodiscard]] Finding findingFrom(const nlohmann::ordered_json& json);

/// @throws nlohmann::json::exception for anything else.
[[nodiscard]] ReportResult resultFrom(const nlohmann::ordered_json& json);

/// One test with one model of friction: a place for each seed, empty where the test has not been done yet.
using ReportCell = std::vector<std::optional<ReportResult>>;

/// The test's name in the report.
[[nodiscard]] std::string reportName(const LabTest& test);

/// The rows of one test in the table: its findings, both models side by side.
[[nodiscard]] std::vector<ReportRow> reportRows(const LabTest& test, const ReportCell& contact,
                                                const ReportCell& paper);

}  // namespace haptolith
