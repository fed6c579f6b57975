#pragma once

#include "server/mapping/projection.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// The checkpoint part that holds a session's exclusions.
///
/// Format: the number of exclusions, the exclusions by rising id, then the number of excluded scans of each robot.
namespace scanloom::session {

inline constexpr std::string_view kExclusionsPart = "head/exclusions"; ///< key of the part

struct ExclusionsPart {
    Exclusions exclusions;
    std::vector<std::uint64_t> excluded; ///< scans, by RobotIndex
};

[[nodiscard]] std::string exclusions_part(const mapping::ProjectionState& state);

/// Returns nullopt if the part is damaged.
[[nodiscard]] std::optional<ExclusionsPart> read_exclusions_part(std::string_view value);

} // namespace scanloom::session
