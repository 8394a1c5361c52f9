#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <algorithm>
#include <set>
#include <string>

#include "program.h"

namespace haptolith {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

/// Privileges that such a user lacks. Under the address sanitizer mlockall() does nothing and reports success.
#ifdef __SANITIZE_ADDRESS__
constexpr const char* kLacking = "scheduler";
#else
constexpr const char* kLacking = "scheduler, memory lock";
#endif

/// The program for a user without privileges, for any user of the tests.
std::string withoutRights(const std::string& arguments) {
  const char* drop = geteuid() == 0 ? "setpriv --bounding-set=-sys_nice,-ipc_lock,-sys_resource " : "";
  return fmt::format("prlimit --rtprio=0 --memlock=65536 {}\"$HAPTOLITH\" {}", drop, arguments);
}

TEST(DoctorCommand, JsonIsOneObjectWithEveryCheck) {
  const ProgramResult result = runHaptolith("doctor --duration-s 0.5 --json");
  const json report = json::parse(result.output);
  std::set<std::string> names;
  bool lacking = false;
  for (const json& check : report.at("checks")) {
    EXPECT_EQ(check.size(), 5U);
    for (const char* key : {"name", "found", "needed"}) {
      EXPECT_NE(check.at(key).get<std::string>(), "") << check;
    }
    EXPECT_TRUE(check.at("remedy").is_string());
    EXPECT_THAT(check.at("verdict"), testing::AnyOf("ok", "could be better", "lacking"));
    lacking = lacking || check.at("verdict") == "lacking";
    names.insert(check.at("name"));
  }
  EXPECT_EQ(names, (std::set<std::string>{"kernel", "scheduler", "real-time share", "memory lock", "CPUs",
                                          "isolated CPUs", "CPU governor", "idle states", "machine", "wake-up"}));
  EXPECT_EQ(result.exit_status, lacking ? 1 : 0);
  EXPECT_EQ(report.at("verdict") == "lacking", lacking);
  EXPECT_EQ(report.at("wake_ups"), 500);
  EXPECT_TRUE(report.at("missed").is_number_unsigned());
  EXPECT_GE(report.at("seconds").get<double>(), 0.499);
  EXPECT_TRUE(report.at("cpu").is_null());
  EXPECT_TRUE(report.at("scheduler").is_string());
  EXPECT_TRUE(report.at("memory_locked").is_boolean());
  const json& late_us = report.at("late_us");
  for (const char* key : {"mean", "p50", "p99", "p99_9", "max"}) {
    EXPECT_GT(late_us.at(key).get<double>(), 0) << key;
  }
  EXPECT_EQ(late_us.at("buckets").at("count").size(), late_us.at("buckets").at("upper_end").size());
  int counted = 0;
  for (const json& count : late_us.at("buckets").at("count")) {
    counted += count.get<int>();
  }
  EXPECT_EQ(counted, 500);
  const json& soil = report.at("finest_soil");
  EXPECT_GT(soil.at("radius_mm").get<double>(), 1);
  EXPECT_GT(soil.at("particles").get<int>(), 100);
  EXPECT_GE(soil.at("threads").get<int>(), 1);
  EXPECT_TRUE(soil.at("in_time").is_boolean());
}

TEST(DoctorCommand, EndsWithWhatTheMachineCanDoInFiveLines) {
  const ProgramResult result = runHaptolith("doctor --duration-s 0.2");
  const std::size_t at = result.output.find("Summary of this machine\n\n");
  ASSERT_NE(at, std::string::npos) << result.output;
  const std::string lines = result.output.substr(result.output.find("\n\n", at) + 2);
  EXPECT_EQ(std::count(lines.begin(), lines.end(), '\n'), 5) << lines;
  for (const char* name : {"  finest soil    R = ", "  cores          ", "  priority       SCHED_", "  late wake-ups  ",
                           "  to change      "}) {
    EXPECT_THAT(lines, HasSubstr(name));
  }
}

TEST(DoctorCommand, WithoutRightsItSaysWhatIsLackingAndHowToMendIt) {
  const ProgramResult result = runInShell(withoutRights("doctor --duration-s 0.2"));
  EXPECT_EQ(result.exit_status, 1) << result.errors;
  EXPECT_THAT(result.errors, HasSubstr(fmt::format("the loop cannot run in real time here: {}", kLacking)));
  EXPECT_THAT(result.output, HasSubstr("  lacking          scheduler"));
  EXPECT_THAT(result.output, HasSubstr("needed: SCHED_FIFO at priority 80"));
  EXPECT_THAT(result.output, testing::AnyOf(HasSubstr("rtprio 80\" | sudo tee"), HasSubstr("--ulimit rtprio=80")));
  EXPECT_THAT(result.output, HasSubstr(fmt::format("No. Lacking: {}", kLacking)));
  EXPECT_THAT(result.output, Not(HasSubstr("\033["))) << "colours without a terminal";
  const json report = json::parse(runInShell(withoutRights("doctor --duration-s 0.2 --json")).output);
  EXPECT_EQ(report.at("scheduler"), "SCHED_OTHER");
  EXPECT_EQ(report.at("verdict"), "lacking");
}

TEST(DoctorCommand, CtrlCEndsItWithWhatWasMeasured) {
  // A busy machine may take longer than a second to begin.
  ProgramResult result;
  for (int seconds = 1; seconds <= 32 && result.output.empty(); seconds *= 2) {
    result = runInShell(
        fmt::format("timeout --preserve-status -s INT {} \"$HAPTOLITH\" doctor --duration-s 1000 --json", seconds));
  }
  const json report = json::parse(result.output);
  EXPECT_GT(report.at("wake_ups").get<int>(), 10);
  EXPECT_LT(report.at("seconds").get<double>(), 100);
}

TEST(DoctorCommand, MeasuresOnTheCpuItIsTold) {
  const ProgramResult result = runInShell("taskset -c 0 \"$HAPTOLITH\" doctor --duration-s 0.2 --json --cpu 0");
  EXPECT_EQ(json::parse(result.output).at("cpu"), 0) << result.errors;
  const ProgramResult text = runInShell("\"$HAPTOLITH\" doctor --duration-s 0.2 --cpu 0");
  EXPECT_THAT(text.output, HasSubstr("CPU 0)"));
  EXPECT_THAT(text.output, HasSubstr("the loop needs"));
}

TEST(DoctorCommand, WrongUseIsToldAndHasStatusTwo) {
  const struct {
    const char *arguments, *told;
  } cases[] = {{"--duration-s 0", "duration_s = 0 is not valid: must be 0.1 to "},
               {"--duration-s -1", "duration_s = -1"},
               {"--duration-s nan", "duration_s = nan"},
               {"--duration-s ten", "ten"},
               {"--seconds 0", "--seconds is now --duration-s"},
               {"--cpu 1024", "cpu = 1024"},
               {"--cpu 1023", "cpu = 1023 is not valid: must be -1 (any) or a CPU that this process may use: "},
               {"--cpu -2", "cpu = -2"},
               {"--cpu first", "first"},
               {"now", "now"}};
  for (const auto& [arguments, told] : cases) {
    const ProgramResult result = runInShell(fmt::format("timeout 20 \"$HAPTOLITH\" doctor {}", arguments));
    EXPECT_EQ(result.exit_status, 2) << arguments;
    EXPECT_THAT(result.errors, HasSubstr(told));
    EXPECT_TRUE(result.output.empty()) << arguments;
  }
}

}  // namespace
}  // namespace haptolith
