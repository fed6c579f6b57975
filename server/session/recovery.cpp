#include "server/session/recovery.hpp"

#include "common/wire/log_codec.hpp"
#include "server/session/checkpoint.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

namespace scanloom::session {
namespace {

Result<> fold_rest(store::ScanLog& log, store::SessionId session, mapping::Projection& projection) {
    return log.read(session, projection.revision(), [&](Revision revision, std::string_view bytes) -> Result<> {
        auto entry = wire::decode_entry(bytes);
        if (!entry) return prefixed(fmt::format("log entry {}: ", revision), entry.error());
        return projection.fold(*entry);
    });
}

Result<Recovered> from_checkpoint(store::ScanLog& log, store::SessionId session, const mapping::MapConfig& config) {
    CheckpointReader reader(config);
    auto read = log.read_checkpoint(
        session, [&](std::string_view key, std::string_view value) { return reader.add(key, value); });
    if (!read) return read.error();
    auto projection = std::move(reader).finish();
    if (!projection) return projection.error();
    const Revision checkpointed = projection->revision();
    if (auto folded = fold_rest(log, session, *projection); !folded) return folded.error();
    return Recovered{std::move(*projection), checkpointed};
}

} // namespace

Result<Recovered> recover(store::ScanLog& log, store::SessionId session, const mapping::MapConfig& config) {
    auto recovered = from_checkpoint(log, session, config);
    if (recovered) return recovered;
    spdlog::warn("session {:016x}: {}; weaving it from the whole log", session, recovered.error().message);
    mapping::Projection projection(config);
    if (auto folded = fold_rest(log, session, projection); !folded) return folded.error();
    return Recovered{std::move(projection), 0};
}

} // namespace scanloom::session
