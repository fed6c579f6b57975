#pragma once

#include "core/mapping/snapshot.hpp"

#include <string>
#include <vector>

namespace scanloom::foxglove {

/// Returns the state of each robot in words and numbers: Message::kStatus. A robot that is lost is an error, one that
/// is not located or not connected is a warning.
/// @param connected  by RobotIndex
/// @param stamp      seconds
[[nodiscard]] std::string status_message(const mapping::Snapshot& maps, const std::vector<bool>& connected,
                                         double stamp);

} // namespace scanloom::foxglove
