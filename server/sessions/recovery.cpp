#include "server/sessions/recovery.hpp"

#include "common/wire/log_codec.hpp"
#include "server/sessions/checkpoint_reader.hpp"
#include "server/sessions/log_readers.hpp"
#include "server/sessions/map_correction.hpp"
#include "server/store/store_error.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace scanloom::sessions {
namespace {

Error stopped() { return {Errc::kShuttingDown, "stopped before the log's end"}; }

/// Not a failure: the whole log is replayed.
const Error kOutdated{Errc::kConflict,
                      "the rest of the log excludes scans that are in these maps, or brings some back"};

struct FromCheckpoint {
    localization::LocalizedProjection maps;
    bool can_be_added_to; // the next checkpoint may write only what has changed
};

Result<FromCheckpoint> read_checkpoint(store::ScanLog& log, store::SessionId session, const mapping::MapConfig& config,
                                       const std::atomic<bool>& stop) {
    CheckpointReader reader(config);
    auto read = log.read_checkpoint(session, [&](std::string_view key, std::string_view value) -> Result<> {
        if (stop) return stopped();
        return reader.add(key, value);
    });
    if (!read) return read.error();
    const bool can_be_added_to = reader.is_newest_format();
    auto maps = std::move(reader).finish();
    if (!maps) return maps.error();
    return FromCheckpoint{std::move(*maps), can_be_added_to};
}

/// Applies the entries after those that the maps contain. @return false if it was stopped before the end of the log
Result<bool> apply_rest(store::ScanLog& log, store::SessionId session, localization::LocalizedProjection& maps,
                        const std::atomic<bool>& stop) {
    const auto apply = [&](Revision revision, std::string_view bytes) -> Result<> {
        if (stop) return stopped();
        auto entry = wire::decode_entry(bytes);
        if (!entry) return damaged_entry(revision, entry.error());
        if (maps.projection().is_outdated_by(*entry)) return kOutdated;
        double work = HUGE_VAL;
        const auto applied = maps.apply(*entry, work);
        return applied ? Result<>() : applied.error();
    };
    auto read = log.read(session, maps.projection().revision(), apply);
    if (read) read = correct_as_announced(log, session, maps, stop);
    if (!read && stop) return false;
    if (!read) return read.error();
    return true;
}

/// Replays the whole log, with its exclusions from the start.
Result<Recovered> recover_from_log(store::ScanLog& log, store::SessionId session, const mapping::MapConfig& config,
                                   const std::atomic<bool>& stop) {
    auto exclusions =
        read_exclusions(log, session, [&](Revision, const std::optional<ScanPose>&) { return !stop.load(); });
    if (!exclusions) return exclusions.error();
    Recovered recovered{mapping::Projection(config, std::make_shared<const Exclusions>(std::move(*exclusions)))};
    const auto complete = stop ? Result<bool>(false) : apply_rest(log, session, recovered.maps, stop);
    if (!complete) return complete.error();
    recovered.complete = *complete;
    return recovered;
}

Result<Recovered> recover_from_checkpoint(store::ScanLog& log, store::SessionId session,
                                          const mapping::MapConfig& config, const std::atomic<bool>& stop) {
    auto checkpoint = read_checkpoint(log, session, config, stop);
    Recovered recovered{checkpoint ? std::move(checkpoint->maps)
                                   : localization::LocalizedProjection(mapping::Projection(config))};
    if (!checkpoint && checkpoint.error() == stopped()) {
        recovered.complete = false;
        return recovered;
    }
    if (!checkpoint) {
        recovered.checkpoint_rejected = checkpoint.error();
    } else if (checkpoint->can_be_added_to) {
        recovered.checkpointed = recovered.maps.projection().revision();
    }
    const auto complete = apply_rest(log, session, recovered.maps, stop);
    if (!complete) return complete.error();
    recovered.complete = *complete;
    if (recovered.complete && recovered.maps.projection().revision() < recovered.maps.projection().newest_restored()) {
        return Error{Errc::kDataLoss,
                     fmt::format("the log ends with entry {}, but its checkpoint holds entry {} already; the store is "
                                 "damaged; {}",
                                 recovered.maps.projection().revision(), recovered.maps.projection().newest_restored(),
                                 store::kRecoverOrRemove)};
    }
    return recovered;
}

} // namespace

Result<Recovered> recover(store::ScanLog& log, store::SessionId session, const mapping::MapConfig& config,
                          const std::atomic<bool>& stop) {
    try {
        auto recovered = recover_from_checkpoint(log, session, config, stop);
        if (recovered || recovered.error() != kOutdated) return recovered;
        return recover_from_log(log, session, config, stop); // the outdated maps are already freed
    } catch (const std::bad_alloc&) {
        return Error{Errc::kOverloaded, "there is no memory left for its map; free some and start the server again"};
    }
}

} // namespace scanloom::sessions
