#include "server/session/checkpoint.hpp"

#include "common/wire/log_codec.hpp"

#include <fmt/format.h>

#include <bit>
#include <charconv>
#include <cstring>
#include <type_traits>

namespace scanloom::session {
namespace {

static_assert(std::endian::native == std::endian::little, "checkpoints are written in the machine's own order");

template <class Value>
void put(std::string& out, const Value& value) {
    static_assert(std::is_trivially_copyable_v<Value>);
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Takes values off the front of a part; fails for good when it is too short.
class PartReader {
public:
    explicit PartReader(std::string_view bytes) : rest_(bytes) {}

    template <class Value>
    Value take() {
        static_assert(std::is_trivially_copyable_v<Value>);
        Value value{};
        if (rest_.size() < sizeof value) {
            failed_ = true;
            return value;
        }
        std::memcpy(&value, rest_.data(), sizeof value);
        rest_.remove_prefix(sizeof value);
        return value;
    }

    [[nodiscard]] std::string_view rest() const noexcept { return rest_; }
    [[nodiscard]] bool complete() const noexcept { return !failed_ && rest_.empty(); }
    [[nodiscard]] bool failed() const noexcept { return failed_; }

private:
    std::string_view rest_;
    bool failed_ = false;
};

Error damaged(std::string_view key) {
    return {Errc::kMalformed,
            fmt::format("checkpoint part '{}' is damaged; the map is woven from the log instead", key)};
}

/// The hexadecimal numbers between the slashes of a key, after its first word.
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

std::string head_part(const mapping::ProjectionState& state) {
    std::string value;
    put(value, mapping::kWeavingVersion);
    put(value, state.revision);
    put(value, state.bounds.i_begin);
    put(value, state.bounds.j_begin);
    put(value, state.bounds.i_end);
    put(value, state.bounds.j_end);
    return value;
}

void add_robot(std::vector<store::CheckpointPart>& parts, RobotIndex index,
               const mapping::ProjectionState::Robot& robot) {
    std::string value;
    put(value, robot.last_seq);
    put(value, robot.scan_count);
    parts.push_back({fmt::format("robot/{:08x}", index), value + robot.name});
    for (const auto& sensor : robot.sensors) {
        parts.push_back({fmt::format("sensor/{:08x}/{:08x}", index, sensor.id),
                         wire::encode_entry(SensorDescribed{index, sensor})});
    }
}

void add_track(std::vector<store::CheckpointPart>& parts, RobotIndex index, const mapping::TrajectoryView& track,
               Revision since) {
    const std::size_t first_block = track.first_after(since) / mapping::kTrajectoryBlock;
    for (std::size_t begin = first_block * mapping::kTrajectoryBlock; begin < track.size();
         begin += mapping::kTrajectoryBlock) {
        const std::size_t end = std::min(begin + mapping::kTrajectoryBlock, track.size());
        std::string value;
        for (std::size_t n = begin; n < end; ++n) put(value, track[n]);
        parts.push_back(
            {fmt::format("track/{:08x}/{:08x}", index, begin / mapping::kTrajectoryBlock), std::move(value)});
    }
}

void add_chunks(std::vector<store::CheckpointPart>& parts, const mapping::OccupancyView& view, Revision since) {
    view.visit({}, since, [&](mapping::ChunkKey key, const mapping::OccupancyChunk& chunk) {
        std::string value;
        put(value, chunk.revision);
        put(value, chunk.cells);
        parts.push_back({fmt::format("weave/occupancy/{:08x}/{:08x}", static_cast<std::uint32_t>(key.cj),
                                     static_cast<std::uint32_t>(key.ci)),
                         std::move(value)});
    });
}

} // namespace

std::vector<store::CheckpointPart> checkpoint_parts(const mapping::Snapshot& snapshot,
                                                    const mapping::ProjectionState& state, Revision since) {
    std::vector<store::CheckpointPart> parts{{"head", head_part(state)}};
    for (RobotIndex index = 0; index < state.robots.size(); ++index) {
        add_robot(parts, index, state.robots[index]);
        add_track(parts, index, snapshot.robots[index].trajectory, since);
    }
    add_chunks(parts, snapshot.occupancy, since);
    return parts;
}

Result<> CheckpointReader::add(std::string_view key, std::string_view value) {
    PartReader reader(value);
    if (key == "head") {
        const auto version = reader.take<std::uint32_t>();
        state_.revision = reader.take<Revision>();
        state_.bounds.i_begin = reader.take<std::int32_t>();
        state_.bounds.j_begin = reader.take<std::int32_t>();
        state_.bounds.i_end = reader.take<std::int32_t>();
        state_.bounds.j_end = reader.take<std::int32_t>();
        if (!reader.complete()) return damaged(key);
        if (version == mapping::kWeavingVersion) return {};
        return Error{Errc::kUnsupportedVersion,
                     fmt::format("the checkpoint was woven by version {}, this program weaves version {}", version,
                                 mapping::kWeavingVersion)};
    }

    constexpr std::string_view kWeave = "weave/occupancy/";
    const bool is_chunk = key.starts_with(kWeave);
    const auto numbers = numbers_in(key.substr(std::min(is_chunk ? kWeave.size() : key.find('/') + 1, key.size())));
    if (!numbers || numbers->empty()) return damaged(key);
    if (key.starts_with("robot/")) {
        if ((*numbers)[0] != state_.robots.size()) return damaged(key);
        auto& robot = state_.robots.emplace_back();
        robot.last_seq = reader.take<std::uint64_t>();
        robot.scan_count = reader.take<std::uint64_t>();
        robot.name = reader.rest();
        return reader.failed() ? Result<>(damaged(key)) : Result<>();
    }
    if (key.starts_with("sensor/")) {
        auto entry = wire::decode_entry(value);
        if (!entry || (*numbers)[0] >= state_.robots.size()) return damaged(key);
        const auto* described = std::get_if<SensorDescribed>(&*entry);
        if (described == nullptr) return damaged(key);
        state_.robots[(*numbers)[0]].sensors.push_back(described->sensor);
        return {};
    }
    begin_weaving();
    if (key.starts_with("track/")) {
        while (!reader.complete()) {
            const auto point = reader.take<mapping::TrajectoryPoint>();
            if (reader.failed() || !projection_.restore_point((*numbers)[0], point)) return damaged(key);
        }
        return {};
    }
    if (is_chunk && numbers->size() == 2) {
        const auto revision = reader.take<Revision>();
        const auto cells = reader.take<decltype(mapping::OccupancyChunk::cells)>();
        if (!reader.complete()) return damaged(key);
        projection_.restore_chunk({static_cast<std::int32_t>((*numbers)[0]), static_cast<std::int32_t>((*numbers)[1])},
                                  revision, cells);
        return {};
    }
    return damaged(key);
}

void CheckpointReader::begin_weaving() {
    if (!weaving_) projection_.restore(state_);
    weaving_ = true;
}

mapping::Projection CheckpointReader::finish() && {
    begin_weaving();
    return std::move(projection_);
}

} // namespace scanloom::session
