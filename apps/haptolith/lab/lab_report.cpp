#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "haptolith/core/error.h"
#include "haptolith/lab/report_page.h"
#include "haptolith/scenario/scene_words.h"
#include "haptolith/soil/bodies.h"

#include "commands.h"
#include "lab/lab_options.h"
#include "lab/lab_tests.h"
#include "shared/output.h"
#include "shared/stop_on_signal.h"

namespace haptolith {

namespace {

/// Where figures wait until they are in the page.
class TemporaryFolder {
 public:
  TemporaryFolder() : path_(std::filesystem::temp_directory_path() / fmt::format("haptolith-report-{}", getpid())) {
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

struct Outcome {
  std::optional<LabOutput> output;
  std::string why_not;
};

/// One test with one model. A test that a soil fails outright (soil that does not flow through a funnel, say) is a
/// finding, not the end of the report; only an interruption is.
Outcome tryTest(const LabTest& test, LabSoil soil, const LabConditions& base) {
  LabConditions conditions = base;
  if (test.radius_mm > 0) {
    soil.soil = rescaled(soil.soil, test.radius_mm / 1e3);
  }
  if (test.without_cohesion) {
    soil.soil.contact_cohesion_n = 0;
    soil.soil.attraction_ratio = 1;
  }
  conditions.soil = soil.soil;
  try {
    return {test.run(soil, conditions), ""};
  } catch (const Failure& failure) {
    if (stopAsked()) {
      throw;
    }
    return {std::nullopt, failure.what()};
  }
}

std::string nameOf(const LabTest& test) {
  return test.without_cohesion ? test.name + ", without cohesion" : test.name;
}

/// The rows of one test: the findings of both models side by side.
void addRows(ReportPage& page, const LabTest& test, const Outcome& contact, const Outcome& paper) {
  const Outcome& either = contact.output ? contact : paper;
  if (!either.output) {
    page.rows.push_back(
        {nameOf(test), test.description, "", {contact.why_not, Verdict::kFail}, {paper.why_not, Verdict::kFail}});
    return;
  }
  for (std::size_t i = 0; i < either.output->findings.size(); ++i) {
    const Finding& finding = either.output->findings[i];
    const auto value = [&](const Outcome& outcome) {
      if (!outcome.output) {
        return ReportValue{outcome.why_not, finding.target.empty() ? Verdict::kInfo : Verdict::kFail};
      }
      const Finding& own = outcome.output->findings[i];
      return ReportValue{own.value, own.verdict};
    };
    page.rows.push_back({nameOf(test), finding.measured, finding.target, value(contact), value(paper)});
  }
}

void runReport(const LabOptions& options, const std::string& out_file) {
  const StopOnSignal stop_on_signal;
  requireWritable({options.overwrite(out_file)});
  const TemporaryFolder folder;
  StatusLine status;
  LabSoil soil = labSoil(options, 0);
  LabConditions conditions = labConditions(options, soil, status);
  const std::vector<LabTest> tests = labTests();

  ReportPage page;
  page.title = fmt::format("Laboratory report: {}", soil.name);
  page.introduction = {
      "Every test was done twice with the same soil: with friction between the particles (contact), and with the "
      "paper's friction, which acts against space. A test that says so was done without cohesion."};
  page.facts = {{"Soil", soil.name},
                {"Gravity", fmt::format("{}, {:g} m/s²", findBody(options.body).name, conditions.gravity_m_s2)},
                {"Seed", fmt::format("{}", conditions.seed)},
                {"Contacts", fmt::format("friction {:.3g}, cohesion {:.3g} N, stiffness {:.4g} N/m at R = {:g} mm",
                                         soil.soil.contact_friction, soil.soil.contact_cohesion_n,
                                         soil.soil.stiffness_n_m, soil.soil.radius_m * 1e3)}};
  const auto progress = conditions.progress;
  for (std::size_t i = 0; i < tests.size(); ++i) {
    const LabTest& test = tests[i];
    Outcome outcomes[2];
    for (const FrictionModel model : {FrictionModel::kContact, FrictionModel::kPaper}) {
      soil.soil.friction = model;
      conditions.progress = [&](std::string_view what, double share) {
        return progress(
            fmt::format("[{}/{}] {}, {}: {}", i + 1, tests.size(), test.name, wordFor(kFrictionWords, model), what),
            share);
      };
      Outcome& outcome = outcomes[model == FrictionModel::kPaper ? 1 : 0];
      outcome = tryTest(test, soil, conditions);
      if (outcome.output) {
        const std::string caption = fmt::format("{}, {} friction", nameOf(test), wordFor(kFrictionWords, model));
        const std::filesystem::path figure =
            folder.path() / fmt::format("{}-{}.png", test.name, wordFor(kFrictionWords, model));
        outcome.output->draw(figure, caption);
        page.figures.push_back({figure, caption});
      }
    }
    addRows(page, test, outcomes[0], outcomes[1]);
  }
  status.clear();
  saveReport(options.overwrite(out_file), page);
}

}  // namespace

void addReport(CLI::App& lab) {
  auto options = std::make_shared<LabOptions>();
  auto out = std::make_shared<std::string>("lab-report.html");
  CLI::App* command =
      lab.add_subcommand("report", "All tests with both models of friction, on one HTML page; takes a while");
  options->addTo(*command);
  for (const char* unused : {"--figure", "--trace", "--json", "--friction", "--radius-mm"}) {
    command->remove_option(command->get_option(unused));
  }
  command->add_option("--out", *out, "the page: FILE.html")->capture_default_str();
  command->footer("Example:\n  haptolith lab report --soil lunar-0-15cm --out report.html");
  command->callback([options, out] { runReport(*options, *out); });
}

}  // namespace haptolith
