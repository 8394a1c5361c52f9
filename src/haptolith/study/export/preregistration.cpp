#include "haptolith/study/export/preregistration.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/pluralise.h"
#include "haptolith/study/protocol/groups.h"
#include "haptolith/study/store/provenance.h"

namespace haptolith {

namespace {

constexpr std::string_view kNoHypothesis =
    "[HYPOTHESIS: the key `hypothesis` of the block, for example \"The Weber fraction is below 0.5\"; without one the "
    "Weber fraction is estimated and nothing is tested]";

std::string secondsText(double seconds, std::string_view none) {
  return seconds > 0 ? fmt::format("at most {:g} s", seconds) : std::string(none);
}

std::string_view taskText(TaskKind task) {
  switch (task) {
    case TaskKind::kReferenceFirst: return "the reference is always presented first";
    case TaskKind::kRandomOrder: return "reference and test are presented in an order randomised for each trial";
    case TaskKind::kTwoInterval:
      return "reference and test are presented in an order randomised for each trial (two intervals)";
  }
  return {};
}

std::string_view orderText(BlockOrder order) {
  switch (order) {
    case BlockOrder::kFixed: return "in the order above, the same for all participants";
    case BlockOrder::kLatinSquare: return "balanced over participants by a Williams design";
    case BlockOrder::kRandom: return "in an order randomised for each participant";
  }
  return {};
}

std::string procedureText(const StudyBlock& block) {
  switch (block.procedure) {
    case ProcedureKind::kConstant:
      return fmt::format("constant stimuli: each level {}, in an order randomised for each participant",
                         pluralise(block.repeats, "time"));
    case ProcedureKind::kStaircase:
      return fmt::format("staircases, {} down and {} up, that end after {} reversals or {} trials",
                         block.staircase.down, block.staircase.up, block.staircase.reversals,
                         block.staircase.most_trials);
    case ProcedureKind::kQuestPlus:
      return fmt::format("QUEST+ (Watson 2017): the most informative level each time, {}",
                         pluralise(block.quest_plus.trials, "trial"));
  }
  return {};
}

std::string namesText(const std::vector<Stimulus>& stimuli) {
  std::vector<std::string_view> names;
  names.reserve(stimuli.size());
  for (const Stimulus& stimulus : stimuli) {
    names.push_back(stimulus.name);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string stimulusText(const Stimulus& stimulus) {
  const std::string value = fmt::format("{:g}", stimulus.value);
  return stimulus.name == value ? value : fmt::format("{} ({})", stimulus.name, value);
}

std::string levelsText(const StudyBlock& block) {
  std::vector<std::string> levels;
  levels.reserve(block.levels.size());
  for (const Stimulus& level : block.levels) {
    levels.push_back(stimulusText(level));
  }
  return fmt::format("{}", fmt::join(levels, ", "));
}

std::string visionText(const StudyBlock& block) {
  if (!block.visual) {
    return "not seen";
  }
  return block.visual_delay_s > 0 ? fmt::format("seen {:g} s late", block.visual_delay_s) : "seen";
}

std::string teleopText(const StudyBlock& block) {
  const TeleopWork& work = *block.teleop;
  std::string text = fmt::format(
      "### {}\n\n- Each trial is a robot task: \"{}\", in at most {:g} s.\n- Rendered force: {}. The round-trip delay "
      "is {:g} s.\n- {}",
      block.title.empty() ? block.name : block.title, goalOf(work.task), block.interval_s,
      work.force == TeleopForce::kNone    ? "nothing"
      : work.force == TeleopForce::kModel ? "a static model of the soil"
                                          : "a model of the soil, which adapts to the robot's forces and camera",
      work.round_trip_s, pluralise(block.repeats, "trial"));
  text += block.practice_trials > 0 ? fmt::format(", after {} of practice.\n", block.practice_trials) : ".\n";
  return text;
}

std::string designText(const StudyBlock& block) {
  if (block.teleop) {
    return teleopText(block);
  }
  std::string text = fmt::format(
      "### {}\n\n- Varied: {}; reference {}; levels {}.\n- Question: \"{}\" Answers: \"{}\" or \"{}\"; {}.\n"
      "- Levels are chosen by {}.\n",
      block.title.empty() ? block.name : block.title, block.axis_label, stimulusText(block.reference),
      levelsText(block), block.question, block.answers[0], block.answers[1], taskText(block.task),
      procedureText(block));
  text += fmt::format("- A stimulus lasts {}; a response may take {}. The scene is {} meanwhile.\n",
                      secondsText(block.interval_s, "until the participant continues"),
                      secondsText(block.answer_limit_s, "any time"), visionText(block));
  if (block.practice_trials > 0) {
    text += fmt::format("- Practice: {}{}, which do not count", pluralise(block.practice_trials, "trial"),
                        block.practice_feedback ? " with feedback" : "");
    text += block.practice_criterion > 0
                ? fmt::format(", until {:.0f} % are right, {} at most.\n", 100 * block.practice_criterion,
                              pluralise(block.practice_rounds, "round"))
                : ".\n";
  }
  if (block.catch_trials > 0) {
    text += fmt::format(
        "- Catch trials: {} among the others, of {}.\n", block.catch_trials,
        block.catch_levels.empty() ? block.levels[farthestLevel(block)].name : namesText(block.catch_levels));
  }
  return text;
}

std::string_view methodText(AssignmentMethod method) {
  switch (method) {
    case AssignmentMethod::kAlternate: return "alternately, without randomisation: the next group is predictable";
    case AssignmentMethod::kRandom: return "in permuted blocks";
    case AssignmentMethod::kStratified: return "in permuted blocks within each stratum";
  }
  return {};
}

std::string groupsText(const StudyProtocol& protocol) {
  if (protocol.groups.empty()) {
    return "";
  }
  const GroupAssignment& assignment = protocol.assignment;
  std::string text = "## Groups and allocation\n\n";
  std::vector<std::string> shares;
  for (const ParticipantGroup& group : protocol.groups) {
    std::vector<std::string_view> blocks;
    for (const std::size_t block : group.blocks) {
      blocks.push_back(protocol.blocks[block].name);
    }
    text += fmt::format("- {}: goes through {}.\n", group.name, fmt::join(blocks, ", "));
    shares.push_back(fmt::format("{}", group.share));
  }
  text += fmt::format("- Allocation ratio: {} ({}).\n- Participants are allocated {}.\n", fmt::join(shares, " : "),
                      "in the order above", methodText(assignment.method));
  if (assignment.method != AssignmentMethod::kAlternate) {
    text += fmt::format(
        "- A permuted block has {} participants, in an order that follows from the study's seed, which is fixed when "
        "its "
        "file is made.\n",
        assignment.block_size);
  }
  for (const std::string& key : assignment.strata) {
    const auto item = std::ranges::find(protocol.demographics, key, &FormItem::key);
    text += fmt::format("- Strata by \"{}\" ({}): {}.\n", item->label, key, fmt::join(stratumParts(*item), "; "));
  }
  return text +
         "- The program allocates each participant permanently, after consent and the questions above and before the "
         "first block. Participants are blind to their group, and the experimenter's page hides it until it is "
         "unblinded.\n- Participants who withdraw, are excluded or are removed are not replaced in the sequence.\n\n";
}

std::string exclusionText(const StudyProtocol& protocol) {
  std::string text =
      "- Participants who withdraw are left out; their number is reported.\n- Trials that were repeated or lost do not "
      "count; each is done again.\n";
  for (const StudyBlock& block : protocol.blocks) {
    if (block.catch_trials > 0) {
      text += block.catch_criterion > 0
                  ? fmt::format("- {}: participants with less than {:.0f} % correct catch trials are left out.\n",
                                block.name, 100 * block.catch_criterion)
                  : fmt::format(
                        "- {}: [CRITERION: the key `catch_criterion`, or that no participant is left out for catch "
                        "trials]\n",
                        block.name);
    }
  }
  return text + "- Exclusions after the data are seen are logged with their reason and time, and reported.\n";
}

}  // namespace

std::string preregistrationText(const StudyProtocol& protocol, const PreregistrationFacts& facts) {
  std::string text = fmt::format("# {}\n\nWritten from the protocol (SHA-256 {}) by haptolith {}.\n\n## Hypotheses\n\n",
                                 protocol.title, sha256Of(facts.protocol_text), facts.version);
  for (const StudyBlock& block : protocol.blocks) {
    text += fmt::format("- {}: {}\n", block.name,
                        block.hypothesis.empty() ? kNoHypothesis : std::string_view(block.hypothesis));
  }
  text += "\n## Design\n\n";
  for (const StudyBlock& block : protocol.blocks) {
    text += designText(block) + "\n";
  }
  text += fmt::format("Blocks come {}. All orders follow from the study's seed and the participant's number.\n\n",
                      orderText(protocol.order));
  text += groupsText(protocol);
  text += fmt::format(
      "## Participants\n\n- Number: {}. (`haptolith study plan` estimates the power.)\n- Population: [WHO can take "
      "part, and how they are recruited]\n- All participants read and accept the consent page before the first "
      "question.\n\n",
      protocol.planned_participants > 0
          ? fmt::format("{} complete data sets; the responses do not influence when to stop",
                        protocol.planned_participants)
          : std::string("[NUMBER: the key `participants`], fixed before the first one"));
  text += "## Measures and analysis\n\n";
  const auto works = static_cast<std::size_t>(
      std::ranges::count_if(protocol.blocks, [](const StudyBlock& block) { return block.teleop.has_value(); }));
  if (works > 0) {
    text +=
        "- Measures of robot tasks: success within the time limit, task time (the time limit without success), force "
        "error (RMS of rendered minus remote force at the same command, over RMS of remote force), and the scales of "
        "the form after the block.\n- Estimates: means over participants of each participant's mean over the main "
        "trials, and of differences from the first block, paired within participants, with 95 % intervals (Student's "
        "t).\n";
  }
  const std::size_t compares = protocol.blocks.size() - works;
  text +=
      compares == 0
          ? ""
          : "- Measure: the fraction of responses \"the test had more\", for each level and participant.\n- Model: a "
            "psychometric function for each participant, the cumulative Gaussian of the logarithm of the stimulus "
            "(Gaussian of the stimulus where values are not all above 0), with the point of subjective equality free. "
            "ln(Weber fraction) and ln(PSE) of participants come from normal distributions; one lapse rate is "
            "estimated for all, with the prior Beta(1, 100). Priors are those of docs/reference/psychometrics.md; sums "
            "over grids, no random numbers.\n- Estimates: the Weber fraction and the PSE of the median participant, "
            "posterior medians with 95 % intervals, and the standard deviation between participants.\n";
  if (compares > 1) {
    text +=
        "- Blocks are compared by the ratio of their Weber fractions, paired within participants, with a 95 % "
        "interval.\n";
  }
  if (!protocol.groups.empty() && compares > 0) {
    text +=
        "- Groups are fitted separately and compared by the ratio of their Weber fractions and of their PSEs (as "
        "shares of the references), with 95 % intervals; the Bayes factor of no difference is against a logarithm of "
        "the ratio that is normal about 0 with the standard deviation that is usual between people "
        "(docs/reference/psychometrics.md).\n";
  }
  text +=
      "- A hypothesis about a number is supported when the complete 95 % interval is on its side.\n\n## Exclusion\n\n" +
      exclusionText(protocol) + "\n## Left open\n\n- [ANYTHING that was done or seen before this text was written]\n";
  return text;
}

}  // namespace haptolith
