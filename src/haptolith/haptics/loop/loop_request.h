#pragma once

#include <variant>

#include "haptolith/bed/bed.h"
#include "haptolith/bed/kernel/soil_laws.h"
#include "haptolith/core/vec.h"
#include "haptolith/tool/tool_parameters.h"

namespace haptolith {

struct ShownScene;

/// Requests of other threads to a running loop. They are carried out between two ticks.
namespace request {

struct Pause {};  ///< pauses time, and sets the force to zero
struct Resume {};
struct Advance {  ///< runs a number of ticks while it is paused
  int ticks = 1;
};
struct Speed {  ///< slow motion: a simulated second takes 1 / factor seconds; for simulated hands only
  double factor = 1;
};
struct Gravity {
  Vec3 gravity_m_s2;
};
struct Soil {  ///< one that the bed isCompatible()
  SoilLaws laws;
};
/// A little more or less friction and cohesion, and friction of the tool in it: a step of one in a tick at most, so
/// that a recording knows which tick each one came before.
struct Adjust {
  SoilLaws laws;  ///< see Bed::adjustSoil()
  double tool_friction = 0;
};
/// Moves a particle if that is allowed (Scene::moveGrain()): also at most one per tick. Not to be requested
/// while time is paused: requests behind a second one, also the end of the pause, would wait for a tick.
struct MoveGrain {
  GrainMove move;
};
struct SetContact {  ///< whether the tool touches the soil: it fades into it, or out of it
  bool on = true;
};

// The tool fades out of the soil before these, and into it again afterwards: no hand feels a jump, and soil that finds
// itself inside the tool is moved out of its way instead of shot.
struct ReplaceTool {  ///< must be as stiff as the one before: see Scene::setTool()
  ToolParameters tool;
  std::size_t number = 0;
};
struct ReplaceBed {
  ShownScene* shown = nullptr;
};
using Replace = std::variant<ReplaceTool, ReplaceBed>;

}  // namespace request

using LoopRequest =
    std::variant<request::Pause, request::Resume, request::Advance, request::Speed, request::Gravity, request::Soil,
                 request::Adjust, request::MoveGrain, request::SetContact, request::Replace>;

}  // namespace haptolith
