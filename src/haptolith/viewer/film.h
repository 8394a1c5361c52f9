#pragma once

#include <functional>
#include <string_view>

#include "haptolith/recording/recorded_pictures.h"

namespace haptolith {

/// First bytes of a film: docs/reference/web-messages.md.
inline constexpr std::string_view kFilmMagic = "haptolith film 1";

/// A recording as the messages that a page is sent, one after the other: what a browser plays without a program. Until
/// the bed is another one, with other grains. Given to `write` piece by piece. Not for the tick.
/// @throws Failure when this program cannot read the recorded scene, as RecordedPictures::forEach(), and what `write`
/// throws.
void exportFilm(RecordedPictures& pictures, std::string_view version,
                const std::function<void(std::string_view)>& write);

}  // namespace haptolith
