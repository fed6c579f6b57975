#include "server/session/log_captures.hpp"

#include "common/wire/log_codec.hpp"
#include "server/session/damage.hpp"

namespace scanloom::session {
namespace {

constexpr Revision kLookEvery = 256; // entries, which take a few milliseconds

const Error kEnd{Errc::kInternal, "the end of what is to be read"};

} // namespace

Result<> read_captures(store::ScanLog& log, store::SessionId session, landmarks::SessionCaptures& captures,
                       Revision until, const VisitCapture& visit, const AskWhetherToGoOn& ask) {
    const auto add = [&](Revision revision, std::string_view bytes) -> Result<> {
        const auto taken = wire::decode_scan_pose(bytes);
        if (!taken) return damaged_entry(revision, taken.error());
        if (*taken && !captures.needs(**taken)) {
            captures.pass_over(**taken);
            return {};
        }
        const auto entry = wire::decode_entry(bytes);
        if (!entry) return damaged_entry(revision, entry.error());
        const auto ended = captures.add(*entry);
        if (!ended) return {};
        auto visited = visit(*ended); // may take long, so ask() follows
        return visited ? ask(revision) : visited;
    };
    if (captures.revision() >= until) return {};
    const auto read =
        log.read(session, captures.revision(), [&](Revision revision, std::string_view bytes) -> Result<> {
            if (auto added = add(revision, bytes); !added) return added;
            if (revision >= until) return kEnd;
            return revision % kLookEvery == 0 ? ask(revision) : Result<>();
        });
    if (read || read.error() == kEnd) return {};
    return read;
}

} // namespace scanloom::session
