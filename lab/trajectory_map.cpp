#include "lab/trajectory_map.hpp"

#include "core/mapping/projection.hpp"
#include "server/tiles/map_image.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <utility>

namespace scanloom::lab {
namespace {

constexpr double kCellSizes[] = {0.05, 0.1, 0.2, 0.5, 1.0}; // metres

Result<mapping::Snapshot> map_of(std::span<const robot::Observation> scans, std::span<const std::optional<Pose2>> poses,
                                 double cell_size) {
    SessionOptions options;
    options.cell_size = cell_size;
    const auto config = mapping::resolve(options);
    if (!config) return config.error();
    mapping::Projection projection(*config);
    if (auto applied = projection.apply(RobotJoined{0, "lab"}); !applied) return applied.error();
    std::map<std::uint32_t, std::shared_ptr<const Sensor>> described; // by sensor
    std::uint64_t seq = 0;
    for (std::size_t n = 0; n < scans.size(); ++n) {
        if (!poses[n]) continue;
        const auto& sensor = scans[n].sensor;
        if (auto& known = described[sensor->id]; known != sensor) {
            known = sensor;
            if (auto applied = projection.apply(SensorDescribed{0, *sensor}); !applied) return applied.error();
        }
        Scan scan = scans[n].scan;
        scan.seq = ++seq;
        scan.pose = poses[n];
        scan.odometry.reset();
        if (auto applied = projection.apply(ScanTaken{0, std::move(scan)}); !applied) return applied.error();
    }
    return projection.snapshot();
}

} // namespace

Result<MapPicture> draw_map(std::span<const robot::Observation> scans, std::span<const std::optional<Pose2>> poses,
                            std::int32_t side_max) {
    for (const double cell_size : kCellSizes) {
        const auto map = map_of(scans, poses, cell_size);
        if (!map) return map.error();
        const auto frame = tiles::map_frame(*map, mapping::Layer::kOccupancy, std::nullopt);
        if (!frame && frame.error().code != Errc::kTooLarge) return frame.error();
        if (!frame || std::max(frame->width(), frame->height()) > side_max) continue;
        return MapPicture{tiles::map_png(tiles::render_map(*map, mapping::Layer::kOccupancy, *frame)), cell_size,
                          frame->width(), frame->height()};
    }
    return Error{Errc::kTooLarge, fmt::format("the map is larger than {0} x {0} cells of {1} m; use a shorter log",
                                              side_max, *std::rbegin(kCellSizes))};
}

} // namespace scanloom::lab
