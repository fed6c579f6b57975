#include "server/sessions/checkpoint_reader.hpp"

#include "common/scan/limits.hpp"
#include "common/wire/log_codec.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <memory>
#include <utility>

namespace scanloom::sessions {
namespace {

constexpr std::uint32_t kOldestPartsVersion = 2;
constexpr std::size_t kChunkBytesMax = sizeof(mapping::LaserChunk) + sizeof(mapping::SonarChunk);

Error damaged(std::string_view key) { return {Errc::kMalformed, fmt::format("checkpoint part '{}' is damaged", key)}; }

Error damaged_estimation() { return {Errc::kMalformed, "the checkpoint's state of the estimation is damaged"}; }

/// Returns the hexadecimal numbers in a key without its prefix, which are separated by slashes; nullopt if invalid.
std::optional<std::vector<std::uint32_t>> numbers_in(std::string_view key) {
    std::vector<std::uint32_t> numbers;
    while (!key.empty()) {
        const auto slash = std::min(key.find('/'), key.size());
        std::uint32_t number = 0;
        const auto [end, error] = std::from_chars(key.data(), key.data() + slash, number, 16);
        if (error != std::errc{} || end != key.data() + slash) return std::nullopt;
        numbers.push_back(number);
        key.remove_prefix(std::min(slash + 1, key.size()));
    }
    return numbers;
}

/// Returns where the frame of a checkpoint's map comes from if no robot of it has estimated poses.
FrameOrigin frame_origin_of(const mapping::ProjectionState& state) {
    const bool has_scans = std::ranges::any_of(state.robots, [](const auto& robot) { return robot.last_seq > 0; });
    if (has_scans) return FrameOrigin::kSent;
    return mapping::bounds_of(state.bounds).empty() ? FrameOrigin::kOpen : FrameOrigin::kImported;
}

grid::ChunkKey chunk_key_of(const std::vector<std::uint32_t>& numbers) {
    return {static_cast<std::int32_t>(numbers[0]), static_cast<std::int32_t>(numbers[1])};
}

} // namespace

const CheckpointReader::Kind CheckpointReader::kKinds[5] = {
    {"robot/", 1, &CheckpointReader::add_robot},          {"sensor/", 2, &CheckpointReader::add_sensor},
    {"track/", 2, &CheckpointReader::add_old_points},     {kLaserChunk, 2, &CheckpointReader::add_laser_chunk},
    {kSonarChunk, 2, &CheckpointReader::add_sonar_chunk},
};

Result<> CheckpointReader::add(std::string_view key, std::string_view value) {
    if (key == "format") return add_format(value);
    if (!has_format_) return Error{Errc::kMalformed, "the checkpoint's part 'format' is missing"};
    if (key == "head") return add_head(value);
    if (key == kEstimationHead) return add_estimation_head(value);
    if (key == kExclusionsPart) return add_exclusions(value);
    if (key.starts_with(kEstimationPart)) {
        const bool is_well =
            !estimation_ || is_restored_ || estimation_->add(key.substr(kEstimationPart.size()), value, decompressor_);
        return is_well ? Result<>() : damaged(key);
    }
    for (const auto& kind : kKinds) {
        if (!key.starts_with(kind.prefix)) continue;
        // The maps are restored before their first chunk, from all parts before.
        const bool is_chunk = kind.prefix == kLaserChunk || kind.prefix == kSonarChunk;
        if (is_chunk && !restore_projection()) return damaged_estimation();
        const auto numbers = numbers_in(key.substr(kind.prefix.size()));
        if (numbers && numbers->size() == kind.numbers && (this->*kind.add)(*numbers, value)) return {};
    }
    return damaged(key);
}

Result<> CheckpointReader::add_format(std::string_view value) {
    PartReader part(value);
    const auto version = part.take<std::uint32_t>();
    const auto parts_version = part.rest().empty() ? 1 : part.take<std::uint32_t>();
    if (!part.complete()) return damaged("format");
    has_format_ = true;
    if (version != mapping::kProjectionVersion) {
        return Error{Errc::kUnsupportedVersion,
                     fmt::format("the checkpoint was computed by version {}, this program computes version {}", version,
                                 mapping::kProjectionVersion)};
    }
    parts_version_ = parts_version;
    if (parts_version < kOldestPartsVersion || parts_version > kPartsVersion) {
        return Error{Errc::kUnsupportedVersion, fmt::format("the checkpoint's parts are of version {}, this program's "
                                                            "of version {}",
                                                            parts_version, kPartsVersion)};
    }
    return {};
}

Result<> CheckpointReader::add_head(std::string_view value) {
    PartReader part(value);
    state_.revision = part.take<Revision>();
    state_.bounds.laser.occupancy = part.take<grid::CellBox>();
    state_.bounds.laser.himm = part.take<grid::CellBox>();
    state_.bounds.sonar = part.take<grid::CellBox>();
    if (parts_version_ > 2) state_.pages = part.take<std::uint64_t>();
    if (!part.complete()) state_.is_localize_only = part.take<std::uint8_t>() == kLocalizeOnly;
    if (!part.complete()) return damaged("head");
    return {};
}

Result<> CheckpointReader::add_estimation_head(std::string_view value) {
    auto head = read_estimation_head(value);
    if (!head) return head.error();
    estimation_.emplace(std::move(*head));
    return {};
}

Result<> CheckpointReader::add_exclusions(std::string_view value) {
    auto part = read_exclusions_part(value);
    if (!part) return damaged(kExclusionsPart);
    state_.exclusions = std::make_shared<const Exclusions>(std::move(part->exclusions));
    excluded_ = std::move(part->excluded);
    return {};
}

bool CheckpointReader::add_robot(const Numbers& numbers, std::string_view value) {
    if (numbers[0] != state_.robots.size()) return false;
    PartReader part(value);
    auto& robot = state_.robots.emplace_back();
    if (numbers[0] < excluded_.size()) robot.excluded = excluded_[numbers[0]];
    if (estimation_ && numbers[0] < estimation_->head().robots.size()) {
        const auto& estimated = estimation_->head().robots[numbers[0]];
        robot.poses = estimated.poses;
        robot.unplaced = estimated.unplaced;
    }
    robot.last_seq = part.take<std::uint64_t>();
    robot.scan_count = part.take<std::uint64_t>();
    if (parts_version_ > 2 && robot.scan_count > 0) robot.newest = part.take<mapping::TrajectoryPoint>();
    const auto name_end = std::min(part.rest().find('\0'), part.rest().size());
    robot.name = part.rest().substr(0, name_end);
    part.skip(name_end + 1);
    const auto source_end = std::min(part.rest().find('\0'), part.rest().size());
    robot.source = part.rest().substr(0, source_end);
    part.skip(source_end + 1);
    if (part.rest().empty()) return !part.failed();
    if (const auto radius = part.take<double>(); radius != 0.0) robot.body_radius = radius;
    if (robot.body_radius && !is_body_radius(*robot.body_radius)) return false;
    if (part.complete()) return true;
    robot.jumps.integrated = part.take<Point2>();
    robot.jumps.newest = part.take<Point2>();
    robot.jumps.left_out = part.take<std::uint64_t>();
    return part.complete() && is_finite(*robot.jumps.integrated) && is_finite(*robot.jumps.newest);
}

bool CheckpointReader::add_sensor(const Numbers& numbers, std::string_view value) {
    auto entry = wire::decode_entry(value);
    if (!entry || numbers[0] >= state_.robots.size()) return false;
    auto* described = std::get_if<SensorDescribed>(&*entry);
    if (described == nullptr) return false;
    const auto id = described->sensor.id;
    state_.robots[numbers[0]].sensors[id] = {state_.revision,
                                             std::make_shared<const Sensor>(std::move(described->sensor))};
    return true;
}

/// Reads a block of a trajectory in an earlier format. Only the newest point is used.
bool CheckpointReader::add_old_points(const Numbers& numbers, std::string_view value) {
    PartReader part(value);
    while (!part.complete()) {
        const auto point = part.take<mapping::TrajectoryPoint>();
        if (part.failed()) return false;
        if (point.revision > state_.revision) continue; // its scan will be replayed
        if (numbers[0] >= state_.robots.size()) return false;
        state_.robots[numbers[0]].newest = point;
    }
    return parts_version_ < kPartsVersion;
}

bool CheckpointReader::add_laser_chunk(const Numbers& numbers, std::string_view value) {
    const auto bytes = decompressor_.decompressed(value, kChunkBytesMax);
    if (!bytes) return false;
    PartReader part(*bytes);
    const auto revision = part.take<Revision>();
    const auto occupancy = part.take<decltype(mapping::LaserChunk::occupancy)>();
    const auto himm = part.take<decltype(mapping::LaserChunk::himm)>();
    const auto occ_types = part.take<classify::OccPlanes>();
    const bool are_types =
        std::ranges::equal(occ_types.free, occ_types.occupied,
                           [](std::uint64_t free, std::uint64_t occupied) { return (free & occupied) == 0; });
    const bool are_counts = std::ranges::all_of(
        himm, [](auto count) { return count <= mapping::kHimmMax || count == mapping::kUnseenHimm; });
    if (!part.complete() || !are_types || !are_counts) return false;
    mapping::LaserChunk& chunk = projection_.restore_laser_chunk(chunk_key_of(numbers), revision);
    chunk.occupancy = occupancy;
    chunk.himm = himm;
    chunk.occ_types = occ_types;
    return true;
}

bool CheckpointReader::add_sonar_chunk(const Numbers& numbers, std::string_view value) {
    const auto bytes = decompressor_.decompressed(value, kChunkBytesMax);
    if (!bytes) return false;
    PartReader part(*bytes);
    const auto revision = part.take<Revision>();
    const auto cells = part.take<decltype(mapping::SonarChunk::cells)>();
    if (!part.complete()) return false;
    projection_.restore_sonar_chunk(chunk_key_of(numbers), revision).cells = cells;
    return true;
}

/// Passes the state to the projection at the first call. @return false if the estimation's is damaged
bool CheckpointReader::restore_projection() {
    if (is_restored_) return !estimation_ || restored_;
    is_restored_ = true;
    state_.frame_origin = estimation_ ? estimation_->head().frame_origin : frame_origin_of(state_);
    if (estimation_) restored_ = std::move(*estimation_).finish(state_);
    if (estimation_ && !restored_) return false;
    projection_.restore(state_);
    return true;
}

bool CheckpointReader::is_newest_format() const noexcept { return !has_format_ || parts_version_ == kPartsVersion; }

std::vector<mapping::Localization> CheckpointReader::localization() const {
    std::vector<mapping::Localization> localization;
    if (!estimation_) return localization;
    for (const auto& robot : estimation_->head().robots) localization.push_back(robot.localization);
    return localization;
}

std::optional<mapping::ProjectionState> CheckpointReader::state() && {
    if (!is_newest_format()) return std::nullopt;
    return std::move(state_);
}

Result<localization::LocalizedProjection> CheckpointReader::finish() && {
    if (!restore_projection()) return damaged_estimation();
    for (const auto& exclusion : state_.exclusions->all()) {
        if (exclusion.excluded.robot >= state_.robots.size()) return damaged(kExclusionsPart);
    }
    for (const auto& robot : state_.robots) {
        if (robot.newest || robot.scan_count == 0) continue;
        return Error{Errc::kMalformed, fmt::format("the checkpoint has no pose of robot '{}', which took {} scans",
                                                   robot.name, robot.scan_count)};
    }
    if (!restored_) return localization::LocalizedProjection(std::move(projection_));
    return localization::LocalizedProjection(std::move(projection_), std::move(restored_->poses), restored_->shown,
                                             restored_->announced);
}

} // namespace scanloom::sessions
