// The shovel is 5 mm thick, thinner than a particle of 14 mm, and moves by up to 1 mm in a tick. Nothing may slip
// through.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "haptolith/scene/scene.h"
#include "haptolith/soil/presets.h"

namespace haptolith {
namespace {

constexpr double kTick_s = 1e-3;

const Quat kLevel = Quat::Identity();
/// The blade upright, its large faces looking along x: the tool's x points down.
const Quat kBlade(Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitY()));

BedParameters p4() {
  BedParameters bed;
  bed.soil = findPreset("P4").soil;
  return bed;
}

Vec3 at(const Bed& bed, std::size_t i) {
  const Float4& p = bed.state().position[i];
  return {p.x, p.y, p.z};
}

/// A tool moved at constant velocity from one place to another.
void sweep(Scene& scene, const Quat& orientation, const Vec3& from, const Vec3& to, double speed_m_s,
           const std::function<void()>& each_tick = {}) {
  const int ticks = static_cast<int>(std::ceil((to - from).norm() / (speed_m_s * kTick_s)));
  const Twist twist{(to - from) / (ticks * kTick_s), Vec3::Zero()};
  scene.placeTool({{{from, orientation}, {}}});
  for (int i = 1; i <= ticks; ++i) {
    ASSERT_EQ(scene.tick({{{from + (to - from) * i / ticks, orientation}, twist}}), StepStatus::kOk) << i;
    if (each_tick) {
      each_tick();
    }
  }
}

/// One particle somewhere, without the rest of a bed.
class OneParticle {
 public:
  explicit OneParticle(const Vec3& centre, const Vec3& gravity = Vec3::Zero()) : scene_(parameters(gravity), {}) {
    // The others of the smallest bed go to the far corners' outside, where neither tool nor particle comes.
    BedState state = scene_.bed().state();
    for (auto* records : {&state.position, &state.reference_position}) {
      (*records)[0] = {static_cast<float>(centre.x()), static_cast<float>(centre.y()), static_cast<float>(centre.z()),
                       0};
    }
    scene_.bed().restore(state);
  }
  Scene& scene() { return scene_; }
  [[nodiscard]] Vec3 centre() const { return at(scene_.bed(), 0); }

 private:
  static BedParameters parameters(const Vec3& gravity) {
    BedParameters bed = p4();
    bed.gravity_m_s2 = gravity;
    bed.particles = 1;
    bed.layers = 1;
    bed.start = BedStart::kRain;
    return bed;
  }
  Scene scene_;
};

const double kSpeeds_m_s[] = {0.1, 0.2, 0.5, 1.0};

TEST(ThinPlate, PushesAFreeParticleBeforeIt) {
  for (const double speed : kSpeeds_m_s) {
    for (const double off_centre : {0.0, 0.01, 0.019}) {
      OneParticle one(Vec3(0.0, off_centre, 0.06));
      // The blade comes from -x with its face; the particle has to fly ahead of it.
      sweep(one.scene(), kBlade, Vec3(-0.05, 0, 0.06), Vec3(0.03, 0, 0.06), speed,
            [&] { ASSERT_GT(one.centre().x(), one.scene().toolPose().position_m.x()) << speed << " " << off_centre; });
      EXPECT_GT(one.centre().x(), 0.03);
    }
  }
}

TEST(ThinPlate, SqueezesAParticleAgainstAWallWithoutLettingItThrough) {
  for (const double speed : kSpeeds_m_s) {
    OneParticle one(Vec3(0.04, 0, 0.06));
    // Until the blade's face is 6 mm from the wall: 14 mm of particle in 6 mm.
    sweep(one.scene(), kBlade, Vec3(0.0, 0, 0.06), Vec3(0.063 - 0.006 - 0.0025, 0, 0.06), speed,
          [&] { ASSERT_GT(one.centre().x(), one.scene().toolPose().position_m.x()) << speed; });
    const Vec3 held = one.scene().toolPose().position_m;
    for (int i = 0; i < 500; ++i) {
      ASSERT_EQ(one.scene().tick({{{held, kBlade}, {}}}), StepStatus::kOk);
      ASSERT_GT(one.centre().x(), held.x()) << speed;
    }
    EXPECT_LT(one.scene().soilWrench().force_n.x(), -0.5);  // it pushes back
  }
}

TEST(ThinPlate, SqueezesAParticleAgainstTheFloorWithoutLettingItThrough) {
  for (const double speed : kSpeeds_m_s) {
    OneParticle one(Vec3(0, 0, 0.0068), Vec3(0, 0, -1.625));
    sweep(one.scene(), kLevel, Vec3(0.005, 0.003, 0.06), Vec3(0.005, 0.003, 0.006 + 0.0025), speed,
          [&] { ASSERT_LT(one.centre().z(), one.scene().toolPose().position_m.z()) << speed; });
    EXPECT_GT(one.scene().soilWrench().force_n.z(), 0.5);
  }
}

/// Which side of the tool's middle plane each particle is on, while it is over the face's outline; 0 elsewhere.
std::vector<int> sidesUnderOutline(const Scene& scene) {
  std::vector<int> sides;
  const Vec3 half = scene.tool().size_m / 2;
  for (std::size_t i = 0; i < scene.bed().particles(); ++i) {
    const Vec3 p = scene.toolPose().toBody(at(scene.bed(), i));
    const bool over_face = std::abs(p.x()) < half.x() && std::abs(p.y()) < half.y();
    sides.push_back(!over_face ? 0 : p.z() > 0 ? 1 : -1);
  }
  return sides;
}

/// Counts particles that change sides without ever having left the outline in between.
class PassageCounter {
 public:
  void look(const Scene& scene) {
    const std::vector<int> now = sidesUnderOutline(scene);
    last_.resize(now.size());
    for (std::size_t i = 0; i < now.size(); ++i) {
      const double near = std::abs(scene.toolPose().toBody(at(scene.bed(), i)).z());
      passages_ += now[i] * last_[i] < 0 && near < 0.03 ? 1 : 0;
      seen_ += now[i] != 0 && near < 0.01 ? 1 : 0;
      last_[i] = now[i];
    }
  }
  [[nodiscard]] int passages() const { return passages_; }
  [[nodiscard]] int seen() const { return seen_; }

 private:
  std::vector<int> last_;
  int passages_ = 0, seen_ = 0;
};

TEST(ThinPlate, NothingPassesThroughALevelShovelPushedDownIntoThePapersScene) {
  for (const double speed : kSpeeds_m_s) {
    Scene scene(p4(), {});
    PassageCounter counter;
    sweep(scene, kLevel, Vec3(0, 0, 0.08), Vec3(0, 0, 0.012), speed, [&] { counter.look(scene); });
    EXPECT_EQ(counter.passages(), 0) << speed;
    EXPECT_GT(counter.seen(), 10);
  }
}

TEST(ThinPlate, NothingPassesThroughABladeSweptThroughThePapersScene) {
  for (const double speed : kSpeeds_m_s) {
    Scene scene(p4(), {});
    PassageCounter counter;
    sweep(scene, kBlade, Vec3(-0.04, 0, 0.1), Vec3(-0.04, 0, 0.03), 0.1, [&] { counter.look(scene); });
    sweep(scene, kBlade, Vec3(-0.04, 0, 0.03), Vec3(0.04, 0, 0.03), speed, [&] { counter.look(scene); });
    EXPECT_EQ(counter.passages(), 0) << speed;
    EXPECT_GT(counter.seen(), 10);
  }
}

}  // namespace
}  // namespace haptolith
