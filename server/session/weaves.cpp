#include "server/session/weaves.hpp"

#include <boost/asio/post.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace scanloom::session {
namespace {

std::size_t chunks_of(const Weave& weave) {
    const auto maps = weave.maps();
    return maps ? maps->chunk_count : 0;
}

Error shutting_down() { return {Errc::kShuttingDown, "the server is shutting down; try again when it is back"}; }

Error was_removed(const Weave& weave) {
    return {Errc::kNotFound,
            fmt::format("weave {} was deleted before these maps were done; start it again", weave.id())};
}

} // namespace

Weaves::Weaves(store::ScanLog& log, boost::asio::any_io_executor executor, const WeavesLimits& limits)
    : log_(log), executor_(std::move(executor)), limits_(limits), budget_(limits.chunks_max) {}

Result<std::shared_ptr<Weave>> Weaves::start(const SessionInfo& session, const WeaveRequest& request, Revision newest) {
    const std::lock_guard lock(mutex_);
    const Revision target = target_of(request, newest);
    auto weave = touch(session.id, weave_id_of(session, request));
    if (weave && weave->join(target)) return weave;
    if (auto room = check_room(); !room) return room.error();
    if (weave && weave->progress().state == Weave::State::kDone) {
        if (!weave->resume(target, budget_)) {
            return Error{Errc::kOverloaded, "the maps that are woven at this moment need all memory that there is for "
                                            "them; try again soon"};
        }
    } else {
        if (weave) weaves_.pop_front();
        weave = std::make_shared<Weave>(session, request, target);
        weaves_.push_front(weave);
    }
    evict();
    launch(weave);
    return weave;
}

/// Pre: mutex_ is held.
Result<> Weaves::check_room() const {
    if (stopped_) return shutting_down();
    const auto under_way =
        std::ranges::count_if(weaves_, [](const auto& other) { return !has_ended(other->progress().state); });
    if (static_cast<std::size_t>(under_way) < limits_.waiting_max) return {};
    return Error{Errc::kOverloaded, "too many maps are being woven at this moment; try again soon"};
}

void Weaves::launch(std::shared_ptr<Weave> weave) {
    boost::asio::post(executor_, [this, weave = std::move(weave)]() mutable {
        if (weave->run(log_, budget_)) return launch(std::move(weave)); // behind the others that wait
        const std::lock_guard lock(mutex_);
        evict();
    });
}

std::shared_ptr<Weave> Weaves::find(store::SessionId session, std::string_view id) {
    const std::lock_guard lock(mutex_);
    return touch(session, id);
}

/// To the front with it, if there is one. Pre: mutex_ is held.
std::shared_ptr<Weave> Weaves::touch(store::SessionId session, std::string_view id) {
    evict();
    const auto found = std::ranges::find_if(
        weaves_, [&](const auto& weave) { return weave->session().id == session && weave->id() == id; });
    if (found == weaves_.end()) return nullptr;
    weaves_.splice(weaves_.begin(), weaves_, found);
    return weaves_.front();
}

std::vector<std::shared_ptr<Weave>> Weaves::list(store::SessionId session) const {
    const std::lock_guard lock(mutex_);
    std::vector<std::shared_ptr<Weave>> of_session;
    std::ranges::copy_if(weaves_, std::back_inserter(of_session),
                         [&](const auto& weave) { return weave->session().id == session; });
    return of_session;
}

bool Weaves::remove(store::SessionId session, std::string_view id) {
    const std::lock_guard lock(mutex_);
    return std::erase_if(weaves_, [&](const auto& weave) {
               if (weave->session().id != session || weave->id() != id) return false;
               weave->cancel(was_removed(*weave));
               return true;
           }) > 0;
}

void Weaves::remove_all(store::SessionId session) {
    const std::lock_guard lock(mutex_);
    std::erase_if(weaves_, [&](const auto& weave) {
        if (weave->session().id != session) return false;
        weave->cancel(session_was_deleted(weave->session()));
        return true;
    });
}

void Weaves::stop() {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
    for (const auto& weave : weaves_) weave->cancel(shutting_down());
}

/// Pre: mutex_ is held.
void Weaves::evict() {
    std::size_t kept = 0;
    std::size_t chunks = 0;
    std::erase_if(weaves_, [&](const auto& weave) {
        if (!has_ended(weave->progress().state)) return false;
        ++kept;
        chunks += chunks_of(*weave);
        return kept > limits_.kept_max || chunks > limits_.chunks_kept_max;
    });
}

} // namespace scanloom::session
