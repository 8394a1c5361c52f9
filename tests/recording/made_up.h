#pragma once

#include <cstdint>

#include "haptolith/recording/recording_format.h"

namespace haptolith {

/// A header in which every entry has a different value.
RecordingHeader madeUpHeader();

/// Tick number n: every member has a different value, among them NaN, infinity, -0 and the smallest number.
TickRecord madeUpTick(std::uint64_t n);

ParticleFrame madeUpFrame(std::uint64_t n, std::size_t particles);

/// All members of a record as bytes, written down member by member and so without tickColumns().
std::vector<std::uint64_t> bitsOf(const TickRecord& tick);

}  // namespace haptolith
