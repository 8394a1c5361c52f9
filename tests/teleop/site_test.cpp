#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "haptolith/scene/scene.h"
#include "haptolith/teleop.h"
#include "haptolith/teleop/link/site_packet.h"
#include "haptolith/teleop/operator/site_map.h"
#include "haptolith/teleop/robot/site_camera.h"

namespace haptolith {
namespace {

constexpr double kTick_s = 1e-3;

SitePacket somePacket() {
  SitePacket packet;
  packet.robot_connection = 7;
  packet.grid = {-0.25, -0.5, 0.125, 20, 3};
  packet.column = 16;
  packet.row = 1;
  packet.columns = 4;
  packet.rows = 2;
  packet.number = 123456789012;
  packet.index = 42;
  packet.steps = {0, 1, -1, 32767, -32767, SitePacket::kNotSeen, 5, 6};
  return packet;
}

template <class T>
Packet with(std::size_t at, T value) {
  Packet bytes = bytesOf(somePacket());
  std::memcpy(bytes.data() + at, &value, sizeof value);
  return bytes;
}

TEST(SitePacket, ComesOutAsItWentIn) {
  const SitePacket packet = somePacket();
  const Packet bytes = bytesOf(packet);
  EXPECT_EQ(bytes.size(), SitePacket::kHeaderBytes + 2 * packet.steps.size());
  const auto parsed = parseSite(bytes);
  ASSERT_TRUE(parsed);
  EXPECT_EQ(parsed->robot_connection, packet.robot_connection);
  EXPECT_EQ(parsed->grid, packet.grid);
  EXPECT_EQ(std::vector({parsed->column, parsed->row, parsed->columns, parsed->rows}),
            (std::vector<std::size_t>{16, 1, 4, 2}));
  EXPECT_EQ(parsed->number, packet.number);
  EXPECT_EQ(parsed->index, packet.index);
  EXPECT_EQ(parsed->steps, packet.steps);
}

TEST(SitePacket, IsTheCHeadersStructure) {
  static_assert(sizeof(hapto_teleop_site_header) == SitePacket::kHeaderBytes);
  static_assert(HAPTO_TELEOP_SITE_SIDE == SitePacket::kSide);
  static_assert(HAPTO_TELEOP_NOT_SEEN == SitePacket::kNotSeen);
  hapto_teleop_site_header header;
  std::memcpy(&header, bytesOf(somePacket()).data(), sizeof header);
  EXPECT_EQ(std::string_view(header.magic, 4), "HLTM");
  EXPECT_EQ(header.version, HAPTO_TELEOP_VERSION);
  EXPECT_EQ(header.robot_session, 7U);
  EXPECT_EQ(header.map_columns, 20);
  EXPECT_EQ(header.map_rows, 3);
  EXPECT_EQ(header.corner_m[1], -0.5F);
  EXPECT_EQ(header.cell_m, 0.125F);
  EXPECT_EQ(header.column, 16);
  EXPECT_EQ(header.row, 1);
  EXPECT_EQ(header.columns, 4);
  EXPECT_EQ(header.rows, 2);
  EXPECT_EQ(header.number, 123456789012U);
  EXPECT_EQ(header.index, 42U);
}

TEST(SitePacket, RefusesWhatMakesNoSense) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(parseSite(bytesOf(somePacket())));
  EXPECT_FALSE(parseSite({}));
  EXPECT_FALSE(parseSite(with(0, 'X')));
  EXPECT_FALSE(parseSite(with<std::uint16_t>(4, 2))) << "of another version";
  EXPECT_FALSE(parseSite(with<std::uint32_t>(8, 0))) << "no connection";
  EXPECT_FALSE(parseSite(with<std::uint16_t>(12, 19))) << "beyond the map";
  EXPECT_FALSE(parseSite(with<std::uint16_t>(14, 1025))) << "too large a map";
  SitePacket large = somePacket();
  large.grid.columns = 256;
  large.grid.rows = 256;
  EXPECT_TRUE(parseSite(bytesOf(large)));
  large.grid.rows = 257;
  EXPECT_FALSE(parseSite(bytesOf(large))) << "more than anybody shows";
  EXPECT_FALSE(parseSite(with(16, kNan)));
  EXPECT_FALSE(parseSite(with(20, 101.0F)));
  EXPECT_FALSE(parseSite(with(24, kNan)));
  EXPECT_FALSE(parseSite(with(24, 0.0F)));
  EXPECT_FALSE(parseSite(with<std::uint16_t>(28, 17))) << "beyond the map";
  EXPECT_FALSE(parseSite(with<std::uint16_t>(32, 0)));
  EXPECT_FALSE(parseSite(with<std::uint16_t>(34, 17)));
  EXPECT_FALSE(parseSite(with<std::uint16_t>(34, 1))) << "more cells than it says";
  Packet cut = bytesOf(somePacket());
  cut.pop_back();
  EXPECT_FALSE(parseSite(cut));
  std::mt19937 random(5);
  for (int i = 0; i < 20000; ++i) {  // none may be read beyond its end
    Packet bytes = bytesOf(somePacket());
    bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    bytes.resize(random() % 2 == 0 ? bytes.size() : random() % bytes.size());
    if (const auto packet = parseSite(bytes)) {
      EXPECT_EQ(packet->steps.size(), packet->columns * packet->rows);
    }
  }
}

TEST(SiteMap, TakesPacketsThatAreNumberedFromZero) {
  SiteMap map;
  SitePacket packet = somePacket();
  packet.number = 0;
  EXPECT_TRUE(map.take(packet));
  EXPECT_FALSE(map.take(packet)) << "again";
  packet.number = 1;
  EXPECT_TRUE(map.take(packet));
  EXPECT_EQ(map.taken(), 2U);
}

TEST(SiteMap, KnowsTheNewestOfEachCellInWhateverOrderItCame) {
  SiteMap map;
  EXPECT_TRUE(map.empty());
  SitePacket packet = somePacket();
  EXPECT_TRUE(map.take(packet));
  EXPECT_EQ(map.heights().size(), 60U);
  EXPECT_TRUE(std::isnan(map.heights()[0])) << "not told yet";
  EXPECT_DOUBLE_EQ(map.heights()[1 * 20 + 19], 3.2767);
  EXPECT_EQ(map.commands()[1 * 20 + 19], 42U);
  EXPECT_TRUE(std::isnan(map.heights()[2 * 20 + 17])) << "not seen";
  packet.number -= 1;
  packet.steps.assign(8, 100);
  EXPECT_FALSE(map.take(packet)) << "late";
  EXPECT_DOUBLE_EQ(map.heights()[1 * 20 + 19], 3.2767);
  packet.number += 2;
  EXPECT_TRUE(map.take(packet));
  EXPECT_DOUBLE_EQ(map.heights()[1 * 20 + 19], 0.01);
  EXPECT_EQ(map.taken(), 2U);
  packet.robot_connection = 8;  // another robot: nothing is known of its site
  packet.number = 1;
  packet.columns = packet.rows = 1;
  packet.steps = {50};
  EXPECT_TRUE(map.take(packet));
  EXPECT_DOUBLE_EQ(map.heights()[1 * 20 + 16], 0.005);
  EXPECT_TRUE(std::isnan(map.heights()[1 * 20 + 19]));
}

TEST(SiteCamera, TellsTheWholeSiteAndThenFirstWhatChanges) {
  BedParameters parameters;
  parameters.soil.friction = FrictionModel::kContact;
  parameters.start = BedStart::kPacked;
  parameters.width_m = 0.2;
  parameters.length_m = 0.4;
  parameters.soil.radius_m = 0.004;
  Scene scene(parameters, ToolParameters());
  const double surface_m = meanSurfaceHeight(scene.bed());
  for (const Work work : {Work::kAtOnce, Work::kBeside}) {
    SiteCamera camera(scene.bed(), surface_m, 0.01, kTick_s, work);
    EXPECT_DOUBLE_EQ(camera.grid().cell_m, 0.008);
    EXPECT_GT(camera.grid().columns, SitePacket::kSide) << "more than one part";
    SiteMap map;
    std::uint64_t packets = 0;
    for (int tick = 0; tick < 20000 && packets < 30; ++tick) {
      if (work == Work::kBeside) {
        std::this_thread::sleep_for(std::chrono::microseconds(100));
      }
      if (std::optional<SitePacket> packet = camera.tick(static_cast<std::uint64_t>(tick))) {
        packet->robot_connection = 1;
        const auto sent = parseSite(bytesOf(*packet));
        ASSERT_TRUE(sent);
        map.take(*sent);
        ++packets;
      }
    }
    ASSERT_EQ(packets, 30U);
    ASSERT_EQ(map.heights().size(), camera.heights().size());
    double sum_m = 0;
    for (std::size_t cell = 0; cell < map.heights().size(); ++cell) {
      ASSERT_NEAR(map.heights()[cell], camera.heights()[cell], 0.51 * SitePacket::kStep_m) << cell;
      sum_m += map.heights()[cell];
    }
    EXPECT_NEAR(sum_m / static_cast<double>(map.heights().size()), 0, 1e-3) << "over the site's zero";
  }
  // A grain that is put elsewhere: its part comes next, whichever was sent longest ago.
  SiteCamera camera(scene.bed(), surface_m, 0.01, kTick_s);
  std::vector<std::pair<std::size_t, std::size_t>> told;
  const auto look = [&](int ticks) {
    told.clear();
    for (int tick = 0; tick < ticks; ++tick) {
      if (const std::optional<SitePacket> packet = camera.tick(0)) {
        told.emplace_back(packet->column, packet->row);
      }
    }
  };
  look(250);
  ASSERT_EQ(told.size(), 25U);
  EXPECT_EQ(told[24], told[0]) << "one of six after the other";
  SavedBed saved = scene.bed().save();
  saved.state.position[0] = {0, 0.19F, static_cast<float>(surface_m + 0.1), saved.state.position[0].w};
  scene.bed().restore(saved);
  look(20);
  const std::pair<std::size_t, std::size_t> where(0, 32);
  EXPECT_TRUE(told[0] == where || told[1] == where) << "the place that it came from may come before it";
}

}  // namespace
}  // namespace haptolith
