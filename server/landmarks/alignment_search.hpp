#pragma once

#include "common/error/error.hpp"
#include "server/landmarks/alignment_surfels.hpp"

#include <functional>
#include <span>
#include <vector>

namespace scanloom::landmarks {

inline constexpr std::size_t kSurfelsMax = 250;

/// Returns at most count_max surface elements, chosen evenly among the cloud's rows.
[[nodiscard]] std::vector<Surfel> sample(std::span<const Surfel> surfels, std::size_t count_max);

/// Searches the poses in which two surfaces may match, the likeliest first.
///
/// For each of evenly spaced rotations, every pair of surface elements of similar direction votes for the translation
/// that moves one onto the other. Maxima of the votes are hypotheses. So the search needs no initial guess, and also
/// finds the other poses that may be correct. Hypotheses are distinct and not refined: a good one is within about 0.2 m
/// and 3 degrees of the pose it represents.
/// @param distance_max  metres from the first frame's origin to the second's, along each axis
/// @param count_max     at most this many hypotheses are returned
/// @param first_max     at most this many surface elements of the first surface are used, evenly chosen; of the second
///     kSurfelsMax
/// @param ask           called before each rotation; an error that it returns ends the search
/// Errors: those of `ask`.
/// Cost: the number of rotations times the number of pairs of elements used.
/// Source: Ballard, Generalizing the Hough transform to detect arbitrary shapes (1981); Olson, Real-time correlative
///     scan matching (2009), for the exhaustive search.
[[nodiscard]] Result<std::vector<Pose2>> find_hypotheses(
    std::span<const Surfel> first, std::span<const Surfel> second, double distance_max, std::size_t count_max,
    std::size_t first_max = kSurfelsMax, const std::function<Result<>()>& ask = [] { return Result<>(); });

/// Searches the translations for one rotation, as find_hypotheses() does. If things repeat, it finds most of the places
/// that may be confused.
/// @param yaw           radians, rotation of the second surface
/// @param distance_max  metres from the first frame's origin to the second's, along each axis
[[nodiscard]] std::vector<Pose2> find_translations(std::span<const Surfel> first, std::span<const Surfel> second,
                                                   double yaw, double distance_max, std::size_t count_max,
                                                   std::size_t first_max = kSurfelsMax);

} // namespace scanloom::landmarks
