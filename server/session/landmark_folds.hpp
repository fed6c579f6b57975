#pragma once

#include "common/error/error.hpp"
#include "server/landmarks/landmark_layer.hpp"
#include "server/session/log_captures.hpp"
#include "server/session/session_info.hpp"
#include "server/store/scan_log.hpp"

#include <chrono>
#include <cstddef>
#include <functional>
#include <list>
#include <memory>
#include <mutex>

namespace scanloom::session {

struct LandmarkFoldsLimits {
    std::size_t kept_max = 64;                 ///< sessions
    std::size_t landmarks_max = 262'144;       ///< of all that are kept; 100 MiB. One session may have as many
    std::chrono::milliseconds patience{5'000}; ///< that a caller folds, or waits for another who does
};

/// The landmarks of a session, and what log entries they are of.
struct FoldedLandmarks {
    landmarks::LandmarkState state;
    Revision revision = 0;
};

/// Landmarks of sessions, found when somebody asks for them: robots' scans never wait for it. The first who asks has
/// the log folded from its beginning; what was folded is kept, and whoever asks again has only what came since.
///
/// The same log gives the same landmarks, whenever and in however many steps they were asked for.
/// Memory  at most landmarks_max, and what robots are in the middle of; the least recently asked for are forgotten, and
///         folded anew when they are wanted. Of a session with more than landmarks_max nothing is kept but that.
/// Thread  any that may wait for the disk; of one session, one at a time folds.
class LandmarkFolds {
public:
    explicit LandmarkFolds(store::ScanLog& log, const LandmarkFoldsLimits& limits = {}) : log_(log), limits_(limits) {}

    /// Of the log's entries up to `revision`; or up to a later one, for which somebody asked before.
    /// @param is_wanted  asked now and then
    /// Errors  kOverloaded: it takes longer than the caller may wait; asked again it goes on from where it is.
    ///         kFull: there are more than landmarks_max. kShuttingDown: it is wanted no more. kDataLoss: an entry is
    ///         damaged. Those of ScanLog::read().
    [[nodiscard]] Result<FoldedLandmarks> up_to(const SessionInfo& session, Revision revision,
                                                const std::function<bool()>& is_wanted);

    /// The session is deleted: forgets it.
    void remove(store::SessionId session);

private:
    struct Kept {
        explicit Kept(store::SessionId of) : session(of) {}

        const store::SessionId session;
        std::timed_mutex mutex;
        landmarks::SessionCaptures captures; // whoever has the mutex
        landmarks::LandmarkLayer layer;      // likewise
        bool is_full = false;                // likewise: has had more landmarks than there may be
        std::size_t landmarks = 0;           // whoever has that of all
    };

    [[nodiscard]] std::shared_ptr<Kept> find_or_begin(store::SessionId session);
    [[nodiscard]] Result<> go_on(Kept& kept, Revision revision, const std::function<bool()>& is_wanted) const;
    [[nodiscard]] Error full(const SessionInfo& session) const;
    void account(Kept& kept);

    store::ScanLog& log_;
    const LandmarkFoldsLimits limits_;
    std::mutex mutex_;
    std::list<std::shared_ptr<Kept>> kept_; // the last used first
};

} // namespace scanloom::session
