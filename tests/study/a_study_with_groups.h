#pragma once

#include <string>

namespace haptolith {

/// Two groups, one of which goes through both blocks; strata of a choice and of a number.
inline const std::string kTwoGroups = R"toml(
title = "Two groups"
consent = "Do you agree?"
order = "latin-square"
[assignment]
method = "stratified"
block_size = 4
strata = ["hand", "age"]
[[groups]]
name = "both"
[[groups]]
name = "weight"
blocks = ["gravity"]
[[demographics]]
key = "hand"
label = "Which hand do you write with?"
kind = "choice"
choices = ["left", "right"]
required = true
[[demographics]]
key = "age"
label = "Age"
kind = "number"
low = 18
high = 99
cut_points = [30, 50]
required = true
[[block]]
name = "friction"
question = "Was the second more resistant?"
answers = ["less", "more"]
varies = "preset"
reference = "P3"
levels = ["P1", "P2", "P4", "P5", "P6"]
between_intervals_s = 0
between_trials_s = 0
[[block]]
name = "gravity"
question = "Was the second heavier?"
answers = ["lighter", "heavier"]
varies = "body"
reference = "Moon"
levels = ["Ceres", "Pluto", "Europa", "Mars", "Earth"]
log_axis = true
between_intervals_s = 0
between_trials_s = 0
)toml";

}  // namespace haptolith
