#include "core/localization/estimation_state.hpp"

#include "common/archive/archive.hpp"

#include <algorithm>
#include <utility>

namespace scanloom::localization {
namespace {

/// Returns a writer to which the scans of keyframes and the corrections are known, and adds these to the state.
archive::Writer writer_of(const SessionPoses& poses, EstimationState& state) {
    const auto& graph = poses.map().graph();
    state.scans.reserve(graph.size());
    for (std::size_t n = 0; n < graph.size(); ++n) state.scans.push_back(graph[n].scan);
    state.corrections = poses.corrections();
    archive::Writer writer;
    constexpr std::size_t kBytesOfScan = 256; // about; without it, bytes are copied often
    writer.reserve(kBytesOfScan * poses.scan_count());
    writer.share(state.scans);
    writer.share(state.corrections);
    return writer;
}

/// Returns whether maps can show scans at these poses.
bool are_near(const mapping::EstimatedPosesView& poses) {
    for (std::size_t n = 0; n < poses.size(); ++n) {
        if (poses[n] && !slam::is_near(scan_matching::transform_of(*poses[n]), {0.0, 0.0}, slam::kPoseMax))
            return false;
    }
    return true;
}

/// Returns whether the poses are of the scans of these maps.
bool are_of(const RestoredEstimation& estimation, const mapping::ProjectionState& maps) {
    const auto& poses = estimation.poses;
    if (poses.robot_count() > maps.robots.size() || estimation.robots.size() != maps.robots.size()) return false;
    if (poses.map().is_frozen() != maps.is_localize_only) return false;
    for (RobotIndex robot = 0; robot < maps.robots.size(); ++robot) {
        const LoggedRobot& logged = maps.robots[robot];
        const std::uint64_t scans = logged.poses == Poses::kMap ? 0 : logged.last_seq;
        const RobotPoses* estimated = poses.find(robot);
        if ((estimated == nullptr ? 0 : estimated->scan_count()) != scans) return false;
        const auto shown = estimation.robots[robot].poses.snapshot();
        if (shown.size() != scans || !are_near(shown)) return false;
        if (estimated != nullptr && !are_near(estimated->in_maps())) return false;
    }
    const Revision newest = std::max({estimation.shown, estimation.announced, estimation.corrected, poses.corrected()});
    return newest <= maps.revision;
}

} // namespace

EstimationState state_of(const SessionPoses& poses) {
    EstimationState state;
    archive::Writer writer = writer_of(poses, state);
    writer(poses);
    state.bytes = std::move(writer).take();
    return state;
}

bool are_equal(const SessionPoses& a, const SessionPoses& b) {
    const EstimationState left = state_of(a);
    const EstimationState right = state_of(b);
    const auto is_same = [](const auto& one, const auto& other) { return bytes_of(*one) == bytes_of(*other); };
    return left.bytes == right.bytes && std::ranges::equal(left.scans, right.scans, is_same) &&
           std::ranges::equal(left.corrections, right.corrections, is_same);
}

EstimationState state_of(const LocalizedProjection& maps) {
    EstimationState state;
    archive::Writer writer = writer_of(maps.poses(), state);
    const auto in_maps = maps.projection().state();
    writer(maps.poses(), maps.shown(), maps.announced(), in_maps.corrected);
    for (const auto& robot : in_maps.robots) {
        writer(std::uint64_t{robot.scan_poses.size()});
        for (std::size_t n = 0; n < robot.scan_poses.size(); ++n) writer(robot.scan_poses[n]);
        writer(robot.turns);
    }
    state.bytes = std::move(writer).take();
    for (RobotIndex robot = 0; robot < in_maps.robots.size(); ++robot) {
        state.localization.push_back(maps.localization_of(robot));
    }
    return state;
}

std::optional<RestoredEstimation> restored(const EstimationState& state, const mapping::ProjectionState& maps) {
    archive::Reader reader(state.bytes);
    reader.share(state.scans);
    reader.share(state.corrections);
    RestoredEstimation estimation;
    reader(estimation.poses, estimation.shown, estimation.announced, estimation.corrected);
    for (std::size_t n = 0; n < maps.robots.size() && !reader.failed(); ++n) {
        auto& robot = estimation.robots.emplace_back();
        reader(robot.poses, robot.turns);
    }
    if (!reader.complete() || !estimation.poses.is_consistent() || !are_of(estimation, maps)) return std::nullopt;
    return estimation;
}

std::string bytes_of(const slam::ScanPoints& scan) {
    archive::Writer writer;
    writer(scan);
    return std::move(writer).take();
}

std::string bytes_of(const GraphMoment& correction) {
    archive::Writer writer;
    writer(correction);
    return std::move(writer).take();
}

bool append_scans(std::string_view bytes, std::vector<SharedScan>& scans) {
    archive::Reader reader(bytes);
    while (!reader.failed() && !reader.complete()) {
        auto scan = std::make_shared<slam::ScanPoints>();
        reader(*scan);
        scans.push_back(std::move(scan));
    }
    return !reader.failed();
}

bool append_correction(std::string_view bytes, std::vector<SharedCorrection>& corrections) {
    archive::Reader reader(bytes);
    auto correction = std::make_shared<GraphMoment>();
    reader(*correction);
    corrections.push_back(std::move(correction));
    return reader.complete();
}

} // namespace scanloom::localization
