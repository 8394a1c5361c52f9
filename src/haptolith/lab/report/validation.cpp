#include "haptolith/lab/report/validation.h"

#include <boost/math/distributions/students_t.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "haptolith/core/statistics.h"
#include "haptolith/figure/figure.h"

namespace haptolith {

namespace {

ClaimValue valueOf(const std::vector<double>& numbers) {
  return {mean(numbers), numbers.size() > 1 ? std::optional(standardDeviation(numbers) /
                                                            std::sqrt(static_cast<double>(numbers.size())))
                                            : std::nullopt};
}

/// Returns the 90 % confidence interval of the mean by Student's t, whose ends are those of two one-sided tests at 5 %.
std::optional<Range> intervalOf(const std::vector<double>& numbers) {
  if (numbers.size() < 2) {
    return std::nullopt;
  }
  const ClaimValue value = valueOf(numbers);
  constexpr double kOneSided = 0.95;
  const double t = boost::math::quantile(boost::math::students_t(static_cast<double>(numbers.size() - 1)), kOneSided);
  return Range{value.mean - t * *value.standard_error, value.mean + t * *value.standard_error};
}

/// Returns values whose mean is the ratio of the means, and whose scatter is its linearised error:
/// r + (ours - r other) / mean(other). Means of single ratios would be too large where references scatter.
std::vector<double> ratiosOf(const std::vector<double>& ours, const std::vector<double>& others) {
  const double mean_other = mean(others);
  const double ratio = mean(ours) / mean_other;
  std::vector<double> values(ours.size());
  std::ranges::transform(ours, others, values.begin(),
                         [=](double one, double other) { return ratio + (one - ratio * other) / mean_other; });
  return values;
}

/// Returns the interval of a mean in logarithms, as wide at both ends by a factor.
Range inLogarithms(const Range& interval) {
  const double middle = (interval.lowest + interval.highest) / 2;
  const double factor = std::exp((interval.highest - middle) / middle);
  return {middle / factor, middle * factor};
}

bool hasInside(const Range& outer, const Range& inner) {
  return outer.contains(inner.lowest) && outer.contains(inner.highest);
}

bool areApart(const Range& one, const Range& other) {
  return one.highest < other.lowest || other.highest < one.lowest;
}

ClaimLight lightOf(const std::optional<Range>& interval, const Range& accepted) {
  return !interval                        ? ClaimLight::kYellow
         : hasInside(accepted, *interval) ? ClaimLight::kGreen
         : areApart(accepted, *interval)  ? ClaimLight::kRed
                                          : ClaimLight::kYellow;
}

}  // namespace

void validate(const Claim& claim) {
  const int tolerances = static_cast<int>(claim.factor.has_value()) + static_cast<int>(claim.within.has_value()) +
                         static_cast<int>(claim.accepted.has_value());
  if (tolerances != 1) {
    throw InvalidParameter("factor, within, accepted", fmt::format("{} of them", tolerances), "exactly one of them");
  }
  if (claim.factor) {
    requireInRange("factor", *claim.factor, {1, 100});
  }
  if (claim.within) {
    requireInRange("within", *claim.within, {0, 1});
  }
  if (!claim.accepted && claim.expected && *claim.expected == 0) {
    throw InvalidParameter("expected", "0", "a number that something can be a multiple of, or accepted instead");
  }
}

ClaimOutcome judge(const Claim& claim, const std::vector<ClaimSpecimen>& specimens) {
  ClaimOutcome outcome;
  std::vector<double> ours;
  std::vector<double> others;
  for (const ClaimSpecimen& specimen : specimens) {
    const std::optional<double> other = claim.expected ? claim.expected : specimen.other;
    const bool has_ratio = specimen.ours && other && *other != 0;
    if (!specimen.ours || (!claim.accepted && !has_ratio)) {
      outcome.why_not = outcome.why_not.empty() ? specimen.why_not : outcome.why_not;
      continue;
    }
    ours.push_back(*specimen.ours);
    if (other) {
      others.push_back(*other);
    }
  }
  outcome.specimens = ours.size();
  if (ours.empty()) {
    return outcome;
  }
  outcome.ours = valueOf(ours);
  if (others.size() == ours.size()) {
    outcome.other = valueOf(others);
  }
  std::vector<double> ratios;
  if (others.size() == ours.size() && mean(others) != 0) {
    ratios = ratiosOf(ours, others);
    outcome.ratio = valueOf(ratios);
    outcome.ratio_interval = intervalOf(ratios);
    if (claim.factor && outcome.ratio_interval && outcome.ratio->mean > 0) {
      outcome.ratio_interval = inLogarithms(*outcome.ratio_interval);
    }
  }
  Range accepted;
  if (claim.accepted) {
    accepted = *claim.accepted;
    if (outcome.ratio && outcome.other->mean > 0 && !others.empty()) {
      outcome.ratio_range = Range{accepted.lowest / outcome.other->mean, accepted.highest / outcome.other->mean};
    }
  } else {
    accepted = claim.factor ? Range{1 / *claim.factor, *claim.factor} : Range{1 - *claim.within, 1 + *claim.within};
    outcome.ratio_range = accepted;
  }
  const double reference = outcome.ratio ? 1 : (accepted.highest - accepted.lowest) / 2;
  if (ours.size() > 1 && reference > 0) {
    outcome.spread = standardDeviation(outcome.ratio ? ratios : ours) / reference;
  }
  outcome.light = outcome.specimens < specimens.size()
                      ? ClaimLight::kRed
                      : lightOf(claim.accepted ? intervalOf(ours) : outcome.ratio_interval, accepted);
  return outcome;
}

namespace {

std::string_view markOf(ClaimLight light) {
  switch (light) {
    case ClaimLight::kGreen: return "🟢 holds";
    case ClaimLight::kYellow: return "🟡 open";
    case ClaimLight::kRed: return "🔴 fails";
  }
  return "";
}

/// Formats three significant digits, without an exponent for common magnitudes.
std::string digits(double number) {
  const double size = std::abs(number);
  if (size == 0) {
    return "0";
  }
  if (size >= 1e6 || size < 1e-3) {
    return fmt::format("{:.2e}", number);
  }
  const std::string rounded = fmt::format("{:.2e}", size);  // rounds 0.9996 to 1.00
  const int before = std::stoi(rounded.substr(rounded.find('e') + 1)) + 1;
  return fmt::format("{:.{}f}", number, std::clamp(3 - before, 0, 5));
}

std::string text(const ClaimValue& value, std::string_view unit) {
  const std::string behind = unit.empty() ? "" : fmt::format(" {}", unit);
  constexpr double kRounding = 1e-9;  // relative difference between specimens of a theory without scatter
  return value.standard_error.value_or(0) > kRounding * std::abs(value.mean)
             ? fmt::format("{} ± {}{}", digits(value.mean), digits(*value.standard_error), behind)
             : digits(value.mean) + behind;
}

std::string toleranceText(const Claim& claim) {
  if (claim.factor) {
    return fmt::format("factor {:g}", *claim.factor);
  }
  if (claim.within) {
    return fmt::format("± {:g} %", 100 * *claim.within);
  }
  return fmt::format("{} to {}", digits(claim.accepted->lowest), digits(claim.accepted->highest));
}

std::string referenceText(const JudgedClaim& judged) {
  const Claim& claim = judged.claim;
  std::string number = "-";
  if (claim.expected) {
    number = text({.mean = *claim.expected, .standard_error = {}}, claim.unit);
    if (claim.scatter.lowest < claim.scatter.highest) {
      number += fmt::format(" ({} to {})", digits(claim.scatter.lowest), digits(claim.scatter.highest));
    }
  } else if (judged.outcome && judged.outcome->other) {
    number = text(*judged.outcome->other, claim.unit);
  }
  return claim.reference.empty() ? number : fmt::format("{}: {}", number, claim.reference);
}

/// Escapes the text of a cell of a Markdown table.
std::string cell(std::string_view text) {
  std::string shown;
  for (const char letter : text) {
    shown += letter == '|' ? "\\|" : letter == '\n' ? " " : std::string(1, letter);
  }
  return shown;
}

std::string rowText(const JudgedClaim& judged) {
  const std::optional<ClaimOutcome>& outcome = judged.outcome;
  std::string ours = "not simulated yet";
  std::string ratio = "-";
  std::string verdict = "-";
  std::string specimens = "-";
  if (outcome) {
    ours = outcome->ours ? text(*outcome->ours, judged.claim.unit) : fmt::format("none: {}", outcome->why_not);
    ratio = outcome->ratio ? text(*outcome->ratio, "") : "-";
    specimens = fmt::format("{}", outcome->specimens);
    verdict = markOf(outcome->light);
  }
  return fmt::format("| `{}`: {} | {} | {} | {} | {} | {} | {} |\n", judged.claim.id, cell(judged.claim.claim),
                     cell(referenceText(judged)), cell(ours), ratio, toleranceText(judged.claim), specimens, verdict);
}

/// Numbers of claims and of verdicts.
struct ClaimCount {
  std::size_t claims = 0;
  std::size_t simulated = 0;
  std::array<std::size_t, 3> lights{};  ///< index: ClaimLight
};

/// Counts claims of one kind; none: of all kinds.
ClaimCount countClaims(const std::vector<JudgedClaim>& claims, std::optional<ClaimKind> kind) {
  ClaimCount count;
  for (const JudgedClaim& judged : claims) {
    if (kind && judged.claim.kind != *kind) {
      continue;
    }
    ++count.claims;
    if (judged.outcome) {
      ++count.simulated;
      ++count.lights[static_cast<std::size_t>(judged.outcome->light)];
    }
  }
  return count;
}

std::string countRow(std::string_view name, const ClaimCount& count) {
  return fmt::format("| {} | {} | {} | {} | {} |\n", name, count.claims, count.lights[0], count.lights[1],
                     count.lights[2]);
}

/// At most 15 lines: the verdicts by kind of claim.
std::string summaryText(const std::vector<JudgedClaim>& claims) {
  constexpr std::array<std::pair<ClaimKind, std::string_view>, 3> kKinds{
      {{ClaimKind::kIndependent, "independent: measurements, equations and theories that the soil was not fitted to"},
       {ClaimKind::kCalibrated, "calibrated: targets that the soil was fitted to"},
       {ClaimKind::kConsistency, "self-consistency: haptolith compared with itself or with mechanics"}}};
  const ClaimCount all = countClaims(claims, {});
  const ClaimCount independent = countClaims(claims, ClaimKind::kIndependent);
  const ClaimCount& headline = independent.claims > 0 ? independent : all;
  std::string text = fmt::format(
      "\n**Result.** Of {} {}claims {} hold, {} are open and {} fail.{}\n\n", headline.claims,
      independent.claims > 0 ? "independent " : "", headline.lights[0], headline.lights[1], headline.lights[2],
      all.simulated < all.claims ? fmt::format(" Not simulated yet: {}.", all.claims - all.simulated) : "");
  text += "| Claims | Number | 🟢 hold | 🟡 open | 🔴 fail |\n|---|--:|--:|--:|--:|\n";
  for (const auto& [kind, name] : kKinds) {
    const ClaimCount count = countClaims(claims, kind);
    text += count.claims > 0 ? countRow(name, count) : "";
  }
  text += countRow("all", all);
  return text +
         "\n🟢 holds: the 90 % confidence interval of the mean is inside the tolerance (two one-sided t tests, 5 % "
         "each)."
         "\n🔴 fails: it is outside, or a specimen gave no number. 🟡 open: it contains an end of the tolerance, "
         "or\n"
         "there is one specimen. Ratio is simulated over reference.\n";
}

bool hasRatio(const JudgedClaim& judged) {
  return judged.outcome && judged.outcome->ratio && judged.outcome->ratio->mean > 0;
}

}  // namespace

std::vector<std::string> groupsOf(const std::vector<Claim>& claims) {
  std::vector<std::string> groups;
  for (const Claim& claim : claims) {
    if (std::ranges::find(groups, claim.group) == groups.end()) {
      groups.push_back(claim.group);
    }
  }
  return groups;
}

std::vector<std::string> figureNamesOf(const std::vector<std::string>& groups) {
  std::vector<std::string> names;
  for (const std::string& group : groups) {
    std::string name = "validation-";
    for (const char letter : group) {
      const bool plain = (letter >= 'a' && letter <= 'z') || (letter >= '0' && letter <= '9');
      const bool capital = letter >= 'A' && letter <= 'Z';
      name += plain ? letter : capital ? static_cast<char>(letter - 'A' + 'a') : '-';
    }
    std::string file = name + ".svg";
    for (int number = 2; std::ranges::find(names, file) != names.end(); ++number) {
      file = fmt::format("{}-{}.svg", name, number);
    }
    names.push_back(file);
  }
  return names;
}

std::string validationPage(const std::vector<JudgedClaim>& claims, const std::vector<std::string>& introduction,
                           bool has_figures) {
  std::string page = "# Validation: simulated soil compared with reference values\n" + summaryText(claims);
  for (const std::string& paragraph : introduction) {
    page += "\n" + paragraph + "\n";
  }
  std::vector<Claim> bare(claims.size());
  std::ranges::transform(claims, bare.begin(), &JudgedClaim::claim);
  const std::vector<std::string> groups = groupsOf(bare);
  const std::vector<std::string> figures = figureNamesOf(groups);
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const std::string& group = groups[i];
    page += fmt::format(
        "\n## {}\n\n| Claim | Reference | Simulated | Ratio | Tolerance | n | |\n|---|---|--:|--:|--:|--:|---|\n",
        group);
    std::string notes;
    for (const JudgedClaim& judged : claims) {
      if (judged.claim.group == group) {
        page += rowText(judged);
        notes += judged.claim.note.empty() ? "" : fmt::format("- `{}`: {}\n", judged.claim.id, judged.claim.note);
      }
    }
    page += notes.empty() ? "" : "\n" + notes;
    const bool has_figure = has_figures && std::ranges::any_of(claims, [&](const JudgedClaim& judged) {
                              return judged.claim.group == group && hasRatio(judged);
                            });
    page += has_figure
                ? fmt::format("\n![{}: simulated over reference, with interval and tolerance]({})\n", group, figures[i])
                : "";
  }
  return page;
}

