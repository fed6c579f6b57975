#include "server/sessions/registry_state.hpp"

#include "common/scan/limits.hpp"
#include "server/log/context.hpp"
#include "server/sessions/checkpoint.hpp"
#include "server/sessions/recovery.hpp"

#include <fmt/format.h>

#include <future>
#include <memory>
#include <utility>

namespace scanloom::sessions {
namespace {

/// Stores a checkpoint of a stopped recovery, so that a long recovery finishes even if it is stopped repeatedly.
void keep_progress(store::ScanLog& log, const SessionInfo& info, Recovered& recovered,
                   const std::atomic<bool>& finish_early) {
    auto& projection = recovered.maps.projection();
    if (projection.revision() <= recovered.checkpointed.value_or(0)) return; // no progress
    const auto snapshot = projection.snapshot();
    const auto written = write_checkpoint(log, info.id, snapshot, recovered.maps.state(), recovered.checkpointed,
                                          finish_early, estimation_to_store(recovered.maps));
    log::info({.session = info.name}, "session '{}': recovery stopped after entry {}{}", info.name, snapshot.revision,
              written ? "; the next start continues there" : "");
}

} // namespace

Error maps_are_computed_again(const std::string& name) {
    return {Errc::kShuttingDown,
            fmt::format("the maps of session '{}' are computed again from its log; connect again", name)};
}

void discard_and_wait(Session& session, Error reason) {
    const auto closed = std::make_shared<std::promise<void>>();
    auto is_closed = closed->get_future();
    session.close_early(std::move(reason), [closed] { closed->set_value(); });
    is_closed.wait();
}

Error no_such_session(std::string_view name) {
    if (!is_valid_name(name)) return {Errc::kNotFound, "there is no session of that name; see the list of sessions"};
    return {Errc::kNotFound, fmt::format("there is no session '{}'; see the list of sessions", name)};
}

void DamagedSessions::add(std::string name, store::SessionId id, Error why) {
    if (why.code == Errc::kStoreFailed) { // it is not retried before the next start
        why = {Errc::kDataLoss, why.message + "; if its disk is readable again, restart the server"};
    }
    log::error({.session = name}, "session '{}' cannot be recovered: {}", name, why.message);
    const std::unique_lock lock(mutex_);
    damaged_[std::move(name)] = {id, std::move(why)};
}

std::optional<Error> DamagedSessions::find(std::string_view name) const {
    const std::shared_lock lock(mutex_);
    const auto found = damaged_.find(name);
    return found == damaged_.end() ? std::nullopt : std::optional(found->second.error);
}

std::map<std::string, Error> DamagedSessions::all() const {
    const std::shared_lock lock(mutex_);
    std::map<std::string, Error> reasons;
    for (const auto& [name, damaged] : damaged_) reasons.emplace(name, damaged.error);
    return reasons;
}

bool DamagedSessions::contains(store::SessionId id) const {
    const std::shared_lock lock(mutex_);
    return std::ranges::any_of(damaged_, [id](const auto& one) { return one.second.id == id; });
}

Result<> DamagedSessions::remove(std::string_view name, store::ScanLog& log) {
    std::unique_lock lock(mutex_);
    const auto damaged = damaged_.find(name);
    if (damaged == damaged_.end()) return no_such_session(name);
    const auto id = damaged->second.id;
    lock.unlock(); // others look for names while the store is changed
    auto removed = store::own(log, id);
    if (removed) removed = log.remove_session(id);
    if (!removed && removed.error().code != Errc::kNotFound) return removed; // not found: another server has removed it
    lock.lock();
    damaged_.erase(std::string(name));
    return {};
}

std::shared_ptr<Session> SessionFactory::make(SessionInfo info, localization::LocalizedProjection maps,
                                              std::optional<Revision> checkpointed) const {
    auto own = limits;
    own.chunks_max = info.chunks_max;
    const bool is_outdated = maps.is_outdated();
    auto session = std::make_shared<Session>(std::move(info), std::move(maps), checkpointed, log, compute, counters,
                                             own, blocking_executor);
    if (is_outdated) session->correct_maps();
    return session;
}

Result<std::shared_ptr<Session>> SessionFactory::read(const SessionInfo& info, const std::atomic<bool>& stop,
                                                      const std::atomic<bool>& finish_early) const {
    auto recovered = recover(log, info.id, info.config, stop);
    if (!recovered) return recovered.error();
    if (recovered->checkpoint_rejected) {
        log::warn({.session = info.name},
                  "session '{}': its checkpoint cannot be used ({}); its maps were computed from its whole log",
                  info.name, recovered->checkpoint_rejected->message);
    }
    if (!recovered->complete) {
        keep_progress(log, info, *recovered, finish_early);
        return std::shared_ptr<Session>();
    }
    if (recovered->maps.projection().revision() < info.entries_at_creation) {
        const auto revision = recovered->maps.projection().revision();
        log::warn({.session = info.name},
                  "session '{}' is removed: its creation came to {} of {} entries before a crash", info.name, revision,
                  info.entries_at_creation); // its creation was never confirmed
        if (auto removed = log.remove_session(info.id); !removed) return removed.error();
        return Error{Errc::kGone, fmt::format("the creation of session '{}' was interrupted", info.name)};
    }
    SessionInfo read = info;
    read.exclusions = recovered->maps.projection().exclusions();
    return make(std::move(read), std::move(recovered->maps), recovered->checkpointed);
}

} // namespace scanloom::sessions
