#pragma once

#include "sim/drive/ground.hpp"

#include <cstdint>
#include <vector>

namespace scanloom::robot {

/// Measures which share of the reachable free cells a body has covered. A cell is covered or reachable if its centre is
/// within the body's radius of a position of the body.
class CoverageMeter {
public:
    CoverageMeter() = default;

    /// @param places  for each cell of the ground's plan, 1 if the body's centre may be there, else 0
    CoverageMeter(const Ground& ground, const std::vector<std::uint8_t>& places);

    /// Covers the cells at a position of the body, in metres.
    void pass(const Ground& ground, const Point2& position);

    [[nodiscard]] double share() const noexcept; ///< 0 .. 1; 1 if no cell is reachable
    [[nodiscard]] double reachable_m2() const noexcept { return static_cast<double>(reachable_) * cell_m2_; }

private:
    std::vector<std::uint8_t> left_; // for each cell, 1 if reachable and not covered yet
    std::int64_t reachable_ = 0;     // cells
    std::int64_t passed_ = 0;
    double cell_m2_ = 0.0;
};

} // namespace scanloom::robot
