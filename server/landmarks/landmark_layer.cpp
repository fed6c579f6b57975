#include "server/landmarks/landmark_layer.hpp"

#include "server/landmarks/metrics.hpp"

#include <cassert>
#include <utility>

namespace scanloom::landmarks {
namespace {

std::vector<Point2> in_metres(std::span<const PointMm> points) {
    std::vector<Point2> out;
    out.reserve(points.size());
    for (const auto& [x, y] : points) out.emplace_back(x * 0.001, y * 0.001);
    return out;
}

void add_pair(PairSums& sums, std::span<const Landmark> first, std::span<const Landmark> second) {
    const auto matches = match(positions_of(first), positions_of(second), kTolerance);
    assert(matches); // landmarks are finite
    const auto metrics = metrics_of(*matches, first.size(), kTolerance);
    if (metrics.persistence) {
        sums.persistence_pairs += 1;
        sums.persistence += *metrics.persistence;
    }
    if (metrics.stability) {
        sums.stability_pairs += 1;
        sums.stability += *metrics.stability;
    }
}

} // namespace

void LandmarkLayer::add(RobotIndex index, const Scan& scan, const Sensor& sensor, Revision revision) {
    if (robots_.size() <= index) robots_.resize(index + 1);
    auto& robot = robots_[index];
    if (const auto ended = robot.cutter.add(scan, sensor, revision)) {
        add(robot, *ended);
        revision_ = revision;
    }
}

void LandmarkLayer::add(Robot& robot, const Capture& capture) {
    auto seen = find_landmarks(in_metres(capture.points));
    if (!seen) return; // it lies further out than a map can reach
    if (robot.seen_last) add_pair(sums_, *robot.seen_last, *seen);
    sums_.landmarks += seen->size();
    for (const auto& landmark : *seen) sums_.continuity += landmark.continuity;
    map_.add(*seen, capture.last);
    robot.seen_last = std::move(*seen);
    ++captures_;
}

LandmarkState LandmarkLayer::snapshot() { return {map_.snapshot(), captures_, sums_, revision_}; }

LandmarkLayer LandmarkLayer::branch() {
    LandmarkLayer other;
    other.map_ = map_.branch();
    other.robots_ = robots_;
    other.captures_ = captures_;
    other.sums_ = sums_;
    other.revision_ = revision_;
    return other;
}

std::vector<LandmarkRobot> LandmarkLayer::robots() const {
    std::vector<LandmarkRobot> out;
    for (const auto& robot : robots_) {
        out.push_back({robot.cutter.newest(), robot.cutter.is_open(), robot.seen_last});
    }
    return out;
}

void LandmarkLayer::restore(std::uint64_t captures, const PairSums& sums, Revision revision,
                            std::vector<LandmarkRobot> robots) {
    captures_ = captures;
    sums_ = sums;
    revision_ = revision;
    for (auto& saved : robots) {
        auto& robot = robots_.emplace_back();
        robot.cutter.restore(std::move(saved.newest), saved.is_open);
        robot.seen_last = std::move(saved.seen_last);
    }
}

} // namespace scanloom::landmarks
