#include "haptolith/study/perception/perception_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include "haptolith/figure/figure.h"
#include "haptolith/scene_file/scene_words.h"

namespace haptolith {

namespace {

/// Most informative cue of each hand, for the hands of the participants of icra2021.
struct Panel {
  HandMotion hand;
  std::string_view cue;
};
constexpr Panel kPanels[] = {
    {HandMotion::kStir, "mean force"}, {HandMotion::kPress, "peak force"}, {HandMotion::kScoop, "weight"}};

// Two colours of Okabe and Ito, distinguishable with colour blindness.
std::string_view colourOf(FrictionModel friction) {
  return friction == FrictionModel::kIcra2021 ? "#d55e00" : "#0072b2";
}

std::string_view titleOf(FrictionModel friction) {
  return friction == FrictionModel::kIcra2021 ? "ICRA 2021 friction" : "contact friction";
}

/// Returns the names of the experiments, in their order.
std::vector<std::string> namesOf(const std::vector<PerceptionBlock>& blocks) {
  std::vector<std::string> names;
  for (const PerceptionBlock& block : blocks) {
    if (std::ranges::find(names, block.name) == names.end()) {
      names.push_back(block.name);
    }
  }
  return names;
}

/// Returns tick labels with the names of the stimuli, for a logarithmic axis.
std::string ticsOf(const PerceptionBlock& block) {
  std::string tics;
  for (const PerceptionStimulus& stimulus : block.stimuli) {
    const bool reference = &stimulus == &block.stimuli[block.reference];
    const std::string name = reference ? fmt::format("{{/:Bold {}}}", stimulus.name) : stimulus.name;
    // Europa and the Moon are close together.
    tics +=
        fmt::format("{}\"{}{}\" {}", tics.empty() ? "" : ", ", stimulus.name == "Moon" ? "\\n" : "", name, stimulus.x);
  }
  return tics;
}

}  // namespace

void drawForces(const OutputFile& path, const std::vector<PerceptionBlock>& blocks,
                const std::vector<std::vector<PerceivedCue>>& perceived) {
  const std::vector<std::string> names = namesOf(blocks);
  Figure figure(path, 1320, 90 + 430 * static_cast<int>(names.size()));
  figure.command(
      fmt::format("set multiplot layout {},3 margins 0.055,0.985,{},0.93 spacing 0.055,0.16\nset bars 0.4\n"
                  "set grid ytics linecolor rgb '#e6e6e6'\nset logscale x\nset border 3\nset xtics nomirror "
                  "scale 0.5\nset ytics nomirror\nset mxtics 0",
                  names.size(), names.size() == 1 ? 0.2 : 0.11));
  for (const std::string& name : names) {
    for (const Panel& panel : kPanels) {
      std::string plot;
      const Cue* drawn = nullptr;
      for (std::size_t b = 0; b < blocks.size(); ++b) {
        const auto found = std::ranges::find_if(perceived[b], [&](const PerceivedCue& one) {
          return one.hand == panel.hand && one.cue != nullptr && one.cue->name == panel.cue;
        });
        if (blocks[b].name != name || found == perceived[b].end()) {
          continue;
        }
        drawn = found->cue;
        std::vector<std::vector<double>> rows;
        const double aside = blocks[b].friction == FrictionModel::kIcra2021 ? 0.99 : 1.01;  // bars next to each other
        for (std::size_t i = 0; i < found->means.size(); ++i) {
          rows.push_back({blocks[b].stimuli[i].x * aside, found->means[i], found->deviations[i]});
        }
        const std::string data = fmt::format("{}{}{}", name, b, wordFor(kHandMotionWords, panel.hand));
        figure.data(data, rows);
        plot += fmt::format(
            "{0}${1} using 1:2 with lines linewidth 2 linecolor rgb '{2}' notitle, ${1} using 1:2:3 with yerrorbars "
            "pointtype 7 pointsize 1 linewidth 1.6 linecolor rgb '{2}' title '{3}'",
            plot.empty() ? "plot " : ", ", data, colourOf(blocks[b].friction), titleOf(blocks[b].friction));
        const double first = blocks[b].stimuli.front().x;
        const double last = blocks[b].stimuli.back().x;
        const double margin = std::pow(last / first, 0.06);
        figure.command(
            fmt::format("set xrange [{}:{}]\nset xtics ({})", first / margin, last * margin, ticsOf(blocks[b])));
      }
      if (drawn == nullptr) {
        figure.command("set multiplot next");
        continue;
      }
      figure.command(fmt::format(
          "set title '{}: {}, {}'\nset yrange [0:{}]\nset key {} top left Left reverse samplen 1",
          wordFor(kHandMotionWords, panel.hand), drawn->title, drawn->unit, panel.cue == "weight" ? "0.05<*" : "*",
          &panel == kPanels && name == names.front() ? "on" : "off"));
      figure.command(fmt::format("set xlabel '{}' offset 0,{}",
                                 name == "friction" ? "friction coefficient of the set" : "gravity",
                                 name == "friction" ? -0.2 : -1));
      if (panel.cue == "weight") {
        figure.command(
            fmt::format("set arrow 1 from graph 0, first {0} to graph 1, first {0} nohead dashtype (6,4) linecolor rgb "
                        "'#888888'\nset label 1 'detection threshold' at graph 0.02, first {0} offset 0,0.6 textcolor "
                        "rgb '#777777'",
                        drawn->sense.threshold));
      }
      figure.command(plot);
      figure.command("unset arrow 1\nunset label 1");
    }
  }
  figure.command("unset multiplot");
  figure.save();
}

void drawWeberFractions(const OutputFile& path, const std::vector<PerceptionBlock>& blocks,
                        const std::vector<std::vector<PerceivedCue>>& perceived) {
  const std::vector<std::string> names = namesOf(blocks);
  Figure figure(path, 200 + 560 * static_cast<int>(names.size()), 820);
  figure.command(
      fmt::format("set multiplot layout 1,{} margins {},0.985,0.1,0.85 spacing 0.16,0\nset border 1\n"
                  "set grid xtics ytics linecolor rgb '#e6e6e6'\nset logscale x\nset ytics nomirror scale 0\n"
                  "set xtics nomirror scale 0.5",
                  names.size(), names.size() == 1 ? 0.22 : 0.13));
  for (const std::string& name : names) {
    std::string plot, tics;
    std::size_t rows = 0;
    double most = 0;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      if (blocks[b].name != name) {
        continue;
      }
      std::vector<std::vector<double>> known, beyond;
      rows = perceived[b].size();
      tics.clear();
      for (std::size_t i = 0; i < rows; ++i) {
        const PerceivedCue& one = perceived[b][i];
        const double y = static_cast<double>(rows - i);
        most = one.discrimination.most;
        tics += fmt::format("{}'{}' {}", tics.empty() ? "" : ", ",
                            one.cue == nullptr ? fmt::format("{{/:Bold {}}}", nameOf(one)) : nameOf(one), y);
        const double aside = blocks[b].friction == FrictionModel::kIcra2021 ? 0.12 : -0.12;
        const bool found = std::isfinite(one.discrimination.weber_fraction);
        const auto shown = [&](double fraction) { return std::isfinite(fraction) ? fraction : most; };
        (found ? known : beyond)
            .push_back({shown(one.discrimination.weber_fraction), y + aside, shown(one.discrimination.interval.low),
                        shown(one.discrimination.interval.high)});
      }
      const double gap = std::nan("");
      known.push_back({gap, gap, gap, gap});
      beyond.push_back({gap, gap, gap, gap});
      figure.data(fmt::format("{}{}", name, b), known);
      figure.data(fmt::format("{}{}beyond", name, b), beyond);
      plot += fmt::format(
          "{0}${1}{2} using 1:2:3:4 with xerrorbars pointtype 7 pointsize 1.4 linewidth 1.6 linecolor rgb '{3}' title "
          "'{4}', "
          "${1}{2}beyond using 1:2:3:4 with xerrorbars pointtype 9 pointsize 1.4 linewidth 1.6 linecolor rgb '{3}' "
          "notitle",
          plot.empty() ? "plot " : ", ", name, b, colourOf(blocks[b].friction), titleOf(blocks[b].friction));
    }
    const ParticipantsWeberFraction people = participantsWeberFraction(name);
    const double rightmost = std::max(most, people.as_printed_log10) * 1.15;
    figure.command(
        fmt::format("set title '{0}' offset 0,4.5\nset xlabel 'Weber fraction'\nset yrange [0.4:{1}]\nset ytics ({2})\n"
                    "set xrange [{3}:{4}]\nset xtics ({5})\nset key bottom right opaque Left reverse samplen 0.5",
                    name == "friction" ? "friction coefficient" : "gravity", static_cast<double>(rows) + 0.6, tics,
                    name == "friction" ? 0.1 : 0.5, rightmost,
                    name == "friction" ? "0.1, 0.2, 0.3, 0.5, 0.7, 1" : "0.5, 1, 2, 5, 10, 20"));
    int number = 0;
    for (const auto& [fraction, reading] :
         {std::pair{people.as_meant, "as meant"}, std::pair{people.as_printed, "as printed"},
          std::pair{people.as_printed_log10, "printed, log_{10}"}}) {
      ++number;
      figure.command(
          fmt::format("set arrow {0} from {1}, graph 0 to {1}, graph 1 nohead linewidth 1.6 dashtype (6,4) linecolor "
                      "rgb '{2}' back\n"
                      "set label {0} \"{1:.2f}\\n{{/*0.8 {3}}}\" at {1}, graph {4} center textcolor rgb '{2}'",
                      number, fraction, number == 1 ? "#111111" : "#888888", reading, number == 1 ? 1.11 : 1.05));
    }
    if (&name != &names.front()) {
      figure.command("set key off");
    }
    figure.command(plot);
    figure.command("unset arrow\nunset label");
  }
  figure.command("unset multiplot");
  figure.save();
}

}  // namespace haptolith
