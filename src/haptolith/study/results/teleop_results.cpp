#include "haptolith/study/results/teleop_results.h"

#include <boost/math/distributions/students_t.hpp>
#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <set>
#include <utility>

#include "haptolith/core/statistics.h"

namespace haptolith {

namespace {

/// Quantity of a trial, and its name.
struct OfTrials {
  const char* name;
  const char* unit;
  double TeleopSummary::*value;
};

constexpr std::array kOfTrials{
    OfTrials{"done", "share", &TeleopSummary::done},
    OfTrials{"task time", "s", &TeleopSummary::time_s},
    OfTrials{"error of force", "share", &TeleopSummary::force_error},
    OfTrials{"largest force met", "N", &TeleopSummary::met_peak_n},
    OfTrials{"stops", "a trial", &TeleopSummary::stops},
};

/// Computes the mean of a quantity over each participant's trials that have it.
TeleopMeasure measureOf(const OfTrials& number, std::span<const TrialRow> trials, std::size_t block,
                        const std::set<std::int64_t>& people) {
  TeleopMeasure measure{.name = number.name, .unit = number.unit};
  std::map<std::int64_t, std::vector<double>> values;
  for (const TrialRow& trial : trials) {
    const bool is_main = trial.block == block && trial.kind == TrialKind::kMain && trial.state == TrialState::kAnswered;
    if (is_main && people.contains(trial.participant) && trial.answer && trial.answer->teleop) {
      if (const double value = (*trial.answer->teleop).*number.value; std::isfinite(value)) {
        values[trial.participant].push_back(value);
      }
    }
  }
  for (const auto& [person, all] : values) {
    measure.of_people[person] = mean(all);
  }
  return measure;
}

TeleopMeasure measureOf(const FormItem& item, const std::string& form, std::span<const FormAnswerRow> answers,
                        const std::set<std::int64_t>& people) {
  TeleopMeasure measure{.name = item.key, .unit = fmt::format("{:g} to {:g}", item.low, item.high)};
  for (const FormAnswerRow& answer : answers) {
    double value = 0;
    const char* const end = answer.value.data() + answer.value.size();
    const bool is_it = answer.form == form && answer.key == item.key && people.contains(answer.participant);
    if (is_it && std::from_chars(answer.value.data(), end, value).ptr == end && !answer.value.empty()) {
      measure.of_people[answer.participant] = value;
    }
  }
  return measure;
}

PeopleMean meanOf(const std::map<std::int64_t, double>& of_people, double confidence) {
  std::vector<double> values;
  values.reserve(of_people.size());
  for (const auto& [person, value] : of_people) {
    values.push_back(value);
  }
  return meanOverPeople(values, confidence);
}

}  // namespace

PeopleMean meanOverPeople(std::span<const double> values, double confidence) {
  PeopleMean result{.people = values.size()};
  if (values.empty()) {
    return result;
  }
  const auto n = static_cast<double>(values.size());
  result.mean = mean(values);
  if (values.size() > 1) {
    const double t = boost::math::quantile(boost::math::students_t(n - 1), (1 + confidence) / 2);
    const double half = t * standardDeviation(values) / std::sqrt(n);
    result.interval = {result.mean - half, result.mean + half};
  }
  return result;
}

std::vector<TeleopBlockResult> teleopResults(const StudyStore& study, bool withdrawn) {
  std::set<std::int64_t> people;
  for (const ParticipantRow& person : study.participants()) {
    if (person.excluded_for.empty() && (withdrawn || person.state != "withdrawn")) {
      people.insert(person.id);
    }
  }
  const std::vector<TrialRow> trials = study.trials();
  const std::vector<FormAnswerRow> answers = study.formAnswers(false);
  std::vector<TeleopBlockResult> results;
  const std::vector<StudyBlock>& blocks = study.protocol().blocks;
  for (std::size_t number = 0; number < blocks.size(); ++number) {
    if (!blocks[number].teleop) {
      continue;
    }
    TeleopBlockResult result{.block = number};
    for (const OfTrials& of : kOfTrials) {
      result.measures.push_back(measureOf(of, trials, number, people));
    }
    for (const FormItem& item : blocks[number].questionnaire) {
      if (item.kind == FormItem::Kind::kScale && !item.personal) {
        result.measures.push_back(measureOf(item, blocks[number].name, answers, people));
      }
    }
    if (!result.measures.front().of_people.empty()) {
      results.push_back(std::move(result));
    }
  }
  return results;
}

PeopleMean meanOf(const TeleopMeasure& measure, double confidence) {
  return meanOf(measure.of_people, confidence);
}

PeopleMean meanDifference(const TeleopMeasure& measure, const TeleopMeasure& less, double confidence) {
  std::map<std::int64_t, double> differences;
  for (const auto& [person, value] : measure.of_people) {
    if (const auto other = less.of_people.find(person); other != less.of_people.end()) {
      differences[person] = value - other->second;
    }
  }
  return meanOf(differences, confidence);
}

}  // namespace haptolith
