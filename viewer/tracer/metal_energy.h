#pragma once

#include <array>
#include <vector>

namespace xrds {

/// The share of white light that a GGX metal without absorption returns in a single scattering, on a grid of
/// kEnergySize cosines by as many roughnesses, both from 0 to 1. Entry i holds the corners of the grid's cell there: i,
/// i + 1, i + kEnergySize, i + kEnergySize + 1.
std::vector<std::array<float, 4>> metalEnergyTable();

}  // namespace xrds
