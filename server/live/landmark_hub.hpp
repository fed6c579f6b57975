#pragma once

#include "server/live/core/event_encoder.hpp"
#include "server/sessions/capture_layers.hpp"
#include "server/sessions/session.hpp"

#include <boost/asio/any_io_executor.hpp>

#include <chrono>
#include <map>
#include <memory>
#include <mutex>

namespace scanloom::live {

/// How to search for landmarks.
struct LandmarkSearch {
    boost::asio::any_io_executor executor; ///< runs the search, which waits for the disk
    std::chrono::milliseconds pause{0};    ///< LiveConfig::landmarks_pause
    std::chrono::milliseconds turn{0};     ///< LiveConfig::landmarks_turn
};

/// The landmarks of one session. They are searched only while the session has viewers, and once for all of them.
/// Threads: any thread.
class WatchedLandmarks : public std::enable_shared_from_this<WatchedLandmarks> {
public:
    using Clock = std::chrono::steady_clock;

    explicit WatchedLandmarks(sessions::LandmarkLayers& layers) : layers_(layers) {}

    struct Look {
        std::shared_ptr<const FoundLandmarks> found;        ///< null: nothing yet
        Clock::time_point until = Clock::time_point::max(); ///< call look() again then, even without a notification
    };

    /// Returns the landmarks found so far. If the log has new entries and the pause is over, starts a search on the
    /// search's executor, which notifies the session's watchers at its end.
    /// @param revision  current revision of the session
    [[nodiscard]] Look look(const std::shared_ptr<const sessions::Session>& session, Revision revision,
                            const LandmarkSearch& search);

private:
    void find(const sessions::Session& session, Revision revision, const LandmarkSearch& search) noexcept;
    [[nodiscard]] Result<FoundLandmarks> find_for_a_turn(const sessions::Session& session, Revision revision,
                                                         std::chrono::milliseconds turn);
    void keep(Result<FoundLandmarks> found, Revision revision, std::chrono::milliseconds pause);

    sessions::LandmarkLayers& layers_;
    std::mutex mutex_;
    std::shared_ptr<const FoundLandmarks> found_;
    Revision searched_ = 0; // log entries that were searched completely
    bool is_finding_ = false;
    Clock::time_point next_; // earliest start of the next search
};

/// The landmarks of all sessions that have viewers.
/// Threads: any thread.
class LandmarkHub {
public:
    explicit LandmarkHub(sessions::LandmarkLayers& layers) : layers_(layers) {}

    /// Returns the landmarks of a session. Callers that hold the result at the same time share one object.
    [[nodiscard]] std::shared_ptr<WatchedLandmarks> of(store::SessionId session);

private:
    sessions::LandmarkLayers& layers_;
    std::mutex mutex_;
    std::map<store::SessionId, std::weak_ptr<WatchedLandmarks>> watched_;
};

} // namespace scanloom::live
