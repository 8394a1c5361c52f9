#include "haptolith/lab/archive/report_results.h"

#include <fmt/format.h>

#include <cstddef>
#include <limits>

#include "haptolith/core/error.h"
#include "haptolith/lab/report/specimen_statistics.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

// JSON has no infinity and no NaN: they are written as null.

double numberOr(const Json& json, double otherwise) {
  return json.is_null() ? otherwise : json.get<double>();
}

/// Returns finding `i` of one model, over the seeds that are done.
ReportValue valueOf(const ReportCell& cell, std::size_t i, const Finding& wanted) {
  std::vector<Finding> specimens;
  std::string why_not;
  std::size_t done = 0, failed = 0;
  for (const auto& result : cell) {
    done += result ? 1 : 0;
    if (result && i < result->findings.size()) {
      specimens.push_back(result->findings[i]);
    } else if (result) {
      ++failed;
      why_not = result->why_not;
    }
  }
  if (done == 0) {
    return {"not measured yet", {}};
  }
  const Verdict failing = wanted.accepted ? Verdict::kFail : Verdict::kInfo;
  ReportValue value = specimens.empty() ? ReportValue{why_not, failing} : overSeeds(specimens);
  if (failed > 0 && !specimens.empty()) {
    value.text += fmt::format("; failed with {} of {} seeds: {}", failed, done, why_not);
    value.verdict = failing;
  }
  if (done < cell.size()) {
    value.text += fmt::format(" ({} of {} seeds so far)", done, cell.size());
  }
  return value;
}

}  // namespace

Json jsonOf(const Finding& finding) {
  Json json{{"measured", finding.measured},
            {"target", finding.target},
            {"number", finding.number},
            {"unit", finding.unit},
            {"decimals", finding.decimals}};
  if (finding.accepted) {
    json["accepted"] = {{"lowest", finding.accepted->lowest},
                        {"highest", finding.accepted->highest},
                        {"ends_belong", finding.accepted->ends == Ends::kClosed}};
  }
  return json;
}

Finding findingFrom(const Json& json) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  Finding finding{json.at("measured").get<std::string>(),
                  json.at("target").get<std::string>(),
                  numberOr(json.at("number"), std::numeric_limits<double>::quiet_NaN()),
                  json.at("unit").get<std::string>(),
                  json.at("decimals").get<int>(),
                  {}};
  if (json.contains("accepted")) {
    const Json& accepted = json.at("accepted");
    finding.accepted = Range{numberOr(accepted.at("lowest"), -kInfinite), numberOr(accepted.at("highest"), kInfinite),
                             accepted.at("ends_belong").get<bool>() ? Ends::kClosed : Ends::kOpen};
  }
  return finding;
}

Json jsonOf(const ReportResult& result) {
  Json findings = Json::array();
  for (const Finding& finding : result.findings) {
    findings.push_back(jsonOf(finding));
  }
  Json json{{"took_s", result.took_s}, {"findings", findings}};
  if (!result.why_not.empty()) {
    json["why_not"] = result.why_not;
  }
  return json;
}

ReportResult resultFrom(const Json& json) {
  ReportResult result;
  result.took_s = json.at("took_s").get<double>();
  result.why_not = json.value("why_not", "");
  for (const Json& finding : json.at("findings")) {
    result.findings.push_back(findingFrom(finding));
  }
  return result;
}

std::string reportName(const LabTest& test) {
  return test.without_cohesion ? test.name + ", without cohesion" : test.name;
}

std::vector<ReportRow> reportRows(const LabTest& test, const ReportCell& contact, const ReportCell& icra2021) {
  std::vector<Finding> findings;  // from any model that has them; both have the same quantities
  for (const ReportCell* cell : {&contact, &icra2021}) {
    for (const auto& result : *cell) {
      if (result && findings.empty()) {
        findings = result->findings;
      }
    }
  }
  if (findings.empty()) {
    Finding none;
    none.accepted = Range{};  // a missing number is a failure
    return {{reportName(test), test.description, "", valueOf(contact, 0, none), valueOf(icra2021, 0, none)}};
  }
  std::vector<ReportRow> rows;
  rows.reserve(findings.size());
  for (std::size_t i = 0; i < findings.size(); ++i) {
    rows.push_back({reportName(test), findings[i].measured, findings[i].target, valueOf(contact, i, findings[i]),
                    valueOf(icra2021, i, findings[i])});
  }
  return rows;
}

}  // namespace haptolith
