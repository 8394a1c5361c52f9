// Specimens that many machines measured, put together.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>

#include "program.h"

namespace haptolith {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

class LabCollect : public testing::Test {
 protected:
  LabCollect() { fs::create_directories(folder_); }
  ~LabCollect() override { fs::remove_all(folder_); }

  [[nodiscard]] std::string fileOf(int seed) const { return (folder_ / fmt::format("{}.json", seed)).string(); }

  /// One specimen, as a job of an array measures it.
  [[nodiscard]] std::string measured(int seed, const std::string& test) const {
    const ProgramResult result = runHaptolith(fmt::format("lab {} --seed {} --json > {}", test, seed, fileOf(seed)));
    EXPECT_EQ(result.exit_status, 0) << result.errors;
    return fileOf(seed);
  }

  [[nodiscard]] json read(int seed) const { return json::parse(std::ifstream(fileOf(seed))); }

  /// A file like that of `seed`, changed.
  std::string changed(int seed, const std::function<void(json&)>& change) const {
    json specimen = read(seed);
    change(specimen);
    const std::string path = (folder_ / "changed.json").string();
    std::ofstream(path) << specimen;
    return path;
  }

  static void expectRefused(const std::string& files, const testing::Matcher<const std::string&>& why,
                            int exit_status = 1) {
    const ProgramResult result = runHaptolith("lab collect " + files);
    EXPECT_EQ(result.exit_status, exit_status) << files;
    EXPECT_EQ(result.output, "");
    EXPECT_THAT(result.errors, why);
  }

