#include "robot_client/lidars/ld06_capture.hpp"

#include "common/hash/sha256.hpp"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <iterator>

namespace scanloom::robot {
namespace {

constexpr std::size_t kChunkBytes = 16'384;

/// Returns the options that determine the scans. Doubles are written so that different ones differ.
std::string text_of(const LidarScanOptions& options, const LidarPoses& poses) {
    // Increase the number when the same bytes give different scans.
    std::string text =
        fmt::format("ld06 1\nrange {} {} {}\nconfidence {}\nmedian {}\nmount {} {} {}\n", options.range_min,
                    options.range_max, options.no_return == NoReturn::kFree ? "free" : "drop", options.confidence_min,
                    options.median_window.value_or(1), options.mount.x, options.mount.y, options.mount.yaw);
    if (options.poses != Poses::kMap) text += fmt::format("poses {}\n", name_of(options.poses));
    if (options.poses == Poses::kNone) return text;
    if (const auto* fixed = std::get_if<Pose2>(&poses)) {
        return text + fmt::format("pose {} {} {}\n", fixed->x, fixed->y, fixed->yaw);
    }
    for (const StampedPose& pose : std::get<PoseTimeline>(poses)) {
        fmt::format_to(std::back_inserter(text), "at {} {} {} {}\n", pose.stamp, pose.robot.x, pose.robot.y,
                       pose.robot.yaw);
    }
    return text;
}

} // namespace

Ld06Capture::Ld06Capture(const std::filesystem::path& path, const LidarScanOptions& options, LidarPoses poses)
    : path_(path.string()), options_(options), poses_(std::move(poses)), sensor_(ld06_sensor(options)) {}

Result<Ld06Capture> Ld06Capture::open(const std::filesystem::path& path, const LidarScanOptions& options,
                                      LidarPoses poses) {
    Ld06Capture capture(path, options, std::move(poses));
    if (auto read = capture.survey(); !read) return read.error();
    if (auto again = capture.reopen(); !again) return again.error();
    return capture;
}

Result<> Ld06Capture::reopen() {
    reading_ = Reading{std::ifstream(path_, std::ios::binary), {}, {}, {}};
    if (reading_.file.is_open()) return {};
    return Error{Errc::kNotFound, fmt::format("{}: cannot be opened: {}", path_, std::strerror(errno))};
}

/// @param on_bytes  called with the bytes read from the file
template <class OnBytes>
std::optional<LidarTurn> Ld06Capture::next_turn(OnBytes&& on_bytes) {
    auto& [file, decoder, clock, turns] = reading_;
    for (;;) {
        if (auto turn = turns.next()) return turn;
        if (const auto packet = decoder.next()) {
            turns.add(*packet, clock.stamp(packet->timestamp));
            continue;
        }
        std::array<char, kChunkBytes> chunk;
        file.read(chunk.data(), chunk.size());
        const std::string_view bytes(chunk.data(), static_cast<std::size_t>(file.gcount()));
        if (bytes.empty()) return std::nullopt;
        on_bytes(bytes);
        decoder.feed({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
    }
}

std::optional<Scan> Ld06Capture::scan_of(const LidarTurn& turn) const {
    const auto* timeline = std::get_if<PoseTimeline>(&poses_);
    const auto pose = timeline != nullptr ? timeline->at(turn.stamp) : std::get<Pose2>(poses_);
    if (!pose) return std::nullopt;
    Scan scan = ld06_scan(turn, options_);
    set_pose(scan, options_.poses, *pose);
    return scan;
}

/// Reads the whole file once.
Result<> Ld06Capture::survey() {
    if (auto opened = reopen(); !opened) return opened;
    Sha256 hash;
    hash.update(text_of(options_, poses_));
    LidarLosses losses;
    while (const auto turn = next_turn([&](std::string_view bytes) { hash.update(bytes); })) {
        ++(scan_of(*turn) ? scan_count_ : losses.without_pose);
    }
    fingerprint_ = "ld06:" + hash.hex().substr(0, 32);
    const auto& counts = reading_.decoder.counts();
    remarks_ = lidar_remarks(ld06_counts(counts, reading_.turns), losses);
    if (scan_count_ > 0) return {};
    if (losses.without_pose > 0) {
        return Error{
            Errc::kNotFound,
            fmt::format(
                "{}: no scan is within the time range of the poses; their times must be seconds since the first packet",
                path_)};
    }
    return Error{Errc::kNotFound,
                 fmt::format("{}: no full turn of an LD06 ({} packets); name a file with the bytes of the sensor",
                             path_, counts.packets)};
}

Result<std::optional<Observation>> Ld06Capture::next() {
    while (const auto turn = next_turn([](std::string_view) {})) {
        auto scan = scan_of(*turn);
        if (!scan) continue;
        if (++given_ > scan_count_) break;
        return std::optional(Observation{sensor_, std::move(*scan)});
    }
    if (given_ == scan_count_) return std::optional<Observation>{};
    return Error{Errc::kConflict, fmt::format("{}: the file was changed during the transfer, so the stored scans may "
                                              "be wrong: send the whole file to a new --session",
                                              path_)};
}

} // namespace scanloom::robot
