#include "haptolith/bed/stone_contact.h"

#include <algorithm>
#include <cmath>

#include "haptolith/bed/kernel/friction-inl.h"
#include "haptolith/core/assert.h"

namespace haptolith {

namespace {

namespace law = HWY_NAMESPACE;

law::LawOf<double> repulsionOf(const ContactLaw& of) {
  return {of.gamma_nm, of.a_min_m, of.a_thr_m, of.h_n, of.stiffness_n_m};
}

}  // namespace

StoneContactLaw::StoneContactLaw(const SoilParameters& soil, const TouchingBodies& bodies, double friction_ratio) {
  const auto [a_m, b_m, a_kg, b_kg] = bodies;
  const SoilParameters between = rescaled(soil, 2 * a_m * b_m / (a_m + b_m));
  law_ = makeContactLaw(between);
  law_.cohesion_n = 0;
  law_.cutoff_m = law_.diameter_m;
  friction_ = friction_ratio * between.contact_friction;
  tangential_n_m_ = between.tangential_ratio * between.stiffness_n_m;
  const double damping = between.damping_ratio * std::sqrt(4 * a_kg * b_kg / (a_kg + b_kg));
  damping_ = damping * std::sqrt(law_.gamma_nm);
  lag_s_ = damping / std::sqrt(tangential_n_m_);
}

StoneContactLaw StoneContactLaw::withGrains(const SoilParameters& soil, const TouchingBodies& bodies) {
  StoneContactLaw law(soil, bodies, 1);
  const ContactLaw of_grains = makeContactLaw(soil);
  law.law_.cohesion_n = of_grains.cohesion_n;
  law.law_.cohesion_range_m = of_grains.cohesion_range_m;
  law.law_.cutoff_m = law.law_.diameter_m + (of_grains.cutoff_m - of_grains.diameter_m);
  return law;
}

StoneContactLaw StoneContactLaw::bare(const SoilParameters& soil, const TouchingBodies& bodies, double friction_ratio) {
  return {soil, bodies, friction_ratio};
}

ContactFrictionLaw StoneContactLaw::inKernel() const {
  const auto f = [](double value) { return static_cast<float>(value); };
  return {.normal = kernelLaw(law_, law_.diameter_m / 2),
          .diameter_deficit = 0,
          .cohesion = f(law_.cohesion_n),
          .two_per_range = f(2 / law_.cohesion_range_m),
          .damping = f(damping_),
          .friction = f(friction_),
          .stiffness = f(tangential_n_m_),
          .lag = f(lag_s_)};
}

void OverlapOfSpheres::add(const Vec3& apart_m, double radii_m) noexcept {
  HAPTO_ASSERT(radii_m > 0);
  const double squared = apart_m.squaredNorm();
  if (const double beyond_m = radii_m - nearest_.depth_m;
      squared >= beyond_m * beyond_m && squared >= radii_m * radii_m) {
    return;  // outside, and not the nearest
  }
  const double distance_m = std::sqrt(squared);
  const double depth_m = radii_m - distance_m;
  const Vec3 towards = distance_m > 0 ? Vec3(apart_m / distance_m) : Vec3(Vec3::UnitZ());
  if (depth_m > nearest_.depth_m) {
    nearest_ = {depth_m, towards, 1};
  }
  if (depth_m > 0) {
    const double cubed = depth_m * depth_m * depth_m;
    gradient_ += cubed * towards;
    fourth_ += cubed * depth_m;
  }
}

Overlap OverlapOfSpheres::overlap() const noexcept {
  if (fourth_ == 0) {
    return nearest_;
  }
  const double depth_m = std::sqrt(std::sqrt(fourth_));
  const Vec3 gradient = gradient_ / (depth_m * depth_m * depth_m);
  const double steepness = gradient.norm();
  // Between two of equal depth from opposite sides the way out is undefined.
  return steepness > 0 ? Overlap{depth_m, gradient / steepness, steepness} : nearest_;
}

Vec3 StoneContactLaw::force(const Overlap& overlap, const Vec3& relative_m_s, double dt_s,
                            Vec3& stretch_m) const noexcept {
  const Vec3& n = overlap.towards;
  const law::LawOf<double> repulsion = repulsionOf(law_);
  const law::CohesionOf<double> cohesion{law_.cohesion_n, 2 / law_.cohesion_range_m, 0, 1};
  const double a = law_.diameter_m - overlap.depth_m;
  const law::CohesiveContact<double> contact = law::cohesiveContact(repulsion, cohesion, law_.diameter_m, a);
  const double parting = relative_m_s.dot(n);
  const double damped = contact.normal - damping_ * law::rootOfStiffness(repulsion, a) * overlap.steepness * parting;
  const double push = overlap.steepness * std::max(damped, std::min(contact.normal, 0.0));  // damping never pulls
  const Vec3 sliding = relative_m_s - parting * n;
  const law::FrictionOf<double> friction{dt_s, -tangential_n_m_, lag_s_};
  law::Triple<double> stretch{stretch_m.x(), stretch_m.y(), stretch_m.z()};
  const law::Triple<double> drag = law::frictionForce<double>(
      friction, law::Touches(), friction_ * overlap.steepness * contact.compression / tangential_n_m_,
      {n.x(), n.y(), n.z()}, {sliding.x(), sliding.y(), sliding.z()}, stretch);
  stretch_m = {stretch.x, stretch.y, stretch.z};
  return push * n + Vec3(drag.x, drag.y, drag.z);
}

double StoneContactLaw::energy(double depth_m, const Vec3& stretch_m) const noexcept {
  return contactEnergy(law_, law_.diameter_m - depth_m) + tangential_n_m_ / 2 * stretch_m.squaredNorm();
}

}  // namespace haptolith
