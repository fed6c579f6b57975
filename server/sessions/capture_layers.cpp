#include "server/sessions/capture_layers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <new>
#include <utility>

namespace scanloom::sessions {
namespace {

using Clock = std::chrono::steady_clock;

const Error kTooMany{Errc::kFull, "more than there may be"};

Error not_yet(std::string_view what, Revision applied, Revision revision) {
    return {Errc::kOverloaded,
            fmt::format("the {} of {} of {} log entries are found; repeat the request to continue from there", what,
                        applied, revision)};
}

} // namespace

template <class Layer>
Result<ComputedLayer<Layer>> CaptureLayers<Layer>::up_to(const SessionInfo& session, Revision revision,
                                                         const mapping::ScanPoses& poses,
                                                         const std::function<bool()>& is_wanted) {
    const auto kept = find_or_begin(session, poses.corrected());
    // By the system clock, because ThreadSanitizer of GCC 12 does not support timed waits by the steady clock. If the
    // system clock jumps, this call waits until others finish, which `timeout` bounds too, or asks for a retry at
    // once.
    const std::unique_lock computing(kept->mutex, std::chrono::system_clock::now() + limits_.timeout);
    if (!computing) {
        return Error{Errc::kOverloaded,
                     fmt::format("another request is finding the {} of this session at this moment; try again",
                                 LayerTraits<Layer>::kWhat)};
    }
    if (kept->is_full) return full(session);
    try {
        const auto done = read_up_to(*kept, revision, poses, is_wanted);
        if (kept->layer.size() > limits_.size_max) { // the size never decreases, so this is final
            kept->is_full = true;
            kept->captures = landmarks::SessionCaptures(scan_filter_of(session));
            kept->layer = {};
        }
        account(*kept);
        if (kept->is_full) return full(session);
        if (!done) return done.error();
        ComputedLayer<Layer> applied{kept->layer.snapshot(), {}, kept->captures.revision()};
        if constexpr (LayerTraits<Layer>::kWithOpen) applied.open = kept->captures.open();
        return applied;
    } catch (const std::bad_alloc&) {
        kept->captures = landmarks::SessionCaptures(scan_filter_of(session)); // a part may be missing
        kept->layer = {};
        remove(session.id);
        return Error{Errc::kOverloaded,
                     fmt::format("there is no memory left for these {}; try again later", LayerTraits<Layer>::kWhat)};
    }
}

template <class Layer>
Error CaptureLayers<Layer>::full(const SessionInfo& session) const {
    return {Errc::kFull, fmt::format("session '{}' has more than {} {}, the most that are kept; {}", session.name,
                                     limits_.size_max, LayerTraits<Layer>::kWhat, LayerTraits<Layer>::kInstead)};
}

template <class Layer>
Result<> CaptureLayers<Layer>::read_up_to(Kept& kept, Revision revision, const mapping::ScanPoses& poses,
                                          const std::function<bool()>& is_wanted) const {
    const auto deadline = Clock::now() + limits_.timeout;
    const auto add = [&](const landmarks::RobotCapture& ended) -> Result<> {
        kept.layer.add(ended);
        return kept.layer.size() <= limits_.size_max ? Result<>() : kTooMany;
    };
    const auto ask = [&](Revision read) -> Result<> {
        if (!is_wanted()) return Error{Errc::kShuttingDown, "the server is shutting down; try again when it is back"};
        if (Clock::now() >= deadline) return not_yet(LayerTraits<Layer>::kWhat, read, revision);
        return {};
    };
    return read_captures(log_, kept.session, kept.captures, revision, poses, add, ask);
}

template <class Layer>
auto CaptureLayers<Layer>::find_or_begin(const SessionInfo& session, Revision corrected) -> std::shared_ptr<Kept> {
    const std::lock_guard lock(mutex_);
    auto found = std::ranges::find(kept_, session.id, [](const auto& kept) { return kept->session; });
    if (found != kept_.end() &&
        ((*found)->exclusions < session.exclusions->revision() || (*found)->corrected < corrected)) {
        kept_.erase(found);
        found = kept_.end();
    }
    if (found == kept_.end()) {
        kept_.push_front(std::make_shared<Kept>(session, corrected));
    } else {
        kept_.splice(kept_.begin(), kept_, found);
    }
    if (kept_.size() > limits_.kept_max) kept_.pop_back();
    return kept_.front();
}

/// Evicts the least recently used sessions until the others fit into size_max.
template <class Layer>
void CaptureLayers<Layer>::account(Kept& kept) {
    const std::lock_guard lock(mutex_);
    kept.size = kept.layer.size();
    std::size_t sum = 0;
    std::erase_if(kept_, [&](const auto& other) {
        sum += other->size;
        return sum > limits_.size_max && other.get() != &kept;
    });
}

template <class Layer>
void CaptureLayers<Layer>::remove(store::SessionId session) {
    const std::lock_guard lock(mutex_);
    std::erase_if(kept_, [&](const auto& kept) { return kept->session == session; });
}

template class CaptureLayers<landmarks::LandmarkLayer>;
template class CaptureLayers<landmarks::ReferenceLayer>;

} // namespace scanloom::sessions
