#pragma once

namespace hand_in_the_loop {

/// Judges stand-ins whose answers are known by paper and pencil; prints what differs.
/// @returns the number of checks that failed.
int selfTest();

}  // namespace hand_in_the_loop
