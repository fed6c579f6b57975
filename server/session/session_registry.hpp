#pragma once

#include "common/error/error.hpp"
#include "common/scan/session_options.hpp"
#include "server/session/maker.hpp"
#include "server/session/roster.hpp"
#include "server/session/session_factory.hpp"
#include "server/store/scan_log.hpp"

#include <boost/asio/any_io_executor.hpp>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace scanloom::session {

/// What whoever names a session that does not exist is told. `name` may be anything.
[[nodiscard]] Error no_such_session(std::string_view name);

/// Where a registry has its work done, and what it may use.
struct RegistryConfig {
    boost::asio::any_io_executor compute;                   ///< sessions weave
    std::function<double()> now;                            ///< seconds since the epoch, for SessionInfo::created
    std::optional<boost::asio::any_io_executor> may_wait{}; ///< sessions write checkpoints; nothing: on `compute`
    std::optional<boost::asio::any_io_executor> reading{};  ///< sessions are read from the store; likewise

    std::function<Roster::Clock::time_point()> clock = [] { return Roster::Clock::now(); };

    /// The maps of all sessions that are in memory. Where it is used up, those that nobody uses leave; where that does
    /// not help, scans are refused, and sessions that are asked for.
    std::size_t pages_max = std::numeric_limits<std::int64_t>::max();
    Roster::Clock::duration idle_after = std::chrono::minutes(10); ///< for tidy()
};

/// All sessions by name.
///
/// A session that nobody uses leaves memory, with a checkpoint at the end of its log, and is read again when somebody
/// asks for it: robots, viewers and requests hold the session they use. What a list shows of it stays.
/// Thread  any. create(), remove(), recover(), drain() and the wake() that returns a session wait for the disk: not on
///         I/O threads, nor on those of the config's executors.
class SessionRegistry {
public:
    SessionRegistry(store::ScanLog& log, RegistryConfig config);

    /// Finds all that is stored. Sessions with a checkpoint at their log's end stay there; the others are woven: newest
    /// checkpoint, then the rest of the log. One that is damaged is left out and listed by damaged(); the others are
    /// not held up by it. drain() stops it early and keeps what has been woven.
    /// Errors  kStoreFailed: the sessions cannot be listed.
    /// Pre     called once, before anything else.
    [[nodiscard]] Result<> recover();

    /// The session, if it is in memory; null if it is not, or if there is none.
    [[nodiscard]] std::shared_ptr<Session> find(std::string_view name) const;

    /// Whether there is such a session, and wake() would have to read it first.
    [[nodiscard]] bool is_asleep(std::string_view name) const { return roster_.must_be_waited_for(name); }

    /// The session, read from the store if need be. `woken` is called once, perhaps at once.
    /// Errors  kNotFound; kOverloaded: there is no memory for it now; kStoreFailed; kShuttingDown. Of one that is
    ///         damaged: as in damaged().
    void wake(std::string_view name, Roster::Woken woken);
    [[nodiscard]] Result<std::shared_ptr<Session>> wake(std::string_view name);

    /// Those in memory, by rising name.
    [[nodiscard]] std::vector<std::shared_ptr<Session>> list() const { return roster_.awake(); }

    /// All but the damaged ones, by rising name.
    [[nodiscard]] std::vector<Listed> all() const { return roster_.all(); }

    /// Nothing: there is no such session, or it is damaged.
    [[nodiscard]] std::optional<Listed> listed(std::string_view name) const { return roster_.listed(name); }
    [[nodiscard]] std::optional<SessionInfo> info(std::string_view name) const { return roster_.info(name); }

    /// What could not be recovered: name and reason.
    [[nodiscard]] std::map<std::string, Error> damaged() const;

    /// Errors  kInvalidField (name or an option), kAlreadyExists, kStoreFailed, kShuttingDown; kFull: the maker has
    ///         made as many as it may.
    [[nodiscard]] Result<std::shared_ptr<Session>> create(std::string_view name, const SessionOptions& options,
                                                          const Maker& maker = {});

    /// The same, beginning with a map that was made elsewhere: its patches are the log's first entries. Where a crash
    /// comes between, the next start removes what there is of it.
    /// Errors  also kInvalidField, kFull: the map at these cells; kOverloaded: there is no memory for it.
    [[nodiscard]] Result<std::shared_ptr<Session>> import_map(std::string_view name, const SessionOptions& options,
                                                              const std::vector<MapPatch>& patches,
                                                              const Maker& maker = {});

