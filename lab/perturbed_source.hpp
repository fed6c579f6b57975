#pragma once

#include "robot_client/sources/source.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>

namespace scanloom::lab {

/// Changes to a log that an estimator must tolerate.
struct Perturbation {
    double odometry_scale = 1.0; ///< factor of x, y and yaw of each motion between successive scans of the log
    std::size_t skip = 0;        ///< scans that are left out at the start
    std::size_t every = 1;       ///< of the scans after these, the first and every `every`-th one after it are taken

    /// Returns whether scans of the log are left out.
    [[nodiscard]] bool drops_scans() const noexcept { return skip > 0 || every > 1; }
};

/// The scans of a source with a perturbation. The odometry of the first scan of the source is unchanged. Poses are
/// those of the source.
class PerturbedSource final : public robot::Source {
public:
    /// @param source        not read by others; must outlive this object
    /// @param perturbation  every > 0
    PerturbedSource(robot::Source& source, const Perturbation& perturbation)
        : source_(source), perturbation_(perturbation) {}

    /// Errors: those of the source.
    [[nodiscard]] Result<std::optional<robot::Observation>> next() override;
    [[nodiscard]] std::optional<std::uint64_t> scan_count() const override;

private:
    void scale_odometry(Scan& scan);

    robot::Source& source_;
    Perturbation perturbation_;
    std::uint64_t read_ = 0;        ///< scans of the source
    std::optional<Pose2> original_; ///< newest odometry of the source
    Pose2 scaled_;                  ///< the same, scaled
};

} // namespace scanloom::lab
