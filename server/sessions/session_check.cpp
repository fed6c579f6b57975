#include "server/sessions/session_check.hpp"

#include "common/scan/log_rules.hpp"
#include "common/wire/log_codec.hpp"
#include "core/localization/estimation_state.hpp"
#include "core/mapping/snapshot.hpp"
#include "server/sessions/checkpoint_reader.hpp"
#include "server/sessions/map_correction.hpp"
#include "server/sessions/recovery.hpp"

#include <fmt/format.h>

#include <cmath>

namespace scanloom::sessions {
namespace {

/// The state of one check. `stopped` is the error that `pace` returned.
struct Checking {
    store::ScanLog& log;
    const store::SessionId id;
    const CheckPace& pace;
    std::optional<Error> stopped{};

    Result<> go_on(std::size_t bytes) {
        auto may = pace(bytes);
        if (!may) stopped = may.error();
        return may;
    }
};

Result<> check_log(Checking& checking, LogRules& rules, Revision& entries) {
    return checking.log.read(checking.id, 0, [&](Revision revision, std::string_view bytes) -> Result<> {
        const auto entry = wire::decode_entry(bytes);
        if (!entry) return damaged_entry(revision, entry.error());
        if (auto follows = rules.add(*entry); !follows) return follows;
        entries = revision;
        return checking.go_on(bytes.size());
    });
}

Result<> check_sums_of_checkpoint(Checking& checking) {
    return checking.log.read_checkpoint(checking.id, [&](std::string_view key, std::string_view value) -> Result<> {
        return checking.go_on(key.size() + value.size());
    });
}

/// @param entries  number of entries in the log, which must be intact
Result<> check_checkpoint(Checking& checking, const mapping::MapConfig& config, Revision entries) {
    CheckpointReader reader(config);
    auto read = checking.log.read_checkpoint(checking.id, [&](std::string_view key, std::string_view value) {
        auto added = reader.add(key, value);
        return added ? checking.go_on(key.size() + value.size()) : added;
    });
    if (!read && read.error().code == Errc::kUnsupportedVersion) return {}; // the log is replayed
    if (!read) return read;
    auto finished = std::move(reader).finish();
    if (!finished) return finished.error();
    const auto& restored = finished->projection();
    const auto newest = std::max(restored.revision(), restored.newest_restored());
    if (newest <= entries) return {};
    return Error{Errc::kMalformed,
                 fmt::format("the log ends with entry {}, but its checkpoint holds entry {} already", entries, newest)};
}

/// Compares the maps and the estimated poses of the whole log with those of the checkpoint and the rest of the log.
/// Both must be intact.
Result<> compare_maps(Checking& checking, const mapping::MapConfig& config, const Exclusions& exclusions) {
    auto recovered = recover(checking.log, checking.id, config, false);
    if (!recovered) return recovered.error();
    if (exclusions != *recovered->maps.projection().exclusions()) {
        return Error{Errc::kMalformed, "the exclusions of the log differ from those of the checkpoint"};
    }
    localization::LocalizedProjection whole(mapping::Projection(config, recovered->maps.projection().exclusions()));
    auto applied = checking.log.read(checking.id, 0, [&](Revision, std::string_view bytes) -> Result<> {
        auto entry = wire::decode_entry(bytes);
        if (!entry) return entry.error();
        double work = HUGE_VAL;
        if (auto added = whole.apply(*entry, work); !added) return added.error();
        return checking.go_on(bytes.size());
    });
    if (applied) applied = correct_as_announced(checking.log, checking.id, whole, false);
    if (!applied) return applied;
    if (!localization::are_equal(recovered->maps.poses(), whole.poses())) {
        return Error{Errc::kMalformed, "the poses estimated from the whole log differ from those of the checkpoint and "
                                       "the rest of the log"};
    }
    const auto left = recovered->maps.projection().snapshot();
    const auto right = whole.projection().snapshot();
    for (const auto layer : mapping::kLayers) {
        if (mapping::digest_of(left, layer) == mapping::digest_of(right, layer)) continue;
        return Error{
            Errc::kMalformed,
            fmt::format(
                "layer {} computed from the whole log differs from that of the checkpoint and the rest of the log",
                mapping::name_of(layer))};
    }
    return {};
}

Result<> check_checkpoint_and_maps(Checking& checking, const mapping::MapConfig& config, const LogRules& log,
                                   CheckDepth depth) {
    if (auto checkpoint = check_checkpoint(checking, config, log.revision()); !checkpoint) {
        return prefixed("its log is whole and its maps are computed again, but ", checkpoint.error());
    }
    return depth == CheckDepth::kMaps ? compare_maps(checking, config, log.exclusions()) : Result<>{};
}

Result<> check(Checking& checking, const store::StoredSession& stored, CheckDepth depth, SessionCheck& found) {
    if (!stored.record) return stored.record.error();
    const auto record = wire::decode_session(*stored.record);
    if (!record) return record.error();
    found.name = record->name;
    const auto config = mapping::resolve(record->options);
    if (!config) return config.error();
    LogRules rules;
    if (auto log = check_log(checking, rules, found.entries); !log) return log;
    if (stored.damage) return *stored.damage;
    if (depth == CheckDepth::kLog) return check_sums_of_checkpoint(checking);
    return check_checkpoint_and_maps(checking, *config, rules, depth);
}

} // namespace

Result<SessionCheck> check_session(store::ScanLog& log, const store::StoredSession& stored, CheckDepth depth,
                                   const CheckPace& pace) {
    SessionCheck found{fmt::format("#{}", stored.id), 0, std::nullopt};
    Checking checking{log, stored.id, pace};
    const auto whole = check(checking, stored, depth, found);
    if (checking.stopped) return *checking.stopped;
    if (!whole) found.damage = whole.error();
    return found;
}

} // namespace scanloom::sessions
