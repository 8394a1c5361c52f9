#include "haptolith/study/export/preregistration.h"

#include <gmock/gmock.h>

#include <string>

#include "haptolith/study/protocol/protocol.h"

#include "a_study_with_groups.h"

namespace haptolith {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string textFor(const std::string& protocol) {
  return preregistrationText(loadProtocolText(protocol, "a protocol"), {.protocol_text = protocol, .version = "1.2.3"});
}

const std::string kTop = "title = 'Friction'\n";
const std::string kBlock =
    "[[block]]\nname = 'friction'\nquestion = 'Which?'\nanswers = ['the first', 'the second']\nvaries = 'preset'\n"
    "task = 'two-interval'\nreference = 'P3'\nlevels = ['P1', 'P6']\nrepeats = 4\ncatch_trials = 6\n";

TEST(Preregistration, AsksForWhatTheProtocolDoesNotSay) {
  const std::string text = textFor(kTop + kBlock);
  EXPECT_THAT(text, HasSubstr("# Friction\n"));
  EXPECT_THAT(text, HasSubstr("haptolith 1.2.3"));
  EXPECT_THAT(text, HasSubstr("[HYPOTHESIS"));
  EXPECT_THAT(text, HasSubstr("[NUMBER"));
  EXPECT_THAT(text, HasSubstr("friction: [CRITERION"));
  EXPECT_THAT(text, HasSubstr("constant stimuli: each level 4 times"));
}

TEST(Preregistration, SaysWhatTheProtocolSays) {
  const std::string text =
      textFor("participants = 12\n" + kTop + kBlock + "catch_criterion = 0.8\nhypothesis = 'w is below 0.5.'\n");
  EXPECT_THAT(text, HasSubstr("- friction: w is below 0.5.\n"));
  EXPECT_THAT(text, HasSubstr("12 complete data sets"));
  EXPECT_THAT(text, HasSubstr("less than 80 % correct catch trials"));
  EXPECT_THAT(text, Not(HasSubstr("[HYPOTHESIS")));
  EXPECT_THAT(text, Not(HasSubstr("[NUMBER")));
  EXPECT_THAT(text, Not(HasSubstr("[CRITERION")));
}

TEST(Preregistration, SaysHowPeopleAreAllocatedToGroups) {
  EXPECT_THAT(textFor(kTop + kBlock), Not(HasSubstr("allocat")));
  std::string protocol = kTwoGroups;
  const std::string text =
      textFor(protocol.replace(protocol.find("name = \"both\""), 13, "name = \"both\"\nshare = 3"));
  EXPECT_THAT(text, HasSubstr("- both: goes through friction, gravity.\n- weight: goes through gravity.\n"));
  EXPECT_THAT(text, HasSubstr("Allocation ratio: 3 : 1"));
  EXPECT_THAT(text, HasSubstr("permuted blocks within each stratum"));
  EXPECT_THAT(text, HasSubstr("A permuted block has 4 participants"));
  EXPECT_THAT(text, HasSubstr("Strata by \"Which hand do you write with?\" (hand): left; right."));
  EXPECT_THAT(text, HasSubstr("(age): < 30; 30 to < 50; >= 50."));
  EXPECT_THAT(text, HasSubstr("Groups are fitted separately"));
}

}  // namespace
}  // namespace haptolith
