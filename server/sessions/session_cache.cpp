#include "server/sessions/session_cache.hpp"

#include <algorithm>
#include <iterator>
#include <mutex>
#include <utility>

namespace scanloom::sessions {

void SessionCache::touch(const Entry& entry, Clock::time_point now) const {
    entry.used = now.time_since_epoch().count();
}

std::shared_ptr<Session> SessionCache::find(std::string_view name, Clock::time_point now) const {
    const std::shared_lock lock(mutex_);
    const auto found = entries_.find(name);
    if (found == entries_.end() || found->second.state != State::kLoaded) return nullptr;
    touch(found->second, now);
    return found->second.session;
}

bool SessionCache::contains(std::string_view name) const {
    const std::shared_lock lock(mutex_);
    return entries_.contains(name);
}

std::optional<SessionInfo> SessionCache::info(std::string_view name) const {
    const std::shared_lock lock(mutex_);
    const auto found = entries_.find(name);
    return found == entries_.end() ? std::nullopt : std::optional(found->second.info);
}

std::optional<ListedSession> SessionCache::listed(std::string_view name) const {
    const std::shared_lock lock(mutex_);
    const auto found = entries_.find(name);
    if (found == entries_.end()) return std::nullopt;
    const Entry& entry = found->second;
    return ListedSession{entry.info, entry.session, entry.summary, entry.shared};
}

std::vector<std::shared_ptr<Session>> SessionCache::loaded() const {
    const std::shared_lock lock(mutex_);
    std::vector<std::shared_ptr<Session>> sessions;
    sessions.reserve(entries_.size());
    for (const auto& [name, entry] : entries_) {
        if (entry.state == State::kLoaded) sessions.push_back(entry.session);
    }
    return sessions;
}

std::vector<ListedSession> SessionCache::all() const {
    const std::shared_lock lock(mutex_);
    std::vector<ListedSession> all;
    all.reserve(entries_.size());
    for (const auto& [name, entry] : entries_) all.push_back({entry.info, entry.session, entry.summary, entry.shared});
    return all;
}

void SessionCache::add(std::shared_ptr<Session> session, Clock::time_point now) {
    const std::unique_lock lock(mutex_);
    Entry& entry = entries_[session->info().name];
    entry.info = session->info();
    entry.session = std::move(session);
    entry.state = State::kLoaded;
    entry.loaded = now;
    touch(entry, now);
}

void SessionCache::add(SessionInfo info, Summary summary, store::SharedSession shared) {
    const std::unique_lock lock(mutex_);
    if (entries_.contains(info.name) || reserved_.contains(info.name)) return;
    Entry& entry = entries_[info.name];
    entry.info = std::move(info);
    entry.summary = std::move(summary);
    entry.shared = std::move(shared);
}

SessionCache::Reservation::Reservation(SessionCache& cache, std::string name) : cache_(cache), name_(std::move(name)) {
    const std::unique_lock lock(cache_.mutex_);
    cache_.reserved_.insert(name_);
}

SessionCache::Reservation::~Reservation() {
    const std::unique_lock lock(cache_.mutex_);
    cache_.reserved_.erase(name_);
}

// Loading

EvictedSession SessionCache::load(Entry& entry) {
    entry.state = State::kInTransition;
    return {entry.info, entry.summary.pages};
}

std::optional<EvictedSession> SessionCache::load_if_wanted(Entry& entry) {
    if (entry.state != State::kEvicted || entry.waiting.empty()) return std::nullopt;
    return load(entry);
}

std::optional<EvictedSession> SessionCache::request(std::string_view name, Clock::time_point now, Loaded on_loaded) {
    std::shared_ptr<Session> loaded_session;
    {
        const std::unique_lock lock(mutex_);
        const auto found = entries_.find(name);
        if (found != entries_.end()) {
            Entry& entry = found->second;
            touch(entry, now);
            if (entry.state != State::kLoaded) {
                entry.waiting.push_back(std::move(on_loaded));
                return load_if_wanted(entry);
            }
            loaded_session = entry.session;
        }
    }
    on_loaded(std::move(loaded_session));
    return std::nullopt;
}

void SessionCache::end_load(std::shared_ptr<Session> session, Clock::time_point now) {
    std::vector<Loaded> waiting;
    {
        const std::unique_lock lock(mutex_);
        Entry& entry = entries_.find(session->info().name)->second;
        entry.info = session->info(); // its exclusions may have changed
        entry.session = session;
        entry.state = State::kLoaded;
        entry.loaded = now;
        entry.summary = {};
        entry.shared = {};
        touch(entry, now);
        waiting.swap(entry.waiting);
    }
    arrival_.notify_all();
    for (const auto& on_loaded : waiting) on_loaded(session);
}

void SessionCache::fail_load(const std::string& name, const Error& why) {
    std::vector<Loaded> waiting;
    {
        const std::unique_lock lock(mutex_);
        Entry& entry = entries_.find(name)->second;
        entry.state = State::kEvicted;
        waiting.swap(entry.waiting);
    }
    arrival_.notify_all();
    for (const auto& on_loaded : waiting) on_loaded(why);
}

// Eviction

std::vector<std::shared_ptr<Session>> SessionCache::evict(Clock::time_point used_until, std::size_t pages_wanted) {
    const std::unique_lock lock(mutex_); // no caller can obtain a session without users meanwhile
    std::vector<Entry*> idle;
    for (auto& [name, entry] : entries_) {
        const bool is_held = entry.session.use_count() > 1;
        const bool was_used = entry.used > used_until.time_since_epoch().count();
        if (entry.state == State::kLoaded && !is_held && !was_used) idle.push_back(&entry);
    }
    std::ranges::sort(idle, {}, [](const Entry* entry) { return entry->used.load(); });
    std::vector<std::shared_ptr<Session>> sent;
    std::size_t pages = 0;
    for (Entry* entry : idle) {
        if (pages >= pages_wanted) break;
        entry->summary = summary_of(*entry->session->snapshot());
        pages += entry->summary.pages;
        entry->state = State::kInTransition;
        sent.push_back(entry->session);
    }
    return sent;
}

std::vector<std::shared_ptr<Session>> SessionCache::evict_failed() {
    const std::unique_lock lock(mutex_);
    std::vector<std::shared_ptr<Session>> sent;
    for (auto& [name, entry] : entries_) {
        if (entry.state != State::kLoaded || !entry.session->failure()) continue;
        entry.state = State::kInTransition;
        sent.push_back(entry.session);
    }
    return sent;
}

std::optional<EvictedSession> SessionCache::end_eviction(const std::string& name, Summary summary) {
    std::optional<EvictedSession> wanted;
    std::shared_ptr<Session> last; // destroyed after the lock is released
    {
        const std::unique_lock lock(mutex_);
        Entry& entry = entries_.find(name)->second;
        entry.session.swap(last);
        if (summary.facts) entry.info.exclusions = summary.facts->exclusions;
        entry.summary = std::move(summary);
        entry.state = State::kEvicted;
        wanted = load_if_wanted(entry);
    }
    arrival_.notify_all();
    return wanted;
}

std::optional<EvictedSession> SessionCache::end_replacement(SessionInfo info, Summary summary) {
    const std::string name = info.name;
    {
        const std::unique_lock lock(mutex_);
        entries_.find(name)->second.info = std::move(info);
    }
    return end_eviction(name, std::move(summary));
}

// Deletion

std::optional<ListedSession> SessionCache::begin_change(std::string_view name) {
    std::unique_lock lock(mutex_);
    for (;;) {
        const auto found = entries_.find(name);
        if (found == entries_.end()) return std::nullopt;
        Entry& entry = found->second;
        if (entry.state != State::kInTransition) {
            entry.state = State::kInTransition;
            return ListedSession{entry.info, entry.session, entry.summary};
        }
        arrival_.wait(lock);
    }
}

void SessionCache::remove(std::string_view name, const Error& why) {
    std::vector<Loaded> waiting;
    std::shared_ptr<Session> last;
    {
        const std::unique_lock lock(mutex_);
        const auto found = entries_.find(name);
        if (found == entries_.end()) return;
        waiting.swap(found->second.waiting);
        last.swap(found->second.session);
        entries_.erase(found);
    }
    arrival_.notify_all();
    for (const auto& on_loaded : waiting) on_loaded(why);
}

// Sessions of other servers

SessionCache::Followed SessionCache::follow(const std::map<store::SessionId, store::SharedSession>& all,
                                            Clock::time_point asked) {
    Followed followed;
    for (const auto& [id, shared] : all) followed.unknown.insert(id);
    const std::unique_lock lock(mutex_);
    for (auto at = entries_.begin(); at != entries_.end();) {
        Entry& entry = at->second;
        followed.unknown.erase(entry.info.id);
        const auto found = all.find(entry.info.id);
        const bool is_evicted = entry.state == State::kEvicted;
        if (is_evicted && found != all.end()) entry.shared = found->second;
        if (entry.state == State::kLoaded && entry.loaded < asked && (found == all.end() || !found->second.is_own)) {
            entry.state = State::kInTransition;
            followed.lost.push_back(entry.session);
        }
        const bool is_gone = is_evicted && found == all.end() && entry.used <= asked.time_since_epoch().count();
        at = is_gone ? entries_.erase(at) : std::next(at);
    }
    return followed;
}

void SessionCache::set_owner(std::string_view name, std::shared_ptr<const store::NodeInfo> owner) {
    const std::unique_lock lock(mutex_);
    const auto found = entries_.find(name);
    if (found != entries_.end()) found->second.shared.owner = std::move(owner);
}

std::shared_ptr<const store::NodeInfo> SessionCache::owner(std::string_view name) const {
    const std::shared_lock lock(mutex_);
    const auto found = entries_.find(name);
    return found == entries_.end() || found->second.session ? nullptr : found->second.shared.owner;
}

// Changes

std::optional<EvictedSession> SessionCache::cancel_change(std::string_view name) {
    std::vector<Loaded> waiting;
    std::shared_ptr<Session> loaded_session;
    std::optional<EvictedSession> wanted;
    {
        const std::unique_lock lock(mutex_);
        Entry& entry = entries_.find(name)->second;
        entry.state = entry.session ? State::kLoaded : State::kEvicted;
        wanted = load_if_wanted(entry);
        if ((loaded_session = entry.session)) waiting.swap(entry.waiting);
    }
    arrival_.notify_all();
    for (const auto& on_loaded : waiting) on_loaded(loaded_session);
    return wanted;
}

void SessionCache::wait_for_transitions() const {
    std::shared_lock lock(mutex_);
    arrival_.wait(lock, [this] {
        return std::ranges::none_of(entries_, [](const auto& e) { return e.second.state == State::kInTransition; });
    });
}

} // namespace scanloom::sessions
