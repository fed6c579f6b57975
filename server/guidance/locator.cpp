#include "server/guidance/locator.hpp"

#include <memory>
#include <utility>

namespace scanloom::guidance {

bool MapStart::take(store::SessionId session, RobotIndex robot, Clock::time_point now) {
    const std::lock_guard lock(mutex_);
    std::erase_if(taken_, [&](const auto& entry) { return entry.second.until <= now; });
    return taken_.try_emplace(session, Taken{robot, now + kKept}).first->second.robot == robot;
}

void MapStart::remove(store::SessionId session) {
    const std::lock_guard lock(mutex_);
    taken_.erase(session);
}

namespace {

/// Returns all reference views, also those of captures that have not ended: a robot that has not stood long enough has
/// seen something as well.
landmarks::ReferenceViews views_of(sessions::ComputedLayer<landmarks::ReferenceLayer> applied) {
    auto views = std::move(applied.state);
    for (const auto& open : applied.open) {
        if (open.capture.points.empty()) continue;
        views.push_back(std::make_shared<const landmarks::ReferenceView>(landmarks::reference_view_of(open)));
    }
    return views;
}

const Error kOnlyMap{Errc::kUndetermined, "the session has only an imported map, and localization needs laser scans of "
                                          "the session: send the first scans from a known pose"};

const Error kBegun{
    Errc::kOverloaded,
    "nothing is mapped yet, and another robot was asked to begin the map at its own pose; try again soon"};

} // namespace

Result<LocateResult> Locator::locate(const sessions::Session& session, RobotIndex robot,
                                     const landmarks::CloudView& view,
                                     const std::optional<landmarks::Neighbourhood>& near,
                                     const std::function<Result<>()>& ask) {
    const auto snapshot = session.snapshot();
    auto applied = reference_layers_.up_to(session.info(), snapshot->revision, snapshot->scan_poses,
                                           [&] { return ask().has_value(); });
    if (!applied) return applied.error();
    const Revision revision = applied->revision;
    const bool has_map = !mapping::bounds_of(*snapshot).empty();
    auto found = landmarks::locate(views_of(std::move(*applied)), view, near, ask);
    if (!found) {
        const bool is_empty = found.error().code == Errc::kNothingMapped;
        if (is_empty && has_map) return kOnlyMap;
        if (is_empty && !first_places_.take(session.info().id, robot, MapStart::Clock::now())) return kBegun;
        return found.error();
    }
    switch (found->certainty) {
    case landmarks::Certainty::kClear: return LocateResult{std::move(*found), revision};
    case landmarks::Certainty::kAmbiguous: return Error{Errc::kAmbiguous, std::move(found->why)};
    case landmarks::Certainty::kUndetermined: break;
    }
    return Error{Errc::kUndetermined, std::move(found->why)};
}

void Locator::remove(store::SessionId session) {
    reference_layers_.remove(session);
    first_places_.remove(session);
}

} // namespace scanloom::guidance
