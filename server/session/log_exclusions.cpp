#include "server/session/log_exclusions.hpp"

#include "common/wire/log_codec.hpp"
#include "server/session/damage.hpp"

namespace scanloom::session {
namespace {

const Error kEndOfReading{Errc::kInternal, "the end of what is to be read"};

/// Adds an entry that is not a scan.
Result<> add_entry(Exclusions& exclusions, Revision revision, std::string_view bytes) {
    const auto entry = wire::decode_entry(bytes);
    if (!entry) return damaged_entry(revision, entry.error());
    if (const auto* excluded = std::get_if<ScansExcluded>(&*entry)) return exclusions.add(revision, *excluded);
    if (const auto* lifted = std::get_if<ExclusionLifted>(&*entry)) return exclusions.add(revision, *lifted);
    return {};
}

} // namespace

Result<Exclusions> read_exclusions(store::ScanLog& log, store::SessionId session, const ReadsOn& reads_on) {
    Exclusions exclusions;
    const auto read = log.read(session, 0, [&](Revision revision, std::string_view bytes) -> Result<> {
        const auto scan = wire::decode_scan_pose(bytes);
        if (!scan) return damaged_entry(revision, scan.error());
        if (!reads_on(revision, *scan)) return kEndOfReading;
        return *scan ? Result<>() : add_entry(exclusions, revision, bytes);
    });
    if (!read && read.error() != kEndOfReading) return read.error();
    return exclusions;
}

} // namespace scanloom::session
