#pragma once

#include <haptolith/haptolith.h>

#include <optional>
#include <string>

#include "haptolith/library/handles.h"
#include "haptolith/scenario/soil_file.h"

namespace haptolith::library {

/// A soil behind a handle.
struct SoilObject {
  std::string name;
  SoilParameters soil;
  std::optional<SoilFile> file;  ///< none: one of the paper's presets, of which nothing was measured
};

}  // namespace haptolith::library

struct hapto_soil : haptolith::library::HandleOf<haptolith::library::SoilObject> {
  static constexpr std::uint32_t kKind = 0x4861536f;
};
