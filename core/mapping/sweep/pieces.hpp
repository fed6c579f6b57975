#pragma once

#include "core/mapping/sweep/contours.hpp"

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

/// Working data of flip_crossings(), common to all instruction sets.
namespace scanloom::mapping::simd {

constexpr std::size_t kLanesMax = 32; ///< doubles in the widest vector register
static_assert(kRingPadding > kLanesMax);

/// Pieces of a border that cross rows, with one array for each number of a piece.
template <std::size_t numbers>
struct Pieces {
    std::array<double*, numbers> of; ///< by number: one array of `count` values each
    std::size_t count = 0;           ///< pieces
};

// The first two numbers are the rows that a piece crosses: first, and one past the last.
enum : std::size_t { kFrom, kTo };
enum : std::size_t { kSlope = 2, kEdgeY, kLeft, kRight, kSpokeNumbers };
enum : std::size_t { kEdgeX = kSlope, kOneEnd = kLeft, kOtherEnd = kRight }; // before MeasureSpokes()
enum : std::size_t { kSquare = 2, kSign, kArcNumbers };

/// The pieces of a contour and of the plane within it.
struct Crossings {
    Pieces<kSpokeNumbers> spokes; ///< of the contour, along edges
    Pieces<kArcNumbers> arcs;     ///< of the contour
    Pieces<kSpokeNumbers> steps;  ///< of the plane only, along edges
};

/// Returns arrays with room for the pieces of any contours. Each thread that integrates scans keeps its arrays from
/// scan to scan.
/// @param sectors   of the ring
/// @param contours  at most kContoursMax
inline std::array<Crossings, kContoursMax> room_for(std::size_t sectors, std::size_t contours) {
    static thread_local std::vector<double> room;
    const std::size_t each = 2 * sectors + kRingPadding; // two steps an edge
    const std::size_t all = contours * each * (2 * kSpokeNumbers + kArcNumbers);
    if (room.size() < all) room.resize(all);
    std::array<Crossings, kContoursMax> crossings;
    double* next = room.data();
    for (std::size_t k = 0; k < contours; ++k) {
        for (double*& values : crossings[k].spokes.of) values = std::exchange(next, next + each);
        for (double*& values : crossings[k].arcs.of) values = std::exchange(next, next + each);
        for (double*& values : crossings[k].steps.of) values = std::exchange(next, next + each);
    }
    return crossings;
}

} // namespace scanloom::mapping::simd
