#pragma once

#include "common/wire/messages.hpp"
#include "robot_client/lidars/lidar_models.hpp"
#include "tests/fuzz/server_check.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

/// Checks of the drivers of lidars.
namespace scanloom::fuzz {

using LidarBytes = std::span<const std::uint8_t>;

/// Passes the bytes that a sensor sends in pieces whose sizes are the bytes of `sizes` in turn; 0 means the rest. Like
/// the reader, stops at a failure.
inline std::vector<robot::Observation> observations_of(const robot::LidarModel& model,
                                                       const robot::LidarScanOptions& options, LidarBytes stream,
                                                       LidarBytes sizes) {
    constexpr double kArrival = 1000.0;
    const auto driver = robot::make_lidar_driver(model, options);
    std::vector<robot::Observation> observations;
    (void)driver->on_open();
    if (driver->on_timeout().failure) return observations; // the pause after the request to stop
    for (std::size_t turn = 0; !stream.empty(); ++turn) {
        const std::size_t wanted = sizes.empty() ? 0 : sizes[turn % sizes.size()];
        const auto piece = stream.first(wanted == 0 ? stream.size() : std::min(wanted, stream.size()));
        stream = stream.subspan(piece.size());
        const auto step = driver->on_bytes(piece, kArrival);
        while (auto taken = driver->next()) observations.push_back(std::move(*taken));
        if (step.failure) break;
    }
    return observations;
}

/// Runs a driver on an input: a count, that many sizes of pieces, then the bytes of a sensor. The first byte also
/// selects the median's window, and one of two models.
inline void check_lidar(std::string_view first_model, std::string_view second_model, const std::uint8_t* data,
                        std::size_t size) {
    if (size == 0) return;
    const auto input = std::span(data, size).subspan(1);
    const auto count = std::min<std::size_t>(data[0] % 16U, input.size());
    const auto stream = input.subspan(count);
    const auto& model = *robot::find_lidar_model((data[0] & 16U) == 0 ? first_model : second_model);
    auto options = robot::scan_options(model, {}).value();
    if (data[0] >= 128) options.median_window = 3 + 2 * (data[0] % 25);

    const auto whole = observations_of(model, options, stream, {});
    const auto pieces = observations_of(model, options, stream, input.first(count));
    check(whole.size() == pieces.size(), "any split of the bytes yields as many scans");
    for (std::size_t i = 0; i < whole.size(); ++i) {
        check(whole[i].scan == pieces[i].scan, "any split of the bytes yields the same scans");
        check(*whole[i].sensor == *pieces[i].sensor, "any split of the bytes yields the same sensor");
        Scan scan = whole[i].scan;
        scan.seq = 1;
        check_accepted(wire::Message(*whole[i].sensor));
        check_accepted(wire::ScanBatch{{scan}});
    }
}

} // namespace scanloom::fuzz
