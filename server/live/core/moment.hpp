#pragma once

#include "common/wire/live.hpp"
#include "server/landmarks/landmark_layer.hpp"
#include "server/mapping/layer.hpp"
#include "server/mapping/snapshot.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace scanloom::live {

/// What landmarks of a session were found. Immutable.
struct FoundLandmarks {
    landmarks::LandmarkState state;
    Revision revision = 0; ///< log entries in which they were looked for
    std::string refused;   ///< why no more are found; empty: they are
};

/// All that an event is made from: a session as it is now.
struct Moment {
    std::shared_ptr<const mapping::Snapshot> maps;
    std::vector<bool> connected; ///< by RobotIndex; those beyond the end have no link
    wire::LiveState state = wire::LiveState::kOk;
    std::string reason;                                        ///< when the state is not kOk
    std::uint64_t goals_revision = 0;                          ///< LiveEvent::goals_revision
    std::shared_ptr<const FoundLandmarks> landmarks = nullptr; ///< null: none yet, or nobody asked
};

/// What a viewer wants to be told.
struct Wishes {
    std::array<bool, mapping::kLayers.size()> layers = {true, true, true, true}; ///< by mapping::Layer
    bool points = true;
    bool landmarks = false;
};

[[nodiscard]] Wishes wishes_of(const wire::LiveRequest& request) noexcept;

} // namespace scanloom::live
