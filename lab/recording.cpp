#include "lab/recording.hpp"

#include "common/scan/limits.hpp"
#include "common/scan/reading.hpp"
#include "common/wire/messages.hpp"
#include "core/landmarks/point_index.hpp"
#include "core/landmarks/points.hpp"
#include "robot_client/lidars/ld06_capture.hpp"
#include "sim/drive/wall_follower.hpp"
#include "sim/range_sensors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

namespace scanloom::lab {

std::size_t robot_bytes(std::span<const Scan> scans) {
    std::size_t bytes = 0;
    std::string frame;
    for (const Scan& scan : scans) {
        frame.clear();
        wire::encode(wire::ScanBatch{{scan}}, frame);
        bytes += frame.size();
    }
    return bytes;
}

std::size_t clustering_bytes(std::span<const Point2> points, double eps) {
    using landmarks::CellIndex;
    constexpr std::size_t kNumber = sizeof(std::uint32_t);
    // the point; index of its distinct point; its cluster
    constexpr std::size_t kEach = sizeof(Point2) + 2 * kNumber;
    // the point and its count; position in the grid and cell; point and index among the core points; cluster
    constexpr std::size_t kDistinct = 2 * sizeof(Point2) + 5 * kNumber;
    // the cell; start of its core points and their tree; its set and cluster
    constexpr std::size_t kCell =
        sizeof(CellIndex::Cell) + sizeof(std::size_t) + sizeof(std::optional<landmarks::PointTree>) + 2 * kNumber;
    const auto distinct = landmarks::distinct_points(points);
    const auto cells = CellIndex::of_radius(distinct.points, eps).cells().size();
    return kEach * points.size() + kDistinct * distinct.points.size() + kCell * cells;
}

sim::World world_of(std::string_view name) {
    sim::World world = sim::find_world(name).value();
    const auto move = [](std::vector<sim::Box> boxes) {
        for (sim::Box& box : boxes) {
            box = {box.x_min + kRoomMiddle.x, box.y_min + kRoomMiddle.y, box.x_max + kRoomMiddle.x,
                   box.y_max + kRoomMiddle.y};
        }
        return boxes;
    };
    sim::World moved = sim::make_world(world.name, move(world.solids), move(world.floors));
    moved.walkers = std::move(world.walkers);
    for (sim::Walker& walker : moved.walkers) {
        for (Point2& corner : walker.loop) corner += kRoomMiddle;
    }
    return moved;
}

Sensor reference_laser() { return sim::find_laser("reference").value(); }

std::vector<Pose2> drive_from(const Start& start, std::size_t scans) {
    sim::Simulator simulator({world_of("room"), reference_laser(), std::nullopt, 1, start.pose},
                             std::make_unique<sim::WallFollower>());
    std::vector<Pose2> path(scans);
    std::generate(path.begin(), path.end(), [&] { return *simulator.next_scan().pose; });
    return path;
}

namespace {

/// Returns how many beams end at a walker: those whose range differs without walkers.
std::size_t readings_of_walkers(const sim::World& world, const Sensor& laser, const Pose2& pose) {
    if (world.walkers.empty()) return 0;
    sim::World without = world;
    without.walkers.clear();
    sim::Random unused(1);
    const auto seen = sim::sweep(world, laser, pose, std::nullopt, unused);
    const auto behind = sim::sweep(without, laser, pose, std::nullopt, unused);
    return std::inner_product(seen.begin(), seen.end(), behind.begin(), std::size_t{0}, std::plus<>(),
                              std::not_equal_to<>());
}

} // namespace

Recording record(const Scene& scene, const std::vector<Pose2>& path, const NoiseChoice& noise, double cell_size_m,
                 std::uint64_t seed) {
    sim::World world = world_of(scene.world);
    sim::Random random(seed);
    Recording recording{reference_laser(), {}, {}, 0};
    for (const Pose2& pose : path) {
        if (!recording.scans.empty()) sim::walk(world, {pose.x, pose.y}, sim::kScanPeriod);
        Scan scan;
        scan.seq = recording.scans.size() + 1;
        scan.stamp = static_cast<double>(recording.scans.size()) * sim::kScanPeriod;
        scan.sensor = recording.laser.id;
        scan.pose = pose;
        scan.ranges = sim::sweep(world, recording.laser, pose, noise.at(cell_size_m), random);
        if (noise.drops_no_return) std::replace(scan.ranges.begin(), scan.ranges.end(), kNoReturn, kInvalidRange);
        recording.scans.push_back(std::move(scan));
        recording.of_walkers += readings_of_walkers(world, recording.laser, pose);
        auto& bodies = recording.walkers.emplace_back();
        for (const sim::Walker& walker : world.walkers) bodies.push_back(sim::body_of(walker));
    }
    return recording;
}

namespace {

constexpr double kTurnPeriod = 0.1; // seconds

/// Calls visit(scan, point in the robot's frame) for each beam with a return.
template <class Visit>
void for_each_point(std::span<const Scan> scans, const Sensor& sensor, Visit&& visit) {
    const ReadingRules rules{sensor.range_min, sensor.range_max, true};
    for (const Scan& scan : scans) {
        const BeamAngles angles = angles_of(scan, sensor);
        for (std::size_t n = 0; n < scan.ranges.size(); ++n) {
            const auto reading = reading_of(scan.ranges[n], rules);
            if (!reading || !reading->is_hit) continue;
            const double angle = beam_angle(angles, n);
            visit(scan, transform(sensor.mount, reading->metres * Point2{std::cos(angle), std::sin(angle)}));
        }
    }
}

} // namespace

LidarCapture take_capture(const sim::World& world, const Pose2& T_map_lidar, std::size_t turns,
                          const std::optional<sim::Noise>& noise, sim::Random& random) {
    LidarCapture capture{sim::find_laser("lidar360").value(), {}};
    for (std::size_t turn = 0; turn < turns; ++turn) {
        Scan scan;
        scan.seq = turn + 1;
        scan.stamp = static_cast<double>(turn) * kTurnPeriod;
        scan.pose = T_map_lidar;
        scan.ranges = sim::sweep(world, capture.sensor, T_map_lidar, noise, random);
        capture.scans.push_back(std::move(scan));
    }
    return capture;
}

std::vector<Point2> points_of(std::span<const Scan> scans, const Sensor& sensor) {
    std::vector<Point2> points;
    for_each_point(scans, sensor, [&](const Scan&, const Point2& point) { points.push_back(point); });
    return points;
}

std::vector<Point2> points_in_map(std::span<const Scan> scans, const Sensor& sensor) {
    std::vector<Point2> points;
    for_each_point(scans, sensor,
                   [&](const Scan& scan, const Point2& point) { points.push_back(transform(*scan.pose, point)); });
    return points;
}

Result<RecordedCapture> read_ld06_recording(const std::filesystem::path& path) {
    const robot::LidarScanOptions options;
    auto source = robot::Ld06Capture::open(path, options, Pose2{});
    if (!source) return source.error();
    RecordedCapture recorded{{*robot::ld06_sensor(options), {}}, path.filename().string(), source->remarks()};
    for (;;) {
        auto next = source->next();
        if (!next) return next.error();
        if (!*next) break;
        recorded.capture.scans.push_back(std::move((*next)->scan));
        recorded.capture.scans.back().seq = recorded.capture.scans.size();
    }
    const auto& scans = recorded.capture.scans;
    if (scans.size() < 2) {
        return Error{
            Errc::kInvalidField,
            fmt::format("{}: only one turn; the comparison of its halves needs two: record longer", path.string())};
    }
    const auto first = std::span(scans).first(scans.size() / 2);
    const auto last = std::span(scans).subspan(first.size());
    for (const auto& [which, half] : {std::pair{"first", first}, std::pair{"last", last}}) {
        const std::size_t points = points_of(half, recorded.capture.sensor).size();
        if (points >= kViewPointsMin) continue;
        return Error{
            Errc::kInvalidField,
            fmt::format(
                "{}: in the {} {} of {} turns only {} points were observed; record where the lidar can see walls",
                path.string(), which, half.size(), scans.size(), points)};
    }
    return recorded;
}

} // namespace scanloom::lab