  fs::path folder_ = fs::temp_directory_path() / ("haptolith_collect_" + std::to_string(getpid()));
};

constexpr const char* kPayload = "payload --soil dry-sand --particles 60";

TEST_F(LabCollect, GivesWhatOneRunOverTheSameSeedsGives) {
  const std::string files = measured(3, kPayload) + " " + measured(1, kPayload) + " " + measured(2, kPayload);
  for (const char* form : {"", " --json"}) {
    const ProgramResult apart = runHaptolith("lab collect " + files + form);
    const ProgramResult at_once = runHaptolith(std::string("lab ") + kPayload + " --seeds 3" + form);
    ASSERT_EQ(apart.exit_status, 0) << apart.errors;
    ASSERT_EQ(at_once.exit_status, 0) << at_once.errors;
    EXPECT_EQ(apart.output, at_once.output);
  }
}

TEST_F(LabCollect, TellsMeanAndScatterOfEachNumber) {
  const std::string files = measured(1, kPayload) + " " + measured(2, kPayload);
  const double a = read(1).at("shake_ratio"), b = read(2).at("shake_ratio");
  ASSERT_NE(a, b);
  const fs::path table = folder_ / "all.csv";
  const ProgramResult result = runHaptolith("lab collect --json " + files + " --out " + table.string());
  ASSERT_EQ(result.exit_status, 0) << result.errors;
  const json answer = json::parse(result.output);
  EXPECT_EQ(answer.at("test"), "payload");
  EXPECT_EQ(answer.at("options"), json({{"particles", "60"}}));
  EXPECT_EQ(answer.at("seeds"), json({1, 2}));
  EXPECT_EQ(answer.at("specimens"), 2);
  const json shaken = answer.at("results").at("shake_ratio");
  EXPECT_DOUBLE_EQ(shaken.at("mean"), (a + b) / 2);
  EXPECT_NEAR(shaken.at("sd"), std::abs(a - b) / std::sqrt(2), 1e-12);  // two values: (n - 1)
  EXPECT_EQ(shaken.at("specimens"), 2);
  const json weight = answer.at("findings").at(0);
  EXPECT_EQ(weight.at("measured"), "weight felt over weight");
  EXPECT_DOUBLE_EQ(weight.at("mean"), answer.at("results").at("weight_ratio").at("mean"));
  EXPECT_EQ(weight.at("passes"), true);
  std::ifstream csv(table);
  std::string header, row;
  std::getline(csv, header);
  std::getline(csv, row);
  EXPECT_EQ(header, "seed,weight_ratio,drag_ratio,shake_ratio,follow_ratio,carried_kg,left_kg");
  EXPECT_THAT(row, testing::StartsWith("1,"));
  EXPECT_EQ(runHaptolith("lab collect " + files + " --out " + table.string()).exit_status, 1);  // it is there
}

TEST_F(LabCollect, PutsCalibrationsTogether) {
  // Output of `soil calibrate --specimens 2 --json` for another seed; a calibration takes minutes.
  const json printed = json::parse(R"({"test": "calibrate", "soil": "32°, 0 Pa, 1500 kg/m³", "friction": "contact",
    "body": "Moon", "gravity_m_s2": 1.625, "radius_mm": 7.0, "stiffness_n_m": 3000.0, "seed": 1,
    "friction_angle_deg": 32.4, "friction_angle_sd_deg": 0.6, "cohesion_pa": 12.0, "cohesion_sd_pa": 9.0,
    "bulk_density_kg_m3": 1502.0, "rounds": 2, "contact_friction": 0.25, "contact_cohesion_n": 0.0, "gamma_nm": 6e-05,
    "rho0_kg_m3": 1300.0, "rho_max_kg_m3": 1800.0, "out": "soil-1.toml",
    "findings": [
      {"measured": "residual friction angle", "target": "32 ± 2°", "number": 32.4, "unit": "°", "decimals": 1,
       "accepted": {"lowest": 30.0, "highest": 34.0, "ends_belong": true}}],
    "program": "haptolith 1", "options": {"density": "lunar", "specimens": "2"}, "soil_keys": {},
    "target": {"bulk_density_kg_m3": 1500.0, "friction_angle_deg": 32.0, "cohesion_pa": 0.0, "strength": "residual"}})");
  const auto calibration = [&](int seed, double contact_friction, double angle_deg, double asked_deg) {
    json one = printed;
    one["seed"] = seed;
    one["contact_friction"] = contact_friction;
    one["out"] = fmt::format("soil-{}.toml", seed);
    one["findings"][0]["number"] = angle_deg;
    one["target"]["friction_angle_deg"] = asked_deg;
    std::ofstream(fileOf(seed)) << one;
    return fileOf(seed);
  };
  const std::string files = calibration(1, 0.25, 32.4, 32) + " " + calibration(2, 0.27, 36.6, 32);
  const ProgramResult result = runHaptolith("lab collect --json " + files);
  ASSERT_EQ(result.exit_status, 0) << result.errors;
  const json answer = json::parse(result.output);
  EXPECT_NEAR(answer.at("results").at("contact_friction").at("mean"), 0.26, 1e-12);
  EXPECT_NEAR(answer.at("results").at("contact_friction").at("sd"), 0.02 / std::sqrt(2), 1e-12);
  EXPECT_NEAR(answer.at("findings").at(0).at("mean"), 34.5, 1e-12);
  EXPECT_EQ(answer.at("findings").at(0).at("passes"), false);
  EXPECT_THAT(runHaptolith("lab collect " + files).output,
              HasSubstr("soil calibrate: 32°, 0 Pa, 1500 kg/m³, contact friction, Moon, particles of R = 7 mm; 2"));
  expectRefused(files + " " + calibration(3, 0.25, 33, 33),
                HasSubstr("target/friction_angle_deg is 32.0 there and 33.0 here"));
}

TEST_F(LabCollect, SpecimensWithoutANumberAreToldAndNotMixedIn) {
  const std::string first = measured(1, kPayload);
  const std::string none = changed(1, [](json& specimen) {
    specimen["seed"] = 2;
    specimen["weight_ratio"] = nullptr;
    specimen["findings"][0]["number"] = nullptr;
  });
  const ProgramResult result = runHaptolith("lab collect --json " + first + " " + none);
  ASSERT_EQ(result.exit_status, 0) << result.errors;
  const json answer = json::parse(result.output);
  const json weight = answer.at("results").at("weight_ratio");
  EXPECT_EQ(weight.at("mean"), read(1).at("weight_ratio"));
  EXPECT_EQ(weight.at("sd"), nullptr);
  EXPECT_EQ(weight.at("specimens"), 1);
  EXPECT_EQ(answer.at("findings").at(0).at("passes"), false);
  EXPECT_THAT(runHaptolith("lab collect " + first + " " + none).output, HasSubstr("(none with 1 of 2 seeds)"));
}

