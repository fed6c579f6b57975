#include "server/session/roster.hpp"

#include <algorithm>
#include <mutex>
#include <utility>

namespace scanloom::session {

void Roster::touch(const Entry& entry, Clock::time_point now) const { entry.used = now.time_since_epoch().count(); }

std::shared_ptr<Session> Roster::find(std::string_view name, Clock::time_point now) const {
    const std::shared_lock lock(mutex_);
    const auto found = entries_.find(name);
    if (found == entries_.end() || found->second.state != State::kAwake) return nullptr;
    touch(found->second, now);
    return found->second.session;
}

bool Roster::must_be_waited_for(std::string_view name) const {
    const std::shared_lock lock(mutex_);
    const auto found = entries_.find(name);
    return found != entries_.end() && found->second.state != State::kAwake;
}

bool Roster::contains(std::string_view name) const {
    const std::shared_lock lock(mutex_);
    return entries_.contains(name);
}

std::optional<SessionInfo> Roster::info(std::string_view name) const {
    const std::shared_lock lock(mutex_);
    const auto found = entries_.find(name);
    return found == entries_.end() ? std::nullopt : std::optional(found->second.info);
}

std::optional<Listed> Roster::listed(std::string_view name) const {
    const std::shared_lock lock(mutex_);
    const auto found = entries_.find(name);
    if (found == entries_.end()) return std::nullopt;
    const Entry& entry = found->second;
    return Listed{entry.info, entry.session, entry.summary};
}

std::vector<std::shared_ptr<Session>> Roster::awake() const {
    const std::shared_lock lock(mutex_);
    std::vector<std::shared_ptr<Session>> sessions;
    sessions.reserve(entries_.size());
    for (const auto& [name, entry] : entries_) {
        if (entry.state == State::kAwake) sessions.push_back(entry.session);
    }
    return sessions;
}

std::vector<Listed> Roster::all() const {
    const std::shared_lock lock(mutex_);
    std::vector<Listed> all;
    all.reserve(entries_.size());
    for (const auto& [name, entry] : entries_) all.push_back({entry.info, entry.session, entry.summary});
    return all;
}

void Roster::add(std::shared_ptr<Session> session, Clock::time_point now) {
    const std::unique_lock lock(mutex_);
    Entry& entry = entries_[session->info().name];
    entry.info = session->info();
    entry.session = std::move(session);
    entry.state = State::kAwake;
    touch(entry, now);
}

void Roster::add(SessionInfo info, Summary summary) {
    const std::unique_lock lock(mutex_);
    Entry& entry = entries_[info.name];
    entry.info = std::move(info);
    entry.summary = std::move(summary);
}

// Loading

Resting Roster::wake(Entry& entry) {
    entry.state = State::kOnItsWay;
    return {entry.info, entry.summary.pages};
}

std::optional<Resting> Roster::wake_if_wanted(Entry& entry) {
    if (entry.state != State::kAsleep || entry.waiting.empty()) return std::nullopt;
    return wake(entry);
}

std::optional<Resting> Roster::want(std::string_view name, Clock::time_point now, Woken woken) {
    std::shared_ptr<Session> awake;
    {
        const std::unique_lock lock(mutex_);
        const auto found = entries_.find(name);
        if (found != entries_.end()) {
            Entry& entry = found->second;
            touch(entry, now);
            if (entry.state != State::kAwake) {
                entry.waiting.push_back(std::move(woken));
                return wake_if_wanted(entry);
            }
            awake = entry.session;
        }
    }
    woken(std::move(awake));
    return std::nullopt;
}

void Roster::arrived(std::shared_ptr<Session> session, Clock::time_point now) {
    std::vector<Woken> waiting;
    {
        const std::unique_lock lock(mutex_);
        Entry& entry = entries_.find(session->info().name)->second;
        entry.info = session->info(); // its exclusions may have changed
        entry.session = session;
        entry.state = State::kAwake;
        entry.summary = {};
        touch(entry, now);
        waiting.swap(entry.waiting);
    }
    arrival_.notify_all();
    for (const auto& woken : waiting) woken(session);
}

void Roster::failed(const std::string& name, const Error& why) {
    std::vector<Woken> waiting;
    {
        const std::unique_lock lock(mutex_);
        Entry& entry = entries_.find(name)->second;
        entry.state = State::kAsleep;
        waiting.swap(entry.waiting);
    }
    arrival_.notify_all();
    for (const auto& woken : waiting) woken(why);
}

// Eviction

std::vector<std::shared_ptr<Session>> Roster::send_to_sleep(Clock::time_point used_until, std::size_t pages_wanted) {
    const std::unique_lock lock(mutex_); // no caller can obtain a session without users meanwhile
    std::vector<Entry*> idle;
    for (auto& [name, entry] : entries_) {
        const bool is_held = entry.session.use_count() > 1;
        const bool was_used = entry.used > used_until.time_since_epoch().count();
        if (entry.state == State::kAwake && !is_held && !was_used) idle.push_back(&entry);
    }
    std::ranges::sort(idle, {}, [](const Entry* entry) { return entry->used.load(); });
    std::vector<std::shared_ptr<Session>> sent;
    std::size_t pages = 0;
    for (Entry* entry : idle) {
        if (pages >= pages_wanted) break;
        entry->summary = summary_of(*entry->session->snapshot());
        pages += entry->summary.pages;
        entry->state = State::kOnItsWay;
        sent.push_back(entry->session);
    }
    return sent;
}

std::vector<std::shared_ptr<Session>> Roster::send_failed_to_sleep() {
    const std::unique_lock lock(mutex_);
    std::vector<std::shared_ptr<Session>> sent;
    for (auto& [name, entry] : entries_) {
        if (entry.state != State::kAwake || !entry.session->failure()) continue;
        entry.state = State::kOnItsWay;
        sent.push_back(entry.session);
    }
    return sent;
}

std::optional<Resting> Roster::arrived(const std::string& name, Summary summary) {
    std::optional<Resting> wanted;
    std::shared_ptr<Session> last; // destroyed after the lock is released
    {
        const std::unique_lock lock(mutex_);
        Entry& entry = entries_.find(name)->second;
        entry.session.swap(last);
        if (summary.facts) entry.info.exclusions = summary.facts->exclusions;
        entry.summary = std::move(summary);
        entry.state = State::kAsleep;
        wanted = wake_if_wanted(entry);
    }
    arrival_.notify_all();
    return wanted;
}

// Deletion

std::optional<Listed> Roster::leave(std::string_view name) {
    std::unique_lock lock(mutex_);
    for (;;) {
        const auto found = entries_.find(name);
        if (found == entries_.end()) return std::nullopt;
        Entry& entry = found->second;
        if (entry.state != State::kOnItsWay) {
            entry.state = State::kOnItsWay;
            return Listed{entry.info, entry.session, entry.summary};
        }
        arrival_.wait(lock);
    }
}

void Roster::remove(std::string_view name, const Error& why) {
    std::vector<Woken> waiting;
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
    for (const auto& woken : waiting) woken(why);
}

std::optional<Resting> Roster::stay(std::string_view name) {
    std::vector<Woken> waiting;
    std::shared_ptr<Session> awake;
    std::optional<Resting> wanted;
    {
        const std::unique_lock lock(mutex_);
        Entry& entry = entries_.find(name)->second;
        entry.state = entry.session ? State::kAwake : State::kAsleep;
        wanted = wake_if_wanted(entry);
        if ((awake = entry.session)) waiting.swap(entry.waiting);
    }
    arrival_.notify_all();
    for (const auto& woken : waiting) woken(awake);
    return wanted;
}

void Roster::settle() const {
    std::shared_lock lock(mutex_);
    arrival_.wait(lock, [this] {
        return std::ranges::none_of(entries_, [](const auto& e) { return e.second.state == State::kOnItsWay; });
    });
}

} // namespace scanloom::session
