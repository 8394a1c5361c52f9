#pragma once

#include <haptolith/haptolith.h>

#include "haptolith/c_api/handles.h"
#include "haptolith/scene_file/soil_file.h"

struct hapto_soil : haptolith::library::HandleOf<haptolith::NamedSoil> {
  static constexpr std::uint32_t kKind = 0x4861536f;
};
