#pragma once

#include "server/landmarks/landmark_map.hpp"

#include <compare>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace scanloom::live {

/// Sort key of a session's landmarks: by the revision at which they were last seen. A landmark that is seen again moves
/// behind all earlier ones.
struct LandmarkPlace {
    Revision last = 0;    ///< MapLandmark::last
    std::uint64_t id = 0; ///< MapLandmark::id, plus one

    friend auto operator<=>(const LandmarkPlace&, const LandmarkPlace&) = default;
};

[[nodiscard]] inline LandmarkPlace place_of(const landmarks::MapLandmark& landmark) noexcept {
    return {landmark.last, std::uint64_t{landmark.id} + 1};
}

/// New or changed landmarks.
struct LandmarkNews {
    std::vector<const landmarks::MapLandmark*> first; ///< sorted by LandmarkPlace; point into the view
    std::size_t following = 0;                        ///< number of further ones, not in `first`
};

/// Returns the first `most` landmarks after `told`, and the number of the others.
/// Cost: proportional to the blocks of landmarks that changed since `told`.
[[nodiscard]] LandmarkNews news_in(const landmarks::LandmarkView& landmarks, LandmarkPlace told, std::size_t most);

} // namespace scanloom::live