TEST_F(LabCollect, CurvesOfOtherLengthsHaveNothingInCommon) {
  const std::string first = measured(1, kPayload);
  const auto with_curve = [&](int seed, const json& curve, bool stands) {
    const std::string path = fileOf(10 + seed);
    json specimen = read(1);
    specimen["seed"] = seed;
    specimen["curve"] = curve;
    specimen["stands"] = stands;
    std::ofstream(path) << specimen;
    return path;
  };
  const std::string files =
      with_curve(5, {1, 2}, true) + " " + with_curve(6, {3, 4}, false) + " " + with_curve(7, {3, 6}, true);
  const ProgramResult same = runHaptolith("lab collect --json " + files);
  ASSERT_EQ(same.exit_status, 0) << same.errors;
  const json results = json::parse(same.output).at("results");
  EXPECT_EQ(results.at("curve").at(1).at("mean"), 4);
  EXPECT_EQ(results.at("stands"), json({{"yes", 2}, {"specimens", 3}}));
  const ProgramResult other = runHaptolith("lab collect --json " + files + " " + with_curve(8, {3, 6, 9}, true));
  EXPECT_EQ(json::parse(other.output).at("results").at("curve"), nullptr);
}

TEST_F(LabCollect, RefusesWhatIsNotOneTest) {
  const std::string first = measured(1, kPayload), second = measured(2, kPayload);
  expectRefused(first + " " + first, HasSubstr("have the same seed 1"));
  const auto other = [&](const char* key, const json& value) {
    return first + " " + changed(2, [&](json& specimen) { specimen[key] = value; });
  };
  expectRefused(other("test", "free-fall"), HasSubstr("test is \"payload\" there and \"free-fall\" here"));
  expectRefused(other("body", "Mars"), HasSubstr("changed.json is not of the same test as "));
  expectRefused(other("program", "haptolith 0.0.1"), HasSubstr("haptolith 0.0.1"));
  expectRefused(other("options", json({{"particles", "61"}})),
                HasSubstr("options/particles is \"60\" there and \"61\" here"));
  expectRefused(first + " " + changed(2, [](json& specimen) { specimen["soil_keys"]["contact_friction"] = "0.9"; }),
                HasSubstr("soil_keys/contact_friction"));
  expectRefused(other("another_number", 1), HasSubstr("changed.json has other results than "));
}

TEST_F(LabCollect, ReadsTheNameOfATestInAnEarlierVersion) {
  const std::string first = measured(1, kPayload);
  const std::string former = changed(1, [](json& specimen) {
    specimen["seed"] = 2;
    specimen["test"] = "carry";
  });
  const ProgramResult result = runHaptolith("lab collect --json " + former + " " + first);
  ASSERT_EQ(result.exit_status, 0) << result.errors;
  EXPECT_EQ(json::parse(result.output).at("test"), "payload");
}

TEST_F(LabCollect, NamesTheFileThatIsCutOrForeign) {
  const std::string first = measured(1, kPayload), second = measured(2, kPayload);
  const auto file = [&](const std::string& content) {
    const std::string path = (folder_ / "bad.json").string();
    std::ofstream(path) << content;
    return first + " " + path;
  };
  std::ifstream stream(second);
  const std::string whole{std::istreambuf_iterator<char>(stream), {}};
  expectRefused(file(""), AllOf(HasSubstr("bad.json is empty"), HasSubstr("still running, or it failed")));
  expectRefused(file(whole.substr(0, whole.size() / 2)), HasSubstr("bad.json is truncated"));
  expectRefused(file(whole + whole), HasSubstr("bad.json is truncated, or is not one result"));
  expectRefused(file("[1, 2]"), HasSubstr("bad.json is not a result of `haptolith lab TEST --json`"));
  expectRefused(file("{\"seed\": 2}"), HasSubstr("bad.json is not a result of"));
  expectRefused(file("\x01\xff"), HasSubstr("bad.json is truncated"));
  expectRefused(
      file(json::parse(whole).patch(json::parse(R"([{"op": "replace", "path": "/seed", "value": -2}])")).dump()),
      HasSubstr("bad.json is not a result of"));
  expectRefused(file(runHaptolith("lab collect --json " + first).output), HasSubstr("name the file of each specimen"));
  expectRefused(first + " " + (folder_ / "none.json").string(), HasSubstr("none.json"), 2);
  expectRefused("", HasSubstr("FILES"), 2);
}

TEST_F(LabCollect, SeveralSeedsHaveNoFigureOfOne) {
  const ProgramResult result = runHaptolith("lab free-fall --seeds 2 --figure " + (folder_ / "fall.svg").string());
  EXPECT_EQ(result.exit_status, 2);
  EXPECT_THAT(result.errors, HasSubstr("left out with --seeds"));
  EXPECT_EQ(runHaptolith("lab free-fall --seeds 0").exit_status, 2);
}

}  // namespace
}  // namespace haptolith
