#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace scanloom {

/// What the poses of a robot's scans are, and therefore how they are used.
enum class Poses : std::uint8_t {
    kMap,      ///< poses in the map frame; they are trusted
    kOdometry, ///< odometry, which drifts
    kNone,     ///< the robot does not know its poses
};

/// How well the server knows where a robot is.
enum class LocalizationState : std::uint8_t {
    kGiven,     ///< the robot sends poses in the map frame; in a wire::Correction: not stated
    kTracking,  ///< its scans fit the map
    kLost,      ///< its newest scans fit no place, or where it is since then is not known
    kUnlocated, ///< its place in the map is not known: no laser scan yet, or the map is of others and shows too little
                ///< of what it sees
};

/// Returns the word for a state in the HTTP API.
/// @param state  how well the server knows where a robot is
/// @return "given", "tracking", "lost" or "unlocated"
[[nodiscard]] constexpr std::string_view name_of(LocalizationState state) noexcept {
    switch (state) {
    case LocalizationState::kGiven: return "given";
    case LocalizationState::kTracking: return "tracking";
    case LocalizationState::kLost: return "lost";
    case LocalizationState::kUnlocated: return "unlocated";
    }
    return "given";
}

/// Returns the word for poses in options and fingerprints.
/// @param poses  what a robot's poses are
/// @return "map", "odometry" or "none"
[[nodiscard]] constexpr std::string_view name_of(Poses poses) noexcept {
    switch (poses) {
    case Poses::kMap: return "map";
    case Poses::kOdometry: return "odometry";
    case Poses::kNone: return "none";
    }
    return "map";
}

/// Returns the poses that a word of name_of() stands for.
/// @param word  any text
/// @return nullopt if it is no such word
[[nodiscard]] constexpr std::optional<Poses> find_poses(std::string_view word) {
    for (const Poses poses : {Poses::kMap, Poses::kOdometry, Poses::kNone}) {
        if (word == name_of(poses)) return poses;
    }
    return std::nullopt;
}

} // namespace scanloom
