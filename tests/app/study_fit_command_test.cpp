// `haptolith study fit` as its users meet it.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "program.h"

namespace haptolith {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class StudyFit : public testing::Test {
 protected:
  ~StudyFit() override { fs::remove_all(folder_); }

  std::string file(const std::string& name, const std::string& text) const {
    fs::create_directories(folder_);
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  static json fitOf(const std::string& arguments) {
    const ProgramResult result = runHaptolith("study fit --json " + arguments);
    EXPECT_EQ(result.exit_status, 0) << result.errors;
    EXPECT_THAT(result.errors, testing::AnyOf(IsEmpty(), testing::StartsWith("saved ")));
    return json::parse(result.output);
  }
  static void expectWrongUse(const std::string& arguments, const std::string& words) {
    const ProgramResult result = runHaptolith("study fit " + arguments);
    EXPECT_EQ(result.exit_status, 2) << arguments;
    EXPECT_THAT(result.output, IsEmpty()) << arguments;
    EXPECT_THAT(result.errors, HasSubstr(words)) << arguments;
  }

  const fs::path folder_ = fs::temp_directory_path() / ("haptolith-study-fit-" + std::to_string(getpid()));
  const std::string friction_ = file("friction.csv", "x,k,n\n0.6,2,24\n0.648,4,24\n0.735,8,24\n1,18,24\n1.21,22,24\n");
};

TEST_F(StudyFit, ComparesTheGroupsOfATable) {
  std::string table = "x,k,n,participant,group\n";
  const auto person = [&table](int who, const std::string& group, const std::vector<int>& positive) {
    const std::vector<double> stimuli{0.600, 0.648, 0.735, 1.00, 1.21};
    for (std::size_t i = 0; i < stimuli.size(); ++i) {
      table += fmt::format("{},{},20,p{},{}\n", stimuli[i], positive[i], who, group);
    }
  };
  for (int who = 0; who < 3; ++who) {  // by (paper 22) with w = 0.2 and 0.5
    person(who, "sharp", {1, 2, 5, 17, 20});
    person(3 + who, "dull", {4, 5, 8, 13, 16});
  }
  const std::string data = "--data " + file("groups.csv", table) + " --between-groups --free-threshold";
  const json fit = fitOf(data);
  ASSERT_EQ(fit["groups"].size(), 2U);
  EXPECT_EQ(fit["groups"][0]["group"], "sharp");
  EXPECT_EQ(fit["groups"][0]["participants"].size(), 3U);
  EXPECT_NEAR(fit["groups"][0]["weber_fraction"]["median"], 0.2, 0.05);
  ASSERT_EQ(fit["differences"].size(), 1U);
  const json& ratio = fit["differences"][0]["weber_fraction"];
  EXPECT_EQ(fit["differences"][0]["second_group"], "dull");
  EXPECT_NEAR(ratio["ratio"],
              fit["groups"][1]["weber_fraction"]["median"].get<double>() /
                  fit["groups"][0]["weber_fraction"]["median"].get<double>(),
              0.05);
  EXPECT_GT(ratio["interval"][0], 1.2);
  EXPECT_LT(ratio["bayes_factor_same"], 0.2);
  const ProgramResult told = runHaptolith("study fit " + data);
  EXPECT_THAT(told.output, HasSubstr("group dull over group sharp: different participants"));
  expectWrongUse("--data " + friction_ + " --between-groups", "a table whose column group");
}

TEST_F(StudyFit, ACodeInTwoGroupsIsTwoPeople) {
  std::string table = "participant,group,x,k,n\n";
  for (const char* group : {"sharp", "dull"}) {
    for (int who = 1; who <= 2; ++who) {
      table += fmt::format("{0},{1},0.6,{2},20\n{0},{1},0.835,10,20\n{0},{1},1.21,{3},20\n", who, group, who, 20 - who);
    }
  }
  const ProgramResult told =
      runHaptolith("study fit --sigmoid weber --reference 0.835 --group --between-groups --simulations 0 --data " +
                   file("codes.csv", table));
  EXPECT_EQ(told.exit_status, 0) << told.errors;
  EXPECT_THAT(told.output, testing::AllOf(HasSubstr("1 (sharp)"), HasSubstr("2 (dull)"), HasSubstr("2 participants")));
  EXPECT_THAT(told.errors, HasSubstr("participant '1' is in the groups 'sharp', 'dull' (and 1 more in several)"));
}

TEST_F(StudyFit, TellsThePapersNumbersAsJson) {
  const json fit = fitOf("--data " + friction_ + " --sigmoid weber --reference 0.835");
  EXPECT_NEAR(fit["w"], 0.2952, 1e-3);
  EXPECT_NEAR(fit["weber_fraction"], 0.2952, 1e-3);
  EXPECT_EQ(fit["threshold"], 0.835);
  EXPECT_NEAR(fit["jnd"], 0.835 * 0.2952, 1e-3);
  EXPECT_EQ(fit["n_trials"], 120);
  for (const char* key : {"threshold", "width", "jnd", "weber_fraction", "lapse", "guess", "overdispersion"}) {
    ASSERT_EQ(fit["intervals"][key].size(), 2u) << key;
    EXPECT_LE(fit["intervals"][key][0], fit["intervals"][key][1]) << key;
    EXPECT_TRUE(fit[key].is_number()) << key;
  }
  EXPECT_GT(fit["p_value"], 0.2);
  EXPECT_LT(fit["deviance"], 2);
}

TEST_F(StudyFit, TellsThemToPeople) {
  const ProgramResult result = runHaptolith("study fit --reference 0.835 --compare --data " + friction_);
  EXPECT_EQ(result.exit_status, 0) << result.errors;
  for (const char* words : {"Weber fraction", "0.2952", "JND", "deviance", "log evidence", "logistic"}) {
    EXPECT_THAT(result.output, HasSubstr(words));
  }
}

TEST_F(StudyFit, FitsTwoAlternativesByMaximumLikelihood) {
  const json fit = fitOf("--design 2afc --sigmoid norm --method ml --overdispersion 0 --simulations 100 --data " +
                         file("2afc.csv", "x,k,n\n1,50,100\n2,55,100\n3,75,100\n4,93,100\n5,99,100\n"));
  EXPECT_EQ(fit["guess"], 0.5);
  EXPECT_EQ(fit["method"], "ml");
  EXPECT_NEAR(fit["threshold"], 3, 0.1);
  EXPECT_TRUE(fit["log_evidence"].is_null());
}

TEST_F(StudyFit, FitsAnyNumberOfAlternativesAndFallingFunctions) {
  const json fit = fitOf("--design nafc --alternatives 3 --sigmoid tdist --falling --simulations 0 --data " +
                         file("3afc.csv", "x,k,n\n1,99,100\n2,95,100\n3,67,100\n4,38,100\n5,35,100\n"));
  EXPECT_NEAR(fit["guess"], 1.0 / 3, 1e-12);
  EXPECT_EQ(fit["design"], "3afc");
  EXPECT_EQ(fit["falling"], true);
  EXPECT_NEAR(fit["threshold"], 3, 0.1);
  expectWrongUse("--alternatives 3 --data " + friction_, "nafc");
  expectWrongUse("--design nafc --alternatives 1 --data " + friction_, "--alternatives");
}

TEST_F(StudyFit, PoolsTrialsWithinATolerance) {
  const std::string trials = file("single.csv", "x,response\n0.6,0\n0.61,0\n0.8,0\n0.82,1\n0.81,0\n1.2,1\n1.21,1\n");
  EXPECT_EQ(fitOf("--simulations 0 --data " + trials)["levels"].size(), 7u);
  const json pooled = fitOf("--simulations 0 --pool-tolerance 0.05 --data " + trials)["levels"];
  ASSERT_EQ(pooled.size(), 3u);
  EXPECT_NEAR(pooled[1]["x"], 0.81, 1e-12);
  EXPECT_EQ(pooled[1]["n"], 3);
  expectWrongUse("--pool-tolerance -1 --data " + trials, "pool tolerance");
}

TEST_F(StudyFit, TellsPeopleOfAGroupApartAndDrawsThem) {
  std::string table = "participant,block,value,response\n";
  for (const char* person : {"S01", "S02", "S03"}) {
    for (const auto& [x, positives] : {std::pair("0.6", 0), {"0.735", 1}, {"1", 2}, {"1.21", 3}}) {
      for (int trial = 0; trial < 3; ++trial) {
        table += std::string(person) + ",friction," + x + (trial < positives ? ",1\n" : ",0\n");
      }
    }
  }
  const std::string figure = (folder_ / "figure.svg").string();
  const std::string data = file("trials.csv", table);
  const json fit = fitOf("--group --reference 0.835 --figure " + figure + " --data " + data);
  EXPECT_EQ(fit["n_trials"], 36);
  ASSERT_EQ(fit["group"]["participants"].size(), 3u);
  EXPECT_EQ(fit["group"]["participants"][1]["participant"], "S02");
  EXPECT_GT(fit["group"]["weber_fraction"]["median"], 0);
  EXPECT_TRUE(fs::exists(figure));
  expectWrongUse("--block gravity --data " + data, "'friction'");
}

TEST_F(StudyFit, WrongUseIsToldWithWhatWouldBeRight) {
  expectWrongUse("", "--data");
  expectWrongUse("--data /missing.csv", "/missing.csv");
  expectWrongUse("--sigmoid cosine --data " + friction_, "cosine");
  expectWrongUse("--design 3afc --data " + friction_, "3afc");
  expectWrongUse("--lapse much --data " + friction_, "a number or free");
  expectWrongUse("--confidence 2 --data " + friction_, "confidence");
  expectWrongUse("--reference -1 --data " + friction_, "threshold");
  expectWrongUse("--data " + file("bad.csv", "x,k,n\n1,2,1\n"), "bad.csv:2: column k");
  expectWrongUse("--data " + file("negative.csv", "x,k,n\n-1,0,3\n1,3,3\n"), "logarithmic axis");
  expectWrongUse("--data " + file("columns.csv", "a,b\n1,2\n"), "x,k,n");
  expectWrongUse("--figure drawing.pdf --data " + friction_, ".svg or .png");
  const std::string blocks = file("blocks.csv", "block,x,k,n\na,1,0,3\na,2,3,3\nb,1,1,3\n");
  expectWrongUse("--data " + blocks, "one of 'a', 'b'");
}

TEST_F(StudyFit, TellsNoNumberThatIsNone) {
  const std::vector<std::string> tables{
      "x,k,n\n1,20,20\n2,20,20\n",
      "x,k,n\n1,0,20\n2,0,20\n",
      "x,k,n\n-1,3,20\n0,11,20\n1,17,20\n",
      "x,k,n\n1,0,20\n2,20,20\n",
      "x,k,n\n1,100000000,1000000000\n2,900000000,1000000000\n",
      "x,k,n,participant,group\n1,2,20,a,one\n2,18,20,a,one\n1,3,20,b,one\n2,17,20,b,one\n"
      "1,20,20,c,two\n2,20,20,c,two\n1,20,20,d,two\n2,20,20,d,two\n"};
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const std::string data = "--data " + file(fmt::format("extreme{}.csv", i), tables[i]);
    const std::string model = tables[i].find("group") != std::string::npos
                                  ? " --free-threshold --group --between-groups"
                                  : " --sigmoid norm --design 2afc";
    for (const char* simulations : {" --simulations 0", " --simulations 20"}) {
      const ProgramResult told = runHaptolith("study fit " + data + model + simulations);
      EXPECT_EQ(told.exit_status, 0) << told.errors;
      for (const char* none : {"nan", "inf", "e-17", "difference 0,", "deviance -"}) {
        EXPECT_THAT(told.output, testing::Not(HasSubstr(none))) << tables[i];
      }
    }
  }
}

TEST_F(StudyFit, DoubtsAFunctionThatItsAnswersContradict) {
  const std::string falling = file("falling.csv", "x,k,n\n.5,20,20\n.7,18,20\n.9,10,20\n1.1,2,20\n1.3,0,20\n");
  const std::string options = " --sigmoid norm --simulations 0 --data " + falling;
  EXPECT_THAT(runHaptolith("study fit" + options).output, HasSubstr("Doubtful: positive responses become fewer"));
  EXPECT_THAT(fitOf(options)["doubt"].get<std::string>(), HasSubstr("--falling"));
  EXPECT_FALSE(fitOf(options + " --falling").contains("doubt"));
}

TEST_F(StudyFit, RefusesWhatItsNumbersCannotHold) {
  expectWrongUse("--sigmoid norm --data " + file("n.csv", "x,k,n\n1,1,2000000000\n2,2,3\n"), "0 to 1000000000");
  expectWrongUse("--sigmoid norm --data " + file("far.csv", "x,k,n\n-1e308,1,20\n1e308,19,20\n"), "x of a level");
  expectWrongUse("--sigmoid gumbel --log-x --figure " + (folder_ / "z.svg").string() + " --data " +
                     file("wide.csv", "x,k,n\n1e-300,3,20\n1e300,17,20\n"),
                 "1e+60");
  const ProgramResult wide =
      runHaptolith("study fit --sigmoid gumbel --log-x --simulations 0 --figure " + (folder_ / "wide.svg").string() +
                   " --data " + file("less.csv", "x,k,n\n1e-50,3,20\n1e50,17,20\n"));
  EXPECT_EQ(wide.exit_status, 0) << wide.errors;
  EXPECT_THAT(wide.output, Not(HasSubstr(" 0 to "))) << "a positive number is not rounded to 0";
  expectWrongUse("--sigmoid gumbel --log-x --data " + file("tiny.csv", "x,k,n\n1e-61,3,20\n1,17,20\n"),
                 "must be 1e-60 to 1e+60");
}

}  // namespace
}  // namespace haptolith
