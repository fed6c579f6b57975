#include "server/session/weaves.hpp"

#include <boost/asio/post.hpp>

#include <algorithm>
#include <utility>

namespace scanloom::session {
namespace {

bool has_ended(Weave::State state) { return state != Weave::State::kWaiting && state != Weave::State::kWeaving; }

std::size_t chunks_of(const Weave& weave) {
    const auto maps = weave.maps();
    return maps ? maps->chunk_count : 0;
}

} // namespace

Weaves::Weaves(store::ScanLog& log, boost::asio::any_io_executor executor, const WeavesLimits& limits)
    : log_(log), executor_(std::move(executor)), limits_(limits), budget_(limits.chunks_max) {}

Result<std::shared_ptr<Weave>> Weaves::start(const SessionInfo& session, const WeaveRequest& request) {
    const auto id = weave_id_of(session, request);
    if (auto known = find(session.id, id)) {
        const auto state = known->progress().state;
        if (state != Weave::State::kFailed && state != Weave::State::kCancelled) return known;
        remove(session.id, id);
    }
    auto weave = std::make_shared<Weave>(session, request);
    {
        const std::lock_guard lock(mutex_);
        if (stopped_) return Error{Errc::kShuttingDown, "the server is shutting down; try again when it is back"};
        const auto under_way =
            std::ranges::count_if(weaves_, [](const auto& other) { return !has_ended(other->progress().state); });
        if (static_cast<std::size_t>(under_way) >= limits_.waiting_max) {
            return Error{Errc::kOverloaded, "too many maps are being woven at this moment; try again soon"};
        }
        weaves_.push_front(weave);
        evict();
    }
    boost::asio::post(executor_, [this, weave] {
        weave->run(log_, budget_);
        const std::lock_guard lock(mutex_);
        evict();
    });
    return weave;
}

std::shared_ptr<Weave> Weaves::find(store::SessionId session, std::string_view id) {
    const std::lock_guard lock(mutex_);
    const auto found = std::ranges::find_if(
        weaves_, [&](const auto& weave) { return weave->session() == session && weave->id() == id; });
    if (found == weaves_.end()) return nullptr;
    weaves_.splice(weaves_.begin(), weaves_, found);
    evict();
    return weaves_.front();
}

std::vector<std::shared_ptr<Weave>> Weaves::list(store::SessionId session) const {
    const std::lock_guard lock(mutex_);
    std::vector<std::shared_ptr<Weave>> of_session;
    std::ranges::copy_if(weaves_, std::back_inserter(of_session),
                         [&](const auto& weave) { return weave->session() == session; });
    return of_session;
}

bool Weaves::remove(store::SessionId session, std::string_view id) {
    const std::lock_guard lock(mutex_);
    return std::erase_if(weaves_, [&](const auto& weave) {
               if (weave->session() != session || weave->id() != id) return false;
               weave->cancel();
               return true;
           }) > 0;
}

void Weaves::remove_all(store::SessionId session) {
    const std::lock_guard lock(mutex_);
    std::erase_if(weaves_, [&](const auto& weave) {
        if (weave->session() != session) return false;
        weave->cancel();
        return true;
    });
}

void Weaves::stop() {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
    for (const auto& weave : weaves_) weave->cancel();
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
