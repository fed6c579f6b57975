#pragma once

#include "common/error/error.hpp"
#include "server/landmarks/landmark_layer.hpp"
#include "server/landmarks/reference_layer.hpp"
#include "server/session/log_captures.hpp"
#include "server/session/patient_mutex.hpp"
#include "server/session/session_info.hpp"
#include "server/store/scan_log.hpp"

#include <chrono>
#include <cstddef>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string_view>
#include <vector>

namespace scanloom::session {

/// What captures are folded into: add(RobotCapture), size(), snapshot(); for people, what it is counted in; whether
/// those that are being taken are wanted beside it.
template <class Layer>
struct FoldedInto;

template <>
struct FoldedInto<landmarks::LandmarkLayer> {
    static constexpr std::string_view kWhat = "landmarks";
    static constexpr std::string_view kInstead = "points.csv has what its robots saw";
    static constexpr std::size_t kSizeMax = 262'144; // 100 MiB
    static constexpr bool kWithOpen = false;
};

template <>
struct FoldedInto<landmarks::ReferenceLayer> {
    static constexpr std::string_view kWhat = "reference points";
    static constexpr std::string_view kInstead = "robots cannot be located in it any more";
    static constexpr std::size_t kSizeMax = 8'388'608; // 64 MiB
    static constexpr bool kWithOpen = true;
};

template <class Layer>
struct CaptureFoldsLimits {
    std::size_t kept_max = 64;                          ///< sessions
    std::size_t size_max = FoldedInto<Layer>::kSizeMax; ///< of all that are kept. One session may have as many
    std::chrono::milliseconds patience{5'000};          ///< that a caller folds, or waits for another who does
};

/// What a session's captures were folded into, and what log entries they are of.
template <class Layer>
struct Folded {
    decltype(std::declval<Layer&>().snapshot()) state;
    std::vector<landmarks::RobotCapture> open; ///< those that are being taken are not in it; empty unless kWithOpen
    Revision revision = 0;
};

/// What is made of the captures of sessions when somebody asks for it: robots' scans never wait for it. The first who
/// asks has the log folded from its beginning; what was folded is kept, and whoever asks again has only what came
/// since.
///
/// The same log gives the same, whenever and in however many steps it was asked for.
/// Memory  at most size_max, and what robots are in the middle of; the least recently asked for are forgotten, and
///         folded anew when they are wanted. Of a session with more than size_max nothing is kept but that.
/// Thread  any that may wait for the disk; of one session, one at a time folds.
template <class Layer>
class CaptureFolds {
public:
    explicit CaptureFolds(store::ScanLog& log, const CaptureFoldsLimits<Layer>& limits = {})
        : log_(log), limits_(limits) {}

    /// Of the log's entries up to `revision`; or up to a later one, for which somebody asked before.
    /// @param is_wanted  asked now and then
    /// Errors  kOverloaded: it takes longer than the caller may wait; asked again it goes on from where it is.
    ///         kFull: there is more than size_max. kShuttingDown: it is wanted no more. kDataLoss: an entry is
    ///         damaged. Those of ScanLog::read().
    [[nodiscard]] Result<Folded<Layer>> up_to(const SessionInfo& session, Revision revision,
                                              const std::function<bool()>& is_wanted);

    /// The session is deleted: forgets it.
    void remove(store::SessionId session);

private:
    struct Kept {
        explicit Kept(const SessionInfo& of)
            : session(of.id), exclusions(of.exclusions->revision()), captures(scan_filter_of(of)) {}

        const store::SessionId session;
        const Revision exclusions; // Exclusions::revision() of those that were applied
        PatientMutex mutex;
        landmarks::SessionCaptures captures; // whoever has the mutex
        Layer layer;                         // likewise
        bool is_full = false;                // likewise: has had more than there may be
        std::size_t size = 0;                // whoever has that of all
    };

    [[nodiscard]] std::shared_ptr<Kept> find_or_begin(const SessionInfo& session);
    [[nodiscard]] Result<> go_on(Kept& kept, Revision revision, const std::function<bool()>& is_wanted) const;
    [[nodiscard]] Error full(const SessionInfo& session) const;
    void account(Kept& kept);

    store::ScanLog& log_;
    const CaptureFoldsLimits<Layer> limits_;
    std::mutex mutex_;
    std::list<std::shared_ptr<Kept>> kept_; // the last used first
};

/// The landmarks of sessions.
using LandmarkFolds = CaptureFolds<landmarks::LandmarkLayer>;
using FoldedLandmarks = Folded<landmarks::LandmarkLayer>;

/// What robots can be found in.
using ReferenceFolds = CaptureFolds<landmarks::ReferenceLayer>;

extern template class CaptureFolds<landmarks::LandmarkLayer>;
extern template class CaptureFolds<landmarks::ReferenceLayer>;

} // namespace scanloom::session
