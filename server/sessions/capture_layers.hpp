#pragma once

#include "common/error/error.hpp"
#include "core/landmarks/landmark_map.hpp"
#include "core/landmarks/reference_map.hpp"
#include "core/mapping/scan_poses.hpp"
#include "server/sessions/log_readers.hpp"
#include "server/sessions/session_info.hpp"
#include "server/store/scan_log.hpp"

#include <chrono>
#include <cstddef>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string_view>
#include <vector>

namespace scanloom::sessions {

/// Properties of a layer that is computed from captures and has add(RobotCapture), size() and snapshot().
///
/// kWhat and kInstead are for error messages: what size() counts, and what to use or expect if there are too many.
/// kSizeMax is the default bound of size(). kWithOpen selects whether ComputedLayer also contains unfinished captures.
template <class Layer>
struct LayerTraits;

template <>
struct LayerTraits<landmarks::LandmarkLayer> {
    static constexpr std::string_view kWhat = "landmarks";
    static constexpr std::string_view kInstead = "points.csv has the points that its robots observed";
    static constexpr std::size_t kSizeMax = 262'144; // 100 MiB
    static constexpr bool kWithOpen = false;
};

template <>
struct LayerTraits<landmarks::ReferenceLayer> {
    static constexpr std::string_view kWhat = "reference points";
    static constexpr std::string_view kInstead = "robots can no longer be localized in it";
    static constexpr std::size_t kSizeMax = 8'388'608; // 64 MiB
    static constexpr bool kWithOpen = true;
};

template <class Layer>
struct CaptureLayerLimits {
    std::size_t kept_max = 64;                           ///< cached sessions
    std::size_t size_max = LayerTraits<Layer>::kSizeMax; ///< of all cached layers together, and of each one
    std::chrono::milliseconds timeout{5'000};            ///< that a call reads the log or waits for another call
};

/// A layer computed from a session's captures, up to a revision of its log.
template <class Layer>
struct ComputedLayer {
    decltype(std::declval<Layer&>().snapshot()) state;
    std::vector<landmarks::RobotCapture> open; ///< unfinished captures, not in `state`; empty unless kWithOpen
    Revision revision = 0;
};

/// Computes a layer from the captures of a session on request, and caches it. Ingestion never waits for this.
///
/// The first request of a session reads its log from the beginning; later requests read only the new entries. The
/// result depends only on the log, not on the times and number of requests.
/// Memory: at most size_max, plus unfinished captures. The least recently used sessions are evicted and computed again
/// on request. For a session with more than size_max, only this fact is cached.
/// Threads: any thread that may wait for the disk. One call at a time computes for a session; others wait for it.
template <class Layer>
class CaptureLayers {
public:
    explicit CaptureLayers(store::ScanLog& log, const CaptureLayerLimits<Layer>& limits = {})
        : log_(log), limits_(limits) {}

    /// Returns the layer of the log's entries up to `revision`, or up to a later revision of an earlier request.
    ///
    /// @param poses  of the scans that robots sent without; if they were corrected, the layer is computed again
    /// @param is_wanted  called from time to time; false cancels the request
    /// Errors: kOverloaded if it takes longer than the limit `timeout` or memory ran out; after a timeout, the next
    /// request continues where this one stopped. kFull if the layer has more than size_max. kShuttingDown if is_wanted
    /// returned false. kDataLoss if an entry is damaged. Those of ScanLog::read().
    [[nodiscard]] Result<ComputedLayer<Layer>> up_to(const SessionInfo& session, Revision revision,
                                                     const mapping::ScanPoses& poses,
                                                     const std::function<bool()>& is_wanted);

    /// Removes a deleted session from the cache.
    void remove(store::SessionId session);

private:
    struct Kept {
        Kept(const SessionInfo& of, Revision corrected_at)
            : session(of.id), exclusions(of.exclusions->revision()), corrected(corrected_at),
              captures(scan_filter_of(of)) {}

        const store::SessionId session;
        const Revision exclusions; // Exclusions::revision() of the applied exclusions
        const Revision corrected;  // ScanPoses::corrected() of the poses
        std::timed_mutex mutex;
        landmarks::SessionCaptures captures; // guarded by mutex
        Layer layer;                         // guarded by mutex
        bool is_full = false;                // guarded by mutex; the layer exceeded size_max
        std::size_t size = 0;                // guarded by CaptureLayers::mutex_
    };

    [[nodiscard]] std::shared_ptr<Kept> find_or_begin(const SessionInfo& session, Revision corrected);
    [[nodiscard]] Result<> read_up_to(Kept& kept, Revision revision, const mapping::ScanPoses& poses,
                                      const std::function<bool()>& is_wanted) const;
    [[nodiscard]] Error full(const SessionInfo& session) const;
    void account(Kept& kept);

    store::ScanLog& log_;
    const CaptureLayerLimits<Layer> limits_;
    std::mutex mutex_;
    std::list<std::shared_ptr<Kept>> kept_; // most recently used first
};

/// Landmarks of sessions.
using LandmarkLayers = CaptureLayers<landmarks::LandmarkLayer>;
using ComputedLandmarks = ComputedLayer<landmarks::LandmarkLayer>;

/// Reference points of sessions, in which robots are localized.
using ReferenceLayers = CaptureLayers<landmarks::ReferenceLayer>;

extern template class CaptureLayers<landmarks::LandmarkLayer>;
extern template class CaptureLayers<landmarks::ReferenceLayer>;

} // namespace scanloom::sessions
