// Saves a bed, and continues a saved one.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "haptolith/bed/bed.h"
#include "haptolith/bed/start/bed_start.h"
#include "haptolith/core/error.h"

namespace haptolith {

namespace {

/// Whether two lists name the same neighbours, in whatever order.
bool sameNeighbours(const ContactLists& a, const ContactLists& b, std::size_t i) {
  const auto named = [i](const ContactLists& lists) {
    std::vector<std::int32_t> names;
    for (std::uint32_t s = 0; s < lists.count(i); ++s) {
      names.push_back(lists.neighbour(i, s));
    }
    std::ranges::sort(names);
    return names;
  };
  return named(a) == named(b);
}

/// The places of a saved bed's grains, in which a bed like it is built.
std::vector<Float4> grainsOf(const BedState& state) {
  const std::size_t n = state.particles();
  if (n == 0 || state.reference_position.size() < n || state.velocity.size() < n) {
    throw InvalidParameter("state", fmt::format("{} particles", n), "the state of a bed with particles");
  }
  return {state.reference_position.begin(), state.reference_position.begin() + static_cast<std::ptrdiff_t>(n)};
}

/// Height of the soil when the bed was made. @throws InvalidParameter.
double gridHeight(const SavedBed& saved) {
  constexpr Range kHeight_m{0, 1e3};
  return requireInRange("grid_height_m", saved.grid_height_m, kHeight_m);
}

/// @throws InvalidParameter unless arrays of particles and groups are as long as those of `own`.
void requireSameArrays(const BedState& state, const BedState& own) {
  const std::size_t n = own.particles();
  const std::size_t records = paddedCount(n);
  if (state.particles() != n || state.position.size() != records || state.velocity.size() != records ||
      state.reference_position.size() != records || state.rested_at.size() != records ||
      state.rested.size() != records / kGroup || state.contacts.particles() != n) {
    throw InvalidParameter("state", fmt::format("{} particles", state.particles()),
                           fmt::format("the state of this bed with {} particles", n));
  }
  if (state.remainder.size() != own.remainder.size()) {
    throw InvalidParameter("state", state.remainder.empty() ? "one for a narrow box" : "one for a wide box",
                           "one for a box like this");
  }
}

/// A saved state may come from a file: a position that is NaN would become the index of a cell. @throws
/// InvalidParameter.
void requireFinite(const BedState& state) {
  const auto is_number = [](const Float4& r) {
    return std::isfinite(r.x) && std::isfinite(r.y) && std::isfinite(r.z) && std::isfinite(r.w);
  };
  for (const auto* records_of :
       {&state.position, &state.velocity, &state.reference_position, &state.rested_at, &state.remainder}) {
    if (!std::all_of(records_of->begin(), records_of->end(), is_number)) {
      throw InvalidParameter("state", "positions, velocities or slips that are not finite", "finite");
    }
  }
}

/// The neighbour lists reach as far as the largest particles of this soil do, and groups keep their class.
/// @throws InvalidParameter.
void requireSameSizes(const BedState& state, const Bed& bed) {
  const SoilParameters& soil = bed.parameters().soil;
  const auto fitting = [&](const Float4& p) {
    const double scale = GrainClasses::scale(bed.classes().of(p.w));
    const double mean_m = (scale - 1) * soil.radius_m;
    constexpr float kRounding = 1e-6F;
    return std::abs(p.w - static_cast<float>(mean_m)) <=
           static_cast<float>(scale * largestExcess(soil)) + kRounding * std::abs(p.w) * (scale < 1 ? 1 : 0);
  };
  for (const auto* records_of : {&state.position, &state.reference_position}) {
    if (!std::all_of(records_of->begin(), records_of->end(), fitting)) {
      throw InvalidParameter("state", "particles of other sizes",
                             "particles with the size_spread and grading of this bed");
    }
  }
  for (std::size_t i = 0; i < bed.particles(); ++i) {
    if (bed.classes().of(state.position[i].w) != bed.classOf(i) ||
        bed.classes().of(state.reference_position[i].w) != bed.classOf(i)) {
      throw InvalidParameter("state", "particles of other classes", "particles of the classes of this bed, one by one");
    }
  }
}

/// @throws InvalidParameter unless the same particles are held, and sleep for ever, as in `own`.
void requireSameHeld(const BedState& state, const BedState& own) {
  for (std::size_t i = 0; i < own.particles(); ++i) {
    if (state.isHeld(i) != own.isHeld(i)) {
      throw InvalidParameter("state", fmt::format("particle {} {}", i, state.isHeld(i) ? "held" : "free"),
                             "the state of a bed that holds the same soil at its sides");
    }
  }
  for (std::size_t group = 0; group < state.rested.size(); ++group) {
    if ((state.rested[group] == BedState::kAsleepForEver) != (own.rested[group] == BedState::kAsleepForEver)) {
      throw InvalidParameter("state", fmt::format("group {} in another sleep state", group),
                             "always asleep where it is held");
    }
  }
}

/// @throws InvalidParameter unless contacts remember slips where this bed's do, and these are finite.
void requireSlips(const BedState& state, bool has_contact_friction) {
  const std::size_t n = state.particles();
  if (state.contacts.remembers() != has_contact_friction ||
      state.wall_slip.size() != (has_contact_friction ? paddedCount(n) / kGroup : 0)) {
    throw InvalidParameter("state", has_contact_friction ? "without a memory of friction" : "with a memory of friction",
                           "the state of a bed with the friction model of this bed");
  }
  const auto finite = [](float value) { return std::isfinite(value); };
  bool numbers = true;
  for (const WallSlips& slips : state.wall_slip) {
    for (const auto* slip :
         {&slips.floor_x, &slips.floor_y, &slips.x_wall_y, &slips.x_wall_z, &slips.y_wall_x, &slips.y_wall_z}) {
      numbers = numbers && std::ranges::all_of(*slip, finite);
    }
  }
  for (std::size_t i = 0; has_contact_friction && i < n; ++i) {
    for (std::uint32_t s = 0; s < state.contacts.count(i); ++s) {
      const Slip slip = state.contacts.slip(i, s);
      numbers = numbers && finite(slip.x) && finite(slip.y) && finite(slip.z);
    }
  }
  if (!numbers) {
    throw InvalidParameter("state", "a contact's slip that is NaN or infinite", "finite");
  }
}

}  // namespace

Bed::Bed(const BedParameters& parameters, const SavedBed& saved)
    : Bed(validated(parameters), grainsOf(saved.state), gridHeight(saved)) {
  const bool has_held = parameters.start == BedStart::kSettled || parameters.start == BedStart::kGiven;
  if (has_held) {
    std::size_t held = 0;
    for (std::size_t i = 0; i < particles(); ++i) {
      held += saved.state.isHeld(i) ? 1 : 0;
    }
    holdSides(particles() - held);
  }
  makeStones();
  restore(saved);
}

SavedBed Bed::save() const {
  return {.state = state_, .grid_height_m = grid_height_m_, .stones = stones_.save()};
}

void Bed::restore(const SavedBed& saved) {
  if (saved.grid_height_m != grid_height_m_) {  // else groupsNear() might find others
    throw InvalidParameter("grid_height_m", fmt::format("{}", saved.grid_height_m),
                           fmt::format("this bed's {}", grid_height_m_));
  }
  stones_.requireSound(saved.stones, particles());
  restore(saved.state);
  stones_.restore(saved.stones);
}

void Bed::restore(const BedState& state) {
  const std::size_t n = particles();
  requireSameArrays(state, state_);
  requireFinite(state);
  requireSameSizes(state, *this);
  requireSameHeld(state, state_);
  requireSlips(state, hasContactFriction());
  // Its lists must be those of its places; their order, which is the order of sums, is its own.
  ContactLists listed(n, hasContactFriction());
  const bool entered = neighbourhood_.buildAll(state.reference_position, listed);
  bool fits = entered;
  for (std::size_t i = 0; fits && i < n; ++i) {
    fits = sameNeighbours(listed, state.contacts, i);
  }
  if (!fits) {
    ContactLists own(n, hasContactFriction());
    (void)neighbourhood_.buildAll(state_.reference_position, own);  // the grid; it fitted when it was made
    throw InvalidParameter("state", entered ? "neighbours that do not match its positions" : "a collapsed bed",
                           entered ? "as it was saved" : "particles apart from each other");
  }
  state_.step = state.step;  // piece by piece: what is reserved stays reserved
  state_.position = state.position;
  state_.velocity = state.velocity;
  state_.remainder = state.remainder;
  state_.reference_position = state.reference_position;
  state_.rested = state.rested;
  state_.rested_at = state.rested_at;
  state_.wall_slip = state.wall_slip;
  std::ranges::fill(near_walls_, std::uint8_t{0xFF});
  state_.contacts.takeOver(state.contacts);
  std::ranges::fill(changed_, ++changes_);
  driven_ = 0;
  std::ranges::fill(external_, Float4{});
  pushed_.clear();
  std::ranges::fill(is_pushed_, std::uint8_t{0});
  std::ranges::fill(keep_awake_, std::uint64_t{0});
  for (std::size_t i = 0; i < n; ++i) {
    driven_ += state_.velocity[i].w == BedState::kDriven ? 1 : 0;
  }
  std::fill(state_.position.begin() + static_cast<std::ptrdiff_t>(n), state_.position.end(), kGhost);
  std::fill(state_.reference_position.begin() + static_cast<std::ptrdiff_t>(n), state_.reference_position.end(),
            kGhost);
  std::fill(state_.velocity.begin() + static_cast<std::ptrdiff_t>(n), state_.velocity.end(), kGhostVelocity);
  next_position_ = state_.position;  // sleeping particles are in both
  next_velocity_ = state_.velocity;
  wakefulness_.takeOver(state_);
  stones_.lookAgain();
}

}  // namespace haptolith
