#pragma once

#include "server/live/core/moment.hpp"
#include "server/session/capture_folds.hpp"
#include "server/session/session.hpp"

#include <boost/asio/any_io_executor.hpp>

#include <chrono>
#include <map>
#include <memory>
#include <mutex>

namespace scanloom::live {

/// How landmarks are looked for.
struct LandmarkSearch {
    boost::asio::any_io_executor executor; ///< where the disk may be waited for
    std::chrono::milliseconds pause{0};    ///< LiveConfig::landmarks_pause
    std::chrono::milliseconds turn{0};     ///< LiveConfig::landmarks_turn
};

/// The landmarks of one session, found for all who watch it at once, and only while somebody does.
/// Thread  any.
class WatchedLandmarks : public std::enable_shared_from_this<WatchedLandmarks> {
public:
    using Clock = std::chrono::steady_clock;

    explicit WatchedLandmarks(session::LandmarkFolds& folds) : folds_(folds) {}

    struct Look {
        std::shared_ptr<const FoundLandmarks> found;        ///< null: nothing yet
        Clock::time_point until = Clock::time_point::max(); ///< look again then, also if nobody says that it changed
    };

    /// What was found last. Where the session's log has come further, to `revision`, and it is time for that, what came
    /// since is found on the search's executor; the session's watchers are told when it is there.
    [[nodiscard]] Look look(const std::shared_ptr<const session::Session>& session, Revision revision,
                            const LandmarkSearch& search);

private:
    void find(const session::Session& session, Revision revision, const LandmarkSearch& search) noexcept;
    [[nodiscard]] Result<FoundLandmarks> find_for_a_turn(const session::Session& session, Revision revision,
                                                         std::chrono::milliseconds turn);
    void keep(Result<FoundLandmarks> found, Revision revision, std::chrono::milliseconds pause);

    session::LandmarkFolds& folds_;
    std::mutex mutex_;
    std::shared_ptr<const FoundLandmarks> found_;
    Revision searched_ = 0; // log entries in which there is nothing more to find
    bool is_finding_ = false;
    Clock::time_point next_; // search, at the earliest
};

/// Those of all sessions that are watched.
/// Thread  any.
class LandmarkHub {
public:
    explicit LandmarkHub(session::LandmarkFolds& folds) : folds_(folds) {}

    /// The same for all who hold it at the same time.
    [[nodiscard]] std::shared_ptr<WatchedLandmarks> of(store::SessionId session);

private:
    session::LandmarkFolds& folds_;
    std::mutex mutex_;
    std::map<store::SessionId, std::weak_ptr<WatchedLandmarks>> watched_;
};

} // namespace scanloom::live
