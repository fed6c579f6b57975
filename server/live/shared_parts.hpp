#pragma once

#include "core/localization/session_poses.hpp"
#include "server/sessions/session.hpp"

#include <boost/asio/any_io_executor.hpp>

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>

namespace scanloom::live {

/// The parts of a session that are large or take long to compute, once for all its viewers. Immutable.
struct SharedParts {
    std::shared_ptr<const std::string> map;       ///< the occupancy as an encoded grid; null: none, or too large
    std::shared_ptr<const std::string> frontiers; ///< as an encoded scene; null: not known yet
    bool is_map_too_large = false;                ///< see kGridCellsMax
    std::shared_ptr<const localization::PoseGraphView> graph; ///< null: not known yet
    Revision revision = 0;                                    ///< of the maps that they are computed from
};

/// Larger maps are not sent as one grid: 200 m x 200 m in cells of 5 cm.
inline constexpr std::int64_t kGridCellsMax = 16'000'000;

/// Computes the SharedParts of one session, at most once a second, while viewers ask for them.
/// Threads: any thread.
class WatchedParts : public std::enable_shared_from_this<WatchedParts> {
public:
    using Clock = std::chrono::steady_clock;
    using SessionPtr = std::shared_ptr<sessions::Session>;

    struct Look {
        std::shared_ptr<const SharedParts> parts;           ///< not null
        Clock::time_point until = Clock::time_point::max(); ///< call look() again then, even without a notification
    };

    /// Returns what was computed last. If the maps are newer and the pause is over, it begins to compute newer ones,
    /// which notifies the session's watchers at its end: the pose graph on the session's strand, the others on
    /// `executor`.
    [[nodiscard]] Look look(const SessionPtr& session, Clock::time_point now,
                            const boost::asio::any_io_executor& executor);

private:
    static constexpr std::chrono::seconds kPause{1};

    void compute(const sessions::Session& session, std::shared_ptr<const localization::PoseGraphView> graph) noexcept;

    std::mutex mutex_;
    std::shared_ptr<const SharedParts> parts_ = std::make_shared<const SharedParts>();
    bool is_computing_ = false;
    Clock::time_point next_; // earliest start of the next computation
};

/// The WatchedParts of all sessions that have viewers.
/// Threads: any thread.
class PartsHub {
public:
    /// Returns those of a session. Callers that hold the result at the same time share one object.
    [[nodiscard]] std::shared_ptr<WatchedParts> of(store::SessionId session);

private:
    std::mutex mutex_;
    std::map<store::SessionId, std::weak_ptr<WatchedParts>> watched_;
};

} // namespace scanloom::live
