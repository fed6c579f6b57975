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

/// The landmarks of a session that were found so far. Immutable.
struct FoundLandmarks {
    landmarks::LandmarkState state;
    Revision revision = 0; ///< searched log entries
    std::string refused;   ///< why the search has ended with an error; empty: it has not
};

/// The state of a session from which an event is created.
struct Moment {
    std::shared_ptr<const mapping::Snapshot> maps;
    std::vector<bool> connected; ///< by RobotIndex; robots beyond the end are not connected
    wire::LiveState state = wire::LiveState::kOk;
    std::string reason;                                        ///< when the state is not kOk
    std::uint64_t goals_revision = 0;                          ///< LiveEvent::goals_revision
    std::shared_ptr<const FoundLandmarks> landmarks = nullptr; ///< null: none yet, or not subscribed
};

/// The subscription of a viewer: the contents of its events.
struct Wishes {
    std::array<bool, mapping::kLayers.size()> layers = {true, true, true, true}; ///< by mapping::Layer
    bool points = true;
    bool landmarks = false;
};

/// Returns the subscription that a request contains.
[[nodiscard]] Wishes wishes_of(const wire::LiveRequest& request) noexcept;

} // namespace scanloom::live
