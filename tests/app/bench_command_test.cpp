#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "program.h"

namespace haptolith {
namespace {

using nlohmann::json;
using testing::HasSubstr;

TEST(BenchCommand, PrintsARowForEveryCombination) {
  const ProgramResult result = runHaptolith("bench --particles 256,600 --threads 1,2 --duration-s 0.2 --json");
  ASSERT_EQ(result.exit_status, 0) << result.errors;
  const json answer = json::parse(result.output);
  EXPECT_GE(answer.at("timer_late_us").at("p99").get<double>(), 0);
  ASSERT_EQ(answer.at("rows").size(), 8U);
  for (const json& row : answer.at("rows")) {
    EXPECT_EQ(row.at("ticks"), 200);
    EXPECT_EQ(row.at("hand"), "stir");
    EXPECT_GT(row.at("particles").get<int>(), 100);
    EXPECT_LE(row.at("awake").get<int>(), row.at("particles").get<int>());
    EXPECT_GT(row.at("particle_steps_per_s").get<double>(), 1e5);
    const json& tick = row.at("tick_us");
    EXPECT_LE(tick.at("p50").get<double>(), tick.at("p99").get<double>());
    EXPECT_LE(tick.at("p99").get<double>(), tick.at("p99_9").get<double>());
    EXPECT_LE(tick.at("p99_9").get<double>(), tick.at("max").get<double>());
    EXPECT_LE(row.at("rebuild_us").at("max").get<double>(), tick.at("max").get<double>());
    EXPECT_GT(row.at("memory_bytes_per_particle").get<double>(), 100);
    EXPECT_FALSE(row.at("simd").get<std::string>().empty());
  }
}

TEST(BenchCommand, RefusesWhatCannotBe) {
  for (const char* wrong :
       {"--particles 0", "--threads 0", "--friction-model none", "--motion scoop", "--duration-s 0"}) {
    const ProgramResult result = runHaptolith(std::string("bench ") + wrong);
    EXPECT_EQ(result.exit_status, 2) << wrong << result.errors;
    EXPECT_THAT(result.errors, HasSubstr("error:")) << wrong;
  }
}

}  // namespace
}  // namespace haptolith
