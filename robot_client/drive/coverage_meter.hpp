#pragma once

#include "robot_client/drive/ground.hpp"

#include <cstdint>
#include <vector>

namespace scanloom::robot {

/// How much of the free cells a body has passed over, of those it can reach: whose centres are within the body's
/// radius of a place where the body may be.
class CoverageMeter {
public:
    CoverageMeter() = default;

    /// @param places  cells of the ground's plan where the body's centre may be, 0 or 1
    CoverageMeter(const Ground& ground, const std::vector<std::uint8_t>& places);

    /// The body is there.
    void pass(const Ground& ground, const Point2& position);

    [[nodiscard]] double share() const noexcept; ///< 0 .. 1; 1 where nothing can be reached
    [[nodiscard]] double reachable_m2() const noexcept { return static_cast<double>(reachable_) * cell_m2_; }

private:
    std::vector<std::uint8_t> left_; // of what is reachable
    std::int64_t reachable_ = 0;     // cells
    std::int64_t passed_ = 0;
    double cell_m2_ = 0.0;
};

} // namespace scanloom::robot
