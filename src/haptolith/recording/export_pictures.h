#pragma once

#include <functional>
#include <string_view>

#include "haptolith/core/files/atomic_folder.h"
#include "haptolith/recording/recorded_pictures.h"

// The pictures of a recording for other programs; what is in each format: docs/how-to/export.md. Not for the
// tick.

namespace haptolith {

/// particles.xdmf, tool.xdmf and box.xdmf, and pictures.h5, which they refer to.
/// @throws Failure when the disk does not take them, and as RecordedPictures::forEach().
void exportXdmf(RecordedPictures& pictures, const AtomicFolder& folder);

/// A .vtu for the particles and one for the tool of each picture, particles.pvd and tool.pvd with their times, and
/// box.vtu. @throws as exportXdmf().
void exportVtk(RecordedPictures& pictures, const AtomicFolder& folder);

/// CSV with a line for each particle of each picture, given to `write` piece by piece.
/// @throws as RecordedPictures::forEach(), and what `write` throws.
void exportParticlesCsv(RecordedPictures& pictures, const std::function<void(std::string_view)>& write);

}  // namespace haptolith
