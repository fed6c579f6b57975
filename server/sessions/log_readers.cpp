#include "server/sessions/log_readers.hpp"

#include "common/wire/log_codec.hpp"
#include "server/sessions/recovery.hpp"

namespace scanloom::sessions {
namespace {

/// Adds an entry that is not a scan.
Result<> add_entry(Exclusions& exclusions, Revision revision, std::string_view bytes) {
    const auto entry = wire::decode_entry(bytes);
    if (!entry) return damaged_entry(revision, entry.error());
    if (const auto* excluded = std::get_if<ScansExcluded>(&*entry)) return exclusions.add(revision, *excluded);
    if (const auto* lifted = std::get_if<ExclusionLifted>(&*entry)) return exclusions.add(revision, *lifted);
    return {};
}

} // namespace

Result<Exclusions> read_exclusions(store::ScanLog& log, store::SessionId session, const KeepReading& keep_reading) {
    Exclusions exclusions;
    const auto read = log.read(session, 0, [&](Revision revision, std::string_view bytes) -> store::Visited {
        const auto scan = wire::decode_scan_pose(bytes);
        if (!scan) return damaged_entry(revision, scan.error());
        if (!keep_reading(revision, *scan)) return store::Visit::kStop;
        return *scan ? Result<>() : add_entry(exclusions, revision, bytes);
    });
    if (!read) return read.error();
    return exclusions;
}

namespace {

constexpr Revision kLookEvery = 256; // entries, which take a few milliseconds

} // namespace

Result<> read_captures(store::ScanLog& log, store::SessionId session, landmarks::SessionCaptures& captures,
                       Revision until, const mapping::ScanPoses& poses, const VisitCapture& visit,
                       const CheckContinue& ask) {
    const auto add = [&](Revision revision, std::string_view bytes) -> Result<> {
        auto taken = wire::decode_scan_pose(bytes);
        if (!taken) return damaged_entry(revision, taken.error());
        if (*taken) poses.place(**taken);
        if (*taken && !captures.needs(**taken)) {
            captures.pass_over(**taken);
            return {};
        }
        auto entry = wire::decode_entry(bytes);
        if (!entry) return damaged_entry(revision, entry.error());
        poses.place(*entry);
        const auto ended = captures.add(*entry);
        if (!ended) return {};
        auto visited = visit(*ended); // may take long, so ask() follows
        return visited ? ask(revision) : visited;
    };
    if (captures.revision() >= until) return {};
    return log.read(session, captures.revision(), [&](Revision revision, std::string_view bytes) -> store::Visited {
        if (auto added = add(revision, bytes); !added) return added;
        if (revision >= until) return store::Visit::kStop;
        return revision % kLookEvery == 0 ? ask(revision) : Result<>();
    });
}

} // namespace scanloom::sessions
