#pragma once

#include "server/landmarks/landmark_map.hpp"

#include <compare>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace scanloom::live {

/// A landmark's place among all of a session, those first that were seen longest ago. Each time that it is seen it has
/// a place behind all others that were there before.
struct LandmarkPlace {
    Revision last = 0;    ///< MapLandmark::last
    std::uint64_t id = 0; ///< MapLandmark::id, plus one

    friend auto operator<=>(const LandmarkPlace&, const LandmarkPlace&) = default;
};

[[nodiscard]] inline LandmarkPlace place_of(const landmarks::MapLandmark& landmark) noexcept {
    return {landmark.last, std::uint64_t{landmark.id} + 1};
}

struct LandmarkNews {
    std::vector<const landmarks::MapLandmark*> first; ///< by their places. Of the view
    std::size_t following = 0;                        ///< that are news, too
};

/// The landmarks behind `told`, the first `most` of them and how many there are besides.
/// Cost  the blocks of landmarks that changed since.
[[nodiscard]] LandmarkNews news_in(const landmarks::LandmarkView& landmarks, LandmarkPlace told, std::size_t most);

} // namespace scanloom::live
