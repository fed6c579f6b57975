#include "lab/perturbed_source.hpp"

namespace scanloom::lab {

Result<std::optional<robot::Observation>> PerturbedSource::next() {
    for (;;) {
        auto observation = source_.next();
        if (!observation || !*observation) return observation;
        scale_odometry((*observation)->scan);
        const std::uint64_t index = read_++;
        if (index >= perturbation_.skip && (index - perturbation_.skip) % perturbation_.every == 0) return observation;
    }
}

std::optional<std::uint64_t> PerturbedSource::scan_count() const {
    const auto count = source_.scan_count();
    if (!count) return std::nullopt;
    if (*count <= perturbation_.skip) return 0;
    return (*count - perturbation_.skip - 1) / perturbation_.every + 1;
}

/// The motions of scans that are left out are scaled as well.
void PerturbedSource::scale_odometry(Scan& scan) {
    if (!scan.odometry || perturbation_.odometry_scale == 1.0) return;
    const double scale = perturbation_.odometry_scale;
    if (original_) {
        const Pose2 motion = compose(inverse(*original_), *scan.odometry);
        scaled_ = compose(scaled_, {scale * motion.x, scale * motion.y, scale * motion.yaw});
    } else {
        scaled_ = *scan.odometry;
    }
    original_ = scan.odometry;
    scan.odometry = scaled_;
}

} // namespace scanloom::lab
