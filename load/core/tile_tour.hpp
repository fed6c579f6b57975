#pragma once

#include "load/core/micros.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace scanloom::load {

/// A tile of zoom 9.
struct TilePlace {
    std::uint32_t x = 0;
    std::uint32_t y = 0;
};

/// What a tile reader requests and when: the list of a layer's tiles, each of these tiles, then the same for the next
/// layer, again and again.
///
/// Only tiles are paced, at `rate` per second. A list is requested as soon as the last tile has arrived; a list without
/// tiles is paced like a tile, so that requests do not repeat without end.
class TileTour {
public:
    struct Step {
        std::string layer;
        bool is_list = false;
        TilePlace tile; ///< unless is_list
        Micros at = 0;  ///< intended time of the request; may be in the past for a list
    };

    TileTour(double rate, Micros first);

    [[nodiscard]] Step next();

    /// Sets the tiles of the requested list; none if the request failed.
    void listed(std::vector<TilePlace> tiles);

private:
    Micros period_;
    Micros turn_;
    std::size_t round_ = 0;
    std::vector<TilePlace> tiles_;
    std::size_t requested_ = 0; // number of tiles_ requested so far
};

} // namespace scanloom::load
