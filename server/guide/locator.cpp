#include "server/guide/locator.hpp"

#include <memory>
#include <utility>

namespace scanloom::guide {
namespace {

/// All there is; a robot that has stood too short a time for its capture to end has seen something, too.
landmarks::ReferenceViews views_of(session::Folded<landmarks::ReferenceLayer> folded) {
    auto views = std::move(folded.state);
    for (const auto& open : folded.open) {
        if (open.capture.points.empty()) continue;
        views.push_back(std::make_shared<const landmarks::ReferenceView>(landmarks::reference_view_of(open)));
    }
    return views;
}

} // namespace

Result<Located> Locator::locate(const session::Session& session, const landmarks::CloudView& view,
                                const std::optional<landmarks::Neighbourhood>& near,
                                const std::function<Result<>()>& ask) {
    auto folded = folds_.up_to(session.info(), session.snapshot()->revision, [&] { return ask().has_value(); });
    if (!folded) return folded.error();
    const Revision revision = folded->revision;
    auto found = landmarks::locate(views_of(std::move(*folded)), view, near, ask);
    if (!found) return found.error();
    switch (found->certainty) {
    case landmarks::Certainty::kClear: return Located{std::move(*found), revision};
    case landmarks::Certainty::kAmbiguous: return Error{Errc::kAmbiguous, std::move(found->why)};
    case landmarks::Certainty::kUndetermined: break;
    }
    return Error{Errc::kUndetermined, std::move(found->why)};
}

} // namespace scanloom::guide
