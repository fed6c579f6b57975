#include "server/sessions/session_factory.hpp"

#include "server/log/context.hpp"
#include "server/sessions/checkpoint.hpp"
#include "server/sessions/recovery.hpp"

#include <utility>

namespace scanloom::session {
namespace {

/// Stores a checkpoint of a stopped recovery, so that a long recovery finishes even if it is stopped repeatedly.
void keep_progress(store::ScanLog& log, const SessionInfo& info, Recovered& recovered,
                   const std::atomic<bool>& hurried) {
    if (recovered.projection.revision() <= recovered.checkpointed.value_or(0)) return; // no progress
    const auto snapshot = recovered.projection.snapshot();
    const auto written =
        write_checkpoint(log, info.id, snapshot, recovered.projection.state(), recovered.checkpointed, hurried);
    log::info({.session = info.name}, "session '{}': recovery stopped after entry {}{}", info.name, snapshot.revision,
              written ? "; the next start continues there" : "");
}

} // namespace

std::shared_ptr<Session> SessionFactory::make(SessionInfo info, mapping::Projection projection,
                                              std::optional<Revision> checkpointed) const {
    auto own = limits;
    own.chunks_max = info.chunks_max;
    return std::make_shared<Session>(std::move(info), std::move(projection), checkpointed, log, compute, counters, own,
                                     may_wait);
}

Result<std::shared_ptr<Session>> SessionFactory::read(const SessionInfo& info, const std::atomic<bool>& stop,
                                                      const std::atomic<bool>& hurried) const {
    auto recovered = recover(log, info.id, info.config, stop);
    if (!recovered) return recovered.error();
    if (recovered->checkpoint_rejected) {
        log::warn({.session = info.name},
                  "session '{}': its checkpoint cannot be used ({}); its maps were computed from its whole log",
                  info.name, recovered->checkpoint_rejected->message);
    }
    if (!recovered->complete) {
        keep_progress(log, info, *recovered, hurried);
        return std::shared_ptr<Session>();
    }
    SessionInfo read = info;
    read.exclusions = recovered->projection.exclusions();
    return make(std::move(read), std::move(recovered->projection), recovered->checkpointed);
}

} // namespace scanloom::session