    /// Excludes scans of a robot from the session's maps by an entry of its log. The session leaves memory: robots and
    /// viewers are asked to connect again, and its maps are computed again from the log when it is read.
    /// Pre     the robot has joined the session.
    /// Errors  kNotFound: no such session; kFull: Exclusions::kMost are in effect; kOverloaded, kStoreFailed: the entry
    ///         was not stored; kShuttingDown.
    [[nodiscard]] Result<Exclusion> exclude(std::string_view name, RobotIndex robot,
                                            const std::variant<StampRange, SeqRange>& scans);

    /// Lifts an exclusion in the same way. Errors  also kNotFound: none of that id is in effect.
    [[nodiscard]] Result<> lift_exclusion(std::string_view name, std::uint64_t id);

    /// Deletes the session, its log and its maps, also a damaged one. Errors: kNotFound, kStoreFailed.
    [[nodiscard]] Result<> remove(std::string_view name);

    /// Sends to sleep whatever nobody has used for a while, and tries again to read what there was no room for. Where
    /// the store takes changes, sessions that have failed, with it or for themselves, are read again, as after a
    /// restart; their links and viewers are told to come back. To be called from time to time; waits for nothing.
    void tidy();

    /// Refuses new sessions, lets recover() give up, closes all, returns when everything submitted is durable.
    void drain();

    /// Lets drain() end soon, as Session::hurry() says.
    void hurry();

    [[nodiscard]] const SessionCounters& counters() const noexcept { return *factory_.counters; }

    [[nodiscard]] bool is_draining() const noexcept { return draining_; }

    /// Of the maps that are in memory.
    [[nodiscard]] const PageBudget& pages() const noexcept { return *pages_; }

private:
    struct Damaged {
        store::SessionId id = 0;
        Error error;
    };

    [[nodiscard]] Result<> check_new(std::string_view name, const Maker& maker) const;
    [[nodiscard]] std::shared_ptr<Session> add(SessionInfo info, mapping::Projection projection);
    void give_back_memory(std::size_t pages);

    void recover_one(const SessionInfo& info, std::uint32_t map_patches, std::function<void()> done);
    [[nodiscard]] bool can_stay_asleep(const SessionInfo& info, std::uint32_t map_patches);
    void add_recovered(std::shared_ptr<Session> session, std::function<void()> done);
    void keep_damaged(std::string name, store::SessionId id, Error why);
    [[nodiscard]] std::optional<Error> damage_of(std::string_view name) const;

    /// Somebody waits for it.
    struct Wanted {
        Resting resting;
        Roster::Clock::time_point until; // and no longer, where there is no room
    };

    void start_reading(const Resting& resting);
    void start_reading_again();
    void read(const Wanted& wanted);
    [[nodiscard]] bool take_room(const Wanted& wanted);
    [[nodiscard]] std::size_t spare_pages() const noexcept;
    void make_room(std::size_t pages);
    void read_failed_again();
    void lay_down(std::vector<std::shared_ptr<Session>> sessions, const Error& why);
    void is_asleep_now(const Session& session);

    using MakeEntry = std::function<Result<LogEntry>(const SessionInfo&)>;
    [[nodiscard]] Result<Revision> change_exclusions(std::string_view name, const MakeEntry& make);

    store::ScanLog& log_;
    const RegistryConfig config_;
    const boost::asio::any_io_executor may_wait_;
    const boost::asio::any_io_executor reading_;
    const std::shared_ptr<PageBudget> pages_;
    SessionFactory factory_;
    std::atomic<bool> draining_ = false;
    std::atomic<bool> hurried_ = false;

    std::mutex changing_; // held over recover(), create() and remove(), which write to the store first
    Roster roster_;

    mutable std::shared_mutex damaged_mutex_;
    std::map<std::string, Damaged, std::less<>> damaged_;

    std::mutex room_mutex_;                // guards what follows
    std::vector<Wanted> waiting_for_room_; // to be tried again
    std::size_t freed_pages_ = 0;          // since memory was given back to the system
};

} // namespace scanloom::session