bool drawValidation(const OutputFile& file, const std::vector<JudgedClaim>& claims, std::string_view group) {
  constexpr double kLeast = 0.1;  // lower end of the axis; smaller ratios are drawn at its edge
  constexpr double kMost = 10;
  std::vector<const JudgedClaim*> shown;
  for (const JudgedClaim& judged : claims) {
    if (judged.claim.group == group && hasRatio(judged)) {
      shown.push_back(&judged);
    }
  }
  if (shown.empty()) {
    return false;
  }
  const auto rows = static_cast<double>(shown.size());
  Figure figure(file, 1000, 120 + 22 * static_cast<int>(shown.size()));
  std::string labels;
  std::vector<std::vector<double>> bands;
  std::array<std::vector<std::vector<double>>, 3> points;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const double y = rows - static_cast<double>(i);
    const ClaimOutcome& outcome = *shown[i]->outcome;
    labels += fmt::format("{}{} {:g}", i > 0 ? ", " : "", gnuplotQuoted(shown[i]->claim.id), y);
    const Range interval = outcome.ratio_interval.value_or(Range{outcome.ratio->mean, outcome.ratio->mean});
    const auto on_axis = [=](double ratio) { return std::clamp(ratio, kLeast, kMost); };
    points[static_cast<std::size_t>(outcome.light)].push_back(
        {on_axis(outcome.ratio->mean), y, on_axis(interval.lowest), on_axis(interval.highest)});
    if (outcome.ratio_range) {
      bands.push_back({on_axis(outcome.ratio_range->lowest), y, on_axis(outcome.ratio_range->highest)});
    }
  }
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  const std::array names{"green", "yellow", "red"};
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].empty()) {
      points[i].push_back({nothing, nothing, nothing, nothing});
    }
    figure.data(names[i], points[i]);
  }
  if (bands.empty()) {
    bands.push_back({nothing, nothing, nothing});
  }
  figure.data("bands", bands);
  figure.command(
      fmt::format("set logscale x; set xrange [{}:{}]; set yrange [0:{}]; set ytics ({}); set grid xtics; "
                  "set key tmargin center horizontal; set xlabel 'simulated over reference'; set lmargin 34; "
                  "set arrow from 1, graph 0 to 1, graph 1 nohead linecolor rgb '#888888'; "
                  "set xtics (0.1, 0.2, 0.5, 1, 2, 5, 10)",
                  kLeast, kMost, rows + 1, labels));
  figure.command(
      "plot $bands using 1:2:($3-$1):(0) with vectors nohead linewidth 11 linecolor rgb '#d9d9d9' title 'tolerance', "
      "$green using 1:2:3:4 with xerrorbars pointtype 7 linewidth 1.5 linecolor rgb '#009e73' title 'holds', "
      "$yellow using 1:2:3:4 with xerrorbars pointtype 9 linewidth 1.5 linecolor rgb '#e69f00' title 'open', "
      "$red using 1:2:3:4 with xerrorbars pointtype 5 linewidth 1.5 linecolor rgb '#d55e00' title 'fails'");
  figure.save();
  return true;
}

}  // namespace haptolith
