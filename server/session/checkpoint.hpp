#pragma once

#include "common/error/error.hpp"
#include "server/mapping/projection.hpp"
#include "server/session/part_compression.hpp"
#include "server/store/scan_log.hpp"

#include <atomic>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

/// What a projection keeps in the store, so that recovery folds only the rest of the log.
///
/// Parts, in the order in which the store visits them, integers little-endian:
///   format                   weaving version, version of the parts
///   head                     revision, bounds, pages
///   head/exclusions          what Exclusions holds, and how many scans of each robot they leave out; only where there
///                            are any
///   robot/<index>            last seq, scan count, revision, stamp and pose of the newest scan, if any, name, a zero
///                            byte, source
///   sensor/<index>/<id>      a SensorDescribed entry, encoded as in the log
///   weave/laser/<chunk>      revision and cells of one chunk, layer by layer, compressed
///   weave/sonar/<chunk>      revision and cells of one chunk, compressed
/// <index> and the like are fixed-width hexadecimal. Where the robots were is in the log alone (old_paths.hpp).
///
/// Written in pieces of 4 MiB, uncompressed: the format first, then chunks. What depends on the revision comes last and
/// at once: head, robots, and the sensors described since the last checkpoint. Whatever a crash leaves is usable:
/// chunks may then be newer than the head, and a chunk knows by its revision which entries of the log it holds already.
namespace scanloom::session {

/// Writes the parts that changed after `since`; for none all of them, in place of whatever was there.
/// Pre     snapshot and state were taken at the same revision.
/// Errors  kStoreFailed; kShuttingDown: `stop` became true between two pieces; kOverloaded: memory ran out.
/// Thread  any but the store's; waits for the disk.
[[nodiscard]] Result<> write_checkpoint(store::ScanLog& log, store::SessionId session,
                                        const mapping::Snapshot& snapshot, const mapping::ProjectionState& state,
                                        std::optional<Revision> since, const std::atomic<bool>& stop);

/// Rebuilds a projection from the parts of a checkpoint, fed one by one in rising order of keys.
class CheckpointReader {
public:
    explicit CheckpointReader(const mapping::MapConfig& config) : projection_(config) {}

    /// Errors  kMalformed: the part is damaged; kUnsupportedVersion: it was woven by another version,
    ///         whose maps may differ. Either way: weave from the log instead.
    [[nodiscard]] Result<> add(std::string_view key, std::string_view value);

    /// The projection as of the checkpoint; a blank one when there was no part.
    /// Errors  kMalformed: parts are missing.
    [[nodiscard]] Result<mapping::Projection> finish() &&;

    /// Whether what was read is as this program writes it; else it is written anew as a whole.
    [[nodiscard]] bool is_newest_format() const noexcept;

    /// All parts with this key and behind it are sensors and cells.
    static constexpr std::string_view kAfterState = "sensor/";

    /// The checkpoint's state, without sensors, when the parts before kAfterState are in; a blank one when there was no
    /// part. Nothing where it does not tell all of it: it was written by an earlier version.
    [[nodiscard]] std::optional<mapping::ProjectionState> state() &&;

private:
    using Numbers = std::vector<std::uint32_t>; // those in a key

    /// A kind of part, told by how its key begins; `add` is false when the part is damaged.
    struct Kind {
        std::string_view prefix;
        std::size_t numbers;
        bool (CheckpointReader::*add)(const Numbers& numbers, std::string_view value);
    };
    static const Kind kKinds[5];

    [[nodiscard]] Result<> add_format(std::string_view value);
    [[nodiscard]] Result<> add_head(std::string_view value);
    [[nodiscard]] Result<> add_exclusions(std::string_view value);
    [[nodiscard]] bool add_robot(const Numbers& numbers, std::string_view value);
    [[nodiscard]] bool add_sensor(const Numbers& numbers, std::string_view value);
    [[nodiscard]] bool add_old_points(const Numbers& numbers, std::string_view value);
    [[nodiscard]] bool add_laser_chunk(const Numbers& numbers, std::string_view value);
    [[nodiscard]] bool add_sonar_chunk(const Numbers& numbers, std::string_view value);
    void begin_weaving();

    PartDecompressor decompressor_;
    mapping::Projection projection_;
    mapping::ProjectionState state_;
    std::vector<std::uint64_t> excluded_; // scans, by robot
    std::uint32_t parts_version_ = 0;
    bool has_format_ = false;
    bool weaving_ = false; // the state is complete and in the projection
};

} // namespace scanloom::session
