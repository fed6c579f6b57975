#include "server/sessions/background_check.hpp"

#include "server/log/context.hpp"
#include "server/sessions/session_check.hpp"

#include <spdlog/spdlog.h>

#include <sys/resource.h>

#include <chrono>
#include <exception>
#include <utility>

namespace scanloom::sessions {
namespace {

constexpr int kNiceness = 19;
constexpr std::chrono::seconds kWarnEvery{10};

/// Lowers the priority of this thread, so that ingestion and requests run first.
void step_back() { static_cast<void>(setpriority(PRIO_PROCESS, 0, kNiceness)); }

double now_in_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

} // namespace

BackgroundCheck::BackgroundCheck(store::ScanLog& log, const SessionRegistry& sessions, double bytes_per_second)
    : log_(log), sessions_(sessions), read_rate_(bytes_per_second, 0.0, now_in_seconds()) {}

BackgroundCheck::~BackgroundCheck() {
    stop();
    if (thread_.joinable()) thread_.join();
}

void BackgroundCheck::start() {
    thread_ = std::thread([this] {
        step_back();
        try {
            run();
        } catch (const std::exception& failure) { // memory ran out, for instance
            spdlog::error("the check of the stored sessions ended early: {}", failure.what());
        }
        const std::lock_guard lock(mutex_);
        done_ = true;
        changed_.notify_all();
    });
}

void BackgroundCheck::stop() {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
    changed_.notify_all();
}

void BackgroundCheck::run() {
    std::map<store::SessionId, std::string> evicted;
    for (const auto& listed : sessions_.all()) {
        if (!listed.session) evicted.emplace(listed.info.id, listed.info.name);
    }
    const auto stored = log_.sessions();
    if (!stored) return;
    for (const auto& session : *stored) {
        const auto name = evicted.find(session.id);
        if (name != evicted.end()) check(session, name->second);
    }
}

void BackgroundCheck::check(const store::StoredSession& stored, const std::string& name) {
    const auto found =
        check_session(log_, stored, CheckDepth::kLog, [this](std::size_t bytes) { return pause_after(bytes); });
    if (!found) return; // stop() was called
    // A session that was deleted in the meantime, or whose store failed, cannot be read but may be intact.
    const bool is_damage = found->damage && is_still_there(name, stored.id) && !log_.stats().last_error;
    if (is_damage) keep(name, stored.id, *found->damage);
    const std::lock_guard lock(mutex_);
    ++checked_;
}

void BackgroundCheck::note(store::SessionId id, const Error& why) {
    if (log_.stats().last_error) return; // the store failed, which is reported elsewhere; the log may be intact
    for (const auto& listed : sessions_.all()) {
        if (listed.info.id != id) continue;
        if (why.code == Errc::kDataLoss) return keep(listed.info.name, id, why);
        const std::lock_guard lock(mutex_);
        const auto now = std::chrono::steady_clock::now();
        if (now < next_warning_) return;
        next_warning_ = now + kWarnEvery; // clients may request it often
        log::warn({.session = listed.info.name}, "session '{}' cannot be read: {}", listed.info.name, why.message);
    }
}

/// Records the damage and logs it once per session.
void BackgroundCheck::keep(const std::string& name, store::SessionId id, const Error& why) {
    const std::lock_guard lock(mutex_);
    if (const auto known = damaged_.find(name); known != damaged_.end() && known->second.id == id) return;
    log::error({.session = name}, "session '{}' is damaged: {}", name, why.message);
    damaged_[name] = {id, why};
}

Result<> BackgroundCheck::pause_after(std::size_t bytes) {
    const std::chrono::duration<double> pause(read_rate_.take(static_cast<double>(bytes), now_in_seconds()));
    std::unique_lock lock(mutex_);
    constexpr auto kWorthAWait = std::chrono::milliseconds(10); // waking up costs more than a few entries
    if (!stopped_ && pause > kWorthAWait) changed_.wait_for(lock, pause, [this] { return stopped_; });
    if (!stopped_) return {};
    return Error{Errc::kShuttingDown, "stopped before the log's end"};
}

bool BackgroundCheck::is_still_there(const std::string& name, store::SessionId id) const {
    const auto info = sessions_.info(name);
    return info && info->id == id;
}

std::map<std::string, Error> BackgroundCheck::damaged() const {
    std::map<std::string, Damaged> found;
    {
        const std::lock_guard lock(mutex_);
        found = damaged_;
    }
    std::map<std::string, Error> reasons;
    for (const auto& [name, damaged] : found) {
        if (is_still_there(name, damaged.id)) reasons.emplace(name, damaged.why);
    }
    return reasons;
}

std::uint64_t BackgroundCheck::checked() const {
    const std::lock_guard lock(mutex_);
    return checked_;
}

void BackgroundCheck::wait() const {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return done_; });
}

} // namespace scanloom::sessions
