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

/// What a reader of tiles asks for, and when: which tiles of a layer there are, these one after the other, then the
/// same of the next layer, round and round.
///
/// Tiles alone take turns, `rate` a second. The list is asked for as soon as the last tile is there; only one without a
/// tile takes a turn, so that nobody asks without end.
class TileTour {
public:
    struct Step {
        std::string layer;
        bool is_list = false;
        TilePlace tile; ///< unless it is the list
        Micros at = 0;  ///< when it is meant to be asked for; a list's may be over
    };

    TileTour(double rate, Micros first);

    [[nodiscard]] Step next();

    /// What the list held that was asked for; none where it could not be had.
    void listed(std::vector<TilePlace> tiles);

private:
    Micros period_;
    Micros turn_;
    std::size_t round_ = 0;
    std::vector<TilePlace> tiles_;
    std::size_t asked_for_ = 0; // of them
};

} // namespace scanloom::load
