#include "server/sessions/checkpoint.hpp"

#include "common/wire/log_codec.hpp"
#include "server/sessions/checkpoint_estimation.hpp"
#include "server/sessions/checkpoint_parts.hpp"

#include <fmt/format.h>

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace scanloom::sessions {
namespace {

std::string format_part() {
    std::string value;
    put(value, mapping::kProjectionVersion);
    put(value, kPartsVersion);
    return value;
}

std::string head_part(const mapping::ProjectionState& state) {
    std::string value;
    put(value, state.revision);
    put(value, state.bounds.laser.occupancy);
    put(value, state.bounds.laser.himm);
    put(value, state.bounds.sonar);
    put(value, std::uint64_t{state.pages});
    if (state.is_localize_only) put(value, kLocalizeOnly); // otherwise the same bytes as in earlier versions
    return value;
}

std::string robot_part(const mapping::ProjectionState::Robot& robot) {
    std::string value;
    put(value, robot.last_seq);
    put(value, robot.scan_count);
    if (robot.newest) put(value, *robot.newest); // present exactly if scan_count > 0
    value += robot.name + '\0' + robot.source;
    const bool has_jumps = robot.jumps.newest.has_value();
    if (!robot.body_radius && !has_jumps) return value; // same bytes as in earlier versions, which had neither
    put(value += '\0', robot.body_radius.value_or(0.0));
    if (!has_jumps) return value;
    put(value, *robot.jumps.integrated);
    put(value, *robot.jumps.newest);
    put(value, robot.jumps.left_out);
    return value;
}

std::string chunk_part(const mapping::LaserChunk& chunk) {
    std::string value;
    put(value, chunk.revision);
    put(value, chunk.occupancy);
    put(value, chunk.himm);
    put(value, chunk.occ_types);
    return value;
}

std::string chunk_part(const mapping::SonarChunk& chunk) {
    std::string value;
    put(value, chunk.revision);
    put(value, chunk.cells);
    return value;
}

std::string chunk_key(std::string_view prefix, grid::ChunkKey key) {
    return fmt::format("{}{:08x}/{:08x}", prefix, static_cast<std::uint32_t>(key.cj),
                       static_cast<std::uint32_t>(key.ci));
}

/// Collects parts and writes them to the store in pieces. Writes nothing more after a failure.
class PieceWriter {
public:
    PieceWriter(store::ScanLog& log, store::SessionId session, const std::atomic<bool>& stop)
        : log_(log), session_(session), stop_(stop) {}

    /// Adds a part that is stored compressed. Its uncompressed size counts, so a piece covers the same amount of map
    /// whatever the compression ratio.
    void add_compressed(std::string key, std::string_view value) {
        bytes_ += key.size() + value.size();
        parts_.push_back({std::move(key), compressor_.compressed(value)});
    }

    void add(std::string key, std::string value) {
        bytes_ += key.size() + value.size();
        parts_.push_back({std::move(key), std::move(value)});
    }

    void write_if_full() {
        if (bytes_ >= kPieceBytes) write();
    }

    void write() {
        if (stop_ && written_) written_ = Error{Errc::kShuttingDown, "the session is being closed"};
        if (written_) written_ = log_.write_checkpoint(session_, std::exchange(parts_, {}));
        parts_.clear();
        bytes_ = 0;
    }

    [[nodiscard]] const Result<>& written() const { return written_; }

private:
    static constexpr std::size_t kPieceBytes = std::size_t{4} << 20;

    store::ScanLog& log_;
    store::SessionId session_;
    const std::atomic<bool>& stop_;
    PartCompressor compressor_;
    std::vector<store::CheckpointPart> parts_;
    std::size_t bytes_ = 0;
    Result<> written_;
};

template <class View>
void write_chunks(PieceWriter& out, std::string_view prefix, const View& view, Revision since) {
    view.visit({}, since, [&](grid::ChunkKey key, const auto& chunk) {
        if (!out.written()) return;
        out.add_compressed(chunk_key(prefix, key), chunk_part(chunk));
        out.write_if_full();
    });
}

/// Writes the parts that must agree, as one piece. A stored sensor must not be newer than the head: a recovery would
/// apply it to earlier scans.
void write_state(PieceWriter& out, const mapping::ProjectionState& state,
                 const std::optional<EstimationHead>& estimation, Revision since) {
    out.add("head", head_part(state));
    if (estimation) out.add(std::string(kEstimationHead), estimation_head_part(*estimation));
    if (state.exclusions->revision() != 0) out.add(std::string(kExclusionsPart), exclusions_part(state));
    for (RobotIndex index = 0; index < state.robots.size(); ++index) {
        out.add(fmt::format("robot/{:08x}", index), robot_part(state.robots[index]));
        for (const auto& [id, known] : state.robots[index].sensors) {
            if (known.revision <= since) continue;
            out.add(fmt::format("sensor/{:08x}/{:08x}", index, id),
                    wire::encode_entry(SensorDescribed{index, *known.sensor}));
        }
    }
    out.write();
}

/// Returns the head of the estimation in the stored checkpoint; nullopt if that has none.
Result<std::optional<EstimationHead>> stored_estimation(store::ScanLog& log, store::SessionId session) {
    const Error kIsRead{Errc::kShuttingDown, "the heads are read"};
    std::optional<EstimationHead> stored;
    const auto read = log.read_checkpoint(session, [&](std::string_view key, std::string_view value) -> Result<> {
        if (key > kEstimationHead) return kIsRead;
        if (key != kEstimationHead) return {};
        auto head = read_estimation_head(value);
        if (!head) return head.error();
        stored = std::move(*head);
        return kIsRead;
    });
    if (!read && read.error() != kIsRead) return read.error();
    return stored;
}

/// Writes the parts of the estimation but its head, which it returns.
Result<std::optional<EstimationHead>> write_estimation(PieceWriter& out, store::ScanLog& log, store::SessionId session,
                                                       const mapping::ProjectionState& state,
                                                       const std::optional<localization::EstimationState>& estimation) {
    if (!estimation) return std::optional<EstimationHead>();
    const auto stored = stored_estimation(log, session);
    if (!stored) return stored.error();
    auto head = add_estimation(*estimation, state, *stored, [&](std::string key, std::string_view value) {
        out.add_compressed(std::move(key), value);
        out.write_if_full();
    });
    out.write(); // apart from the last piece
    return std::optional(std::move(head));
}

} // namespace

std::optional<localization::EstimationState> estimation_to_store(const localization::LocalizedProjection& maps) {
    if (!maps.projection().has_estimated_poses()) return std::nullopt;
    return localization::state_of(maps);
}

Result<> write_checkpoint(store::ScanLog& log, store::SessionId session, const mapping::Snapshot& snapshot,
                          const mapping::ProjectionState& state, std::optional<Revision> since,
                          const std::atomic<bool>& stop,
                          const std::optional<localization::EstimationState>& estimation) {
    try {
        if (!since) {
            if (auto cleared = log.clear_checkpoint(session); !cleared) return cleared;
        }
        const Revision stored = since.value_or(0);
        PieceWriter out(log, session, stop);
        out.add("format", format_part());
        write_chunks(out, kLaserChunk, snapshot.laser, stored);
        write_chunks(out, kSonarChunk, snapshot.sonar, stored);
        const auto head = write_estimation(out, log, session, state, estimation);
        if (!head) return head.error();
        write_state(out, state, *head, stored);
        return out.written();
    } catch (const std::bad_alloc&) {
        return Error{Errc::kOverloaded, "there is no memory left to write it"};
    }
}

} // namespace scanloom::sessions
