#include "haptolith/identify/training/training_file.h"

#include <gmock/gmock.h>

#include "made_up_training.h"

namespace haptolith {
namespace {

using testing::HasSubstr;

std::string refusal(const std::string& text) {
  try {
    (void)parseTraining(text, "mine.json");
  } catch (const InvalidParameter& error) {
    return error.what();
  }
  return "taken";
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

TEST(TrainingFile, IsReadAsItWasWritten) {
  const Training made = MadeUpSoil(0.1).training(25);
  const Training read = parseTraining(trainingText(made), "made up");
  EXPECT_EQ(read.tool, made.tool);
  EXPECT_EQ(read.gravity_m_s2, made.gravity_m_s2);
  ASSERT_TRUE(read.temper);
  EXPECT_NEAR(*read.temper, *made.temper, 1e-3);
  ASSERT_EQ(read.runs.size(), made.runs.size());
  for (std::size_t i = 0; i < made.runs.size(); ++i) {
    EXPECT_EQ(read.runs[i].number, made.runs[i].number);
    EXPECT_NEAR(read.runs[i].sample.soil.contact_friction, made.runs[i].sample.soil.contact_friction, 1e-6);
    EXPECT_NEAR(read.runs[i].sample.soil.rho_max_kg_m3, made.runs[i].sample.soil.rho_max_kg_m3, 0.01);
    EXPECT_NEAR(read.runs[i].strength->peak.cohesion_pa, made.runs[i].strength->peak.cohesion_pa, 0.01);
    ASSERT_EQ(read.runs[i].forces.size(), made.runs[i].forces.size());
    EXPECT_LT((read.runs[i].forces[20] - made.runs[i].forces[20]).norm(), 1e-3 * made.runs[i].forces[20].norm());
  }
  EXPECT_EQ(trainingText(read), trainingText(parseTraining(trainingText(read), "again")));
}

TEST(TrainingFile, SaysWhatIsWrong) {
  const std::string good = trainingText(MadeUpSoil(0.1).training(3));
  EXPECT_THAT(refusal(""), HasSubstr("identify train"));
  EXPECT_THAT(refusal("[1, 2"), HasSubstr("identify train"));
  EXPECT_THAT(refusal("[]"), HasSubstr("identify train"));
  EXPECT_THAT(refusal(std::string(1'000'000, '[')), HasSubstr("identify train"));
  EXPECT_THAT(refusal(std::string(100'000, '[') + std::string(100'000, ']')), HasSubstr("identify train"));
  EXPECT_THAT(refusal(replaced(good, "\"haptolith_training\": 1", "\"haptolith_training\": 2")), HasSubstr("2"));
  EXPECT_THAT(refusal(replaced(good, "\"gravity_m_s2\": 1.625", "\"gravity_m_s2\": \"much\"")),
              HasSubstr("gravity_m_s2"));
  EXPECT_THAT(refusal(replaced(good, "\"radius_m\":", "\"radius_m\":-")), HasSubstr("mine.json: runs[0].radius_m"));
  EXPECT_THAT(refusal(replaced(good, "\"forces_n\":[[", "\"forces_n\":[[0,0,0],[")), HasSubstr("a list of 28"));
  EXPECT_THAT(refusal(replaced(good, "\"poses\": [[", "\"poses\": [[0,0,0,0,2,0,0,0],[")), HasSubstr("qw,qx,qy,qz"));
  EXPECT_THAT(refusal(replaced(good, "\"contact_friction\"", "\"friction\"")), HasSubstr("missing"));
}

TEST(TrainingFile, RefusesTheSameSoilTwice) {
  Training made = MadeUpSoil(0.1).training(3);
  made.runs.push_back(made.runs[1]);
  EXPECT_THAT(refusal(trainingText(made)),
              testing::AllOf(HasSubstr("mine.json: runs[3].number"), HasSubstr("2, as of mine.json: runs[1]")));
  made.runs.back().number = 999;
  EXPECT_THAT(refusal(trainingText(made)),
              testing::AllOf(HasSubstr("mine.json: runs[3].forces_n"), HasSubstr("those of run 2 again")));
}

}  // namespace
}  // namespace haptolith
