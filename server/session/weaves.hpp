#pragma once

#include "common/error/error.hpp"
#include "server/session/session.hpp"
#include "server/session/weave.hpp"
#include "server/store/scan_log.hpp"

#include <boost/asio/any_io_executor.hpp>

#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string_view>
#include <vector>

namespace scanloom::session {

struct WeavesLimits {
    std::size_t waiting_max = 16;          ///< weaves that have not ended
    std::size_t kept_max = 32;             ///< ended ones
    std::size_t chunks_max = 131'072;      ///< of all that are under way: 2.5 GiB
    std::size_t chunks_kept_max = 131'072; ///< of all that are done: 2.5 GiB; as much as one of them can have
};

/// The weaves of all sessions: those that wait, those under way, and the newest of those that ended.
///
/// One that begins does so where the furthest of those stands that hold the same map at an earlier time; if that one is
/// still on its way to where it ends, the other begins when it is there. So whoever steps through the history of a
/// session has each entry folded once, and going back costs no more than from the furthest that is kept before.
///
/// Queue   "weaves": at most waiting_max that have not ended; one more is refused with kOverloaded. The least recently
///         used of those that are done go when others need their place, those that are not listed first.
/// Memory  each counts with all of its chunks, though those that began from each other share what neither has changed
///         since: the bounds hold whichever of them go first.
/// Thread  any; nothing here waits.
class Weaves {
public:
    /// Weaving happens on `executor`, as many at a time as it has threads; one that is asked for more before its turn
    /// is over takes another turn. The log and this must outlive what runs there.
    Weaves(store::ScanLog& log, boost::asio::any_io_executor executor, const WeavesLimits& limits = {});

    enum class Listing { kListed, kUnlisted };

    /// Starts the weave, or finds the one that is asked for again and has it go on to where the session is by now,
    /// `newest`; one that failed or was cancelled is tried again from the start. Once listed, it stays so.
    /// Errors  kOverloaded, kShuttingDown.
    [[nodiscard]] Result<std::shared_ptr<Weave>> start(const SessionInfo& session, const WeaveRequest& request,
                                                       Revision newest, Listing listing = Listing::kListed);

    /// Null when there is none, or no longer.
    [[nodiscard]] std::shared_ptr<Weave> find(store::SessionId session, std::string_view id);

    /// Those that are listed, the last started first.
    [[nodiscard]] std::vector<std::shared_ptr<Weave>> list(store::SessionId session) const;

    /// Cancels and forgets it. @return whether there was such a weave.
    bool remove(store::SessionId session, std::string_view id);

    /// The session is deleted: cancels and forgets all of its weaves.
    void remove_all(store::SessionId session);

    /// How many have not ended.
    [[nodiscard]] std::size_t under_way() const;

    /// Of all that are under way or kept, whatever they share.
    [[nodiscard]] std::int64_t chunks() const;

    /// Starts nothing more, cancels all.
    void stop();

private:
    /// Where a weave can begin.
    struct Start {
        std::shared_ptr<Weave> weave;
        Revision at = 0;
        bool is_on_its_way = false; // it goes on from there, but no further than to where the other may begin
    };

    [[nodiscard]] Result<std::shared_ptr<Weave>> started(const SessionInfo& session, const WeaveRequest& request,
                                                         Revision target);
    [[nodiscard]] std::shared_ptr<Weave> touch(store::SessionId session, std::string_view id);
    [[nodiscard]] std::size_t count_under_way() const;
    [[nodiscard]] Result<> check_room() const;
    void launch(const std::shared_ptr<Weave>& weave);
    void post(std::shared_ptr<Weave> weave);
    void run(const std::shared_ptr<Weave>& weave);
    [[nodiscard]] bool begin(const std::shared_ptr<Weave>& weave);
    [[nodiscard]] std::optional<Start> furthest_before(const Weave& weave) const;
    void launch_those_behind(const Weave& ended);
    void evict();

    store::ScanLog& log_;
    boost::asio::any_io_executor executor_;
    const WeavesLimits limits_;
    PageBudget budget_;

    mutable std::mutex mutex_;
    bool stopped_ = false;
    std::uint64_t listed_ = 0;                 // how often one was
    std::list<std::shared_ptr<Weave>> weaves_; // the last used first

    struct Behind {
        std::shared_ptr<Weave> ahead;
        std::shared_ptr<Weave> weave; // begins when the one ahead has ended, however it did
    };
    std::vector<Behind> behind_;
};

} // namespace scanloom::session
