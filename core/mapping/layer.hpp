#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace scanloom::mapping {

/// A layer of a session's maps.
enum class Layer : std::uint8_t {
    kOccupancy,      ///< probability of occupation, from lasers
    kHimm,           ///< counters 0..15, from lasers
    kSonar,          ///< probability of occupation, from sonars
    kClassification, ///< free, occupied, unexplored, frontier, danger
};

/// All layers, in the order of their numbers.
inline constexpr std::array kLayers = {Layer::kOccupancy, Layer::kHimm, Layer::kSonar, Layer::kClassification};

/// Returns whether the values of a layer are probabilities of occupation.
/// @param layer  any layer
[[nodiscard]] constexpr bool is_probability(Layer layer) noexcept {
    return layer == Layer::kOccupancy || layer == Layer::kSonar;
}

/// Returns the layer's name in URLs, e.g. "occupancy".
/// @param layer  any layer
[[nodiscard]] constexpr std::string_view name_of(Layer layer) noexcept {
    constexpr auto kNames = std::to_array<std::string_view>({"occupancy", "himm", "sonar", "classification"});
    static_assert(kNames.size() == kLayers.size());
    return kNames[static_cast<std::size_t>(layer)];
}

/// Returns the layer with a name in URLs, or nullopt if there is none.
/// @param name  e.g. "himm"
[[nodiscard]] constexpr std::optional<Layer> layer_of(std::string_view name) noexcept {
    for (const Layer layer : kLayers) {
        if (name_of(layer) == name) return layer;
    }
    return std::nullopt;
}

} // namespace scanloom::mapping
