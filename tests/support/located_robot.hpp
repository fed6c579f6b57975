#pragma once

#include "core/landmarks/reference_map.hpp"
#include "tests/support/standing_robot.hpp"

#include <memory>
#include <vector>

/// Views of simulated worlds in the server's format.
namespace scanloom::testing_support {

inline std::shared_ptr<const landmarks::ReferenceView> as_reference(const sim::StandingView& view) {
    return std::make_shared<const landmarks::ReferenceView>(landmarks::ReferenceView{view.from, view.points});
}

inline landmarks::ReferenceViews as_references(const std::vector<sim::StandingView>& views) {
    landmarks::ReferenceViews references;
    for (const auto& view : views) references.push_back(as_reference(view));
    return references;
}

inline std::shared_ptr<const landmarks::ReferenceView> reference_view(const sim::World& world, const Pose2& place,
                                                                      sim::Random& random, int turns = 10) {
    return as_reference(sim::standing_view(world, place, random, turns));
}

} // namespace scanloom::testing_support
