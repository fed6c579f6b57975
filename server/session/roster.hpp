#pragma once

#include "common/error/error.hpp"
#include "server/session/session.hpp"
#include "server/session/summary.hpp"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <shared_mutex>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::session {

/// What is known of one session, awake or not.
struct Listed {
    SessionInfo info;
    std::shared_ptr<Session> session; ///< null: not in memory
    Summary summary;                  ///< of one that is not
};

/// A session that is to be read from the store.
struct Resting {
    SessionInfo info;
    std::size_t pages = 0; ///< that its maps will take
};

/// Which sessions there are, which of them are in memory (awake), and who waits for those that are not.
///
/// A session is awake, or asleep, or on its way from one to the other, or to its end. Whoever holds an awake one keeps
/// it so: only those that nobody holds but this are put to sleep. What is on its way belongs to who set it off; all
/// others wait until it has arrived.
/// Thread  any. Nothing here waits but leave(). What is to be called is called without a lock, before the call returns.
class Roster {
public:
    using Clock = std::chrono::steady_clock;
    using Woken = std::function<void(Result<std::shared_ptr<Session>>)>;

    /// The session, if it is awake; it has been used at `now`. Null: it is not, or there is none.
    [[nodiscard]] std::shared_ptr<Session> find(std::string_view name, Clock::time_point now) const;

    /// Whether there is such a session and it is not awake.
    [[nodiscard]] bool must_be_waited_for(std::string_view name) const;

    [[nodiscard]] bool contains(std::string_view name) const;
    [[nodiscard]] std::optional<SessionInfo> info(std::string_view name) const;
    [[nodiscard]] std::optional<Listed> listed(std::string_view name) const;

    /// By rising name.
    [[nodiscard]] std::vector<std::shared_ptr<Session>> awake() const;
    [[nodiscard]] std::vector<Listed> all() const;

    /// Pre: there is none of that name.
    void add(std::shared_ptr<Session> session, Clock::time_point now);
    void add(SessionInfo info, Summary summary);

    /// Gives the session to `woken`: at once where it is awake (or null: there is none), else when it will be.
    /// @return a session that slept: the caller has to read it, and to say arrived().
    [[nodiscard]] std::optional<Resting> want(std::string_view name, Clock::time_point now, Woken woken);

    /// Sends to sleep, until they have `pages_wanted` pages, sessions that nobody holds and that were not used after
    /// `used_until`, the least recently used first.
    /// @return those: the caller has to close them and to say arrived().
    [[nodiscard]] std::vector<std::shared_ptr<Session>> send_to_sleep(Clock::time_point used_until,
                                                                      std::size_t pages_wanted);

    /// Sends to sleep those that have failed, whoever holds them. @return as send_to_sleep().
    [[nodiscard]] std::vector<std::shared_ptr<Session>> send_failed_to_sleep();

    /// The session is awake.
    void arrived(std::shared_ptr<Session> session, Clock::time_point now);

    /// The session is asleep. @return it again where somebody wants it meanwhile, as want().
    [[nodiscard]] std::optional<Resting> arrived(const std::string& name, Summary summary);

    /// It could not be woken: who waits for it is told. It stays asleep.
    void failed(const std::string& name, const Error& why);

    /// Waits until the session is not on its way, and then sends it to its end.
    /// @return as it was before; nothing: there is none. The caller has to say remove() or stay().
    [[nodiscard]] std::optional<Listed> leave(std::string_view name);

    /// Gone: those who wait for it are told `why`.
    void remove(std::string_view name, const Error& why);

    /// After leave(): it is as before. @return as want().
    [[nodiscard]] std::optional<Resting> stay(std::string_view name);

    /// Waits until none is on its way.
    void settle() const;

private:
    enum class State { kAwake, kAsleep, kOnItsWay };

    struct Entry {
        SessionInfo info;
        State state = State::kAsleep;
        std::shared_ptr<Session> session; // also on its way to sleep, or to its end
        Summary summary;                  // of what is not awake
        mutable std::atomic<Clock::rep> used = 0;
        std::vector<Woken> waiting;
    };
    using Entries = std::map<std::string, Entry, std::less<>>;

    [[nodiscard]] static Resting wake(Entry& entry);
    [[nodiscard]] static std::optional<Resting> wake_if_wanted(Entry& entry);
    void touch(const Entry& entry, Clock::time_point now) const;

    mutable std::shared_mutex mutex_; // guards what follows, held for moments
    mutable std::condition_variable_any arrival_;
    Entries entries_;
};

} // namespace scanloom::session
