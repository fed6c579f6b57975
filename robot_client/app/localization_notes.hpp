#pragma once

#include "common/wire/messages.hpp"

#include <optional>
#include <string>
#include <vector>

namespace scanloom::robot {

/// Returns messages for the operator when the state of the robot, or the error of its laser's mount, changes.
/// Threads: one at a time.
class LocalizationNotes {
public:
    /// Returns a sentence for each change since the correction before.
    [[nodiscard]] std::vector<std::string> add(const wire::Correction& correction);

    /// Returns the newest state; nullopt: there was no correction.
    [[nodiscard]] const std::optional<LocalizationState>& state() const noexcept { return state_; }

private:
    std::optional<LocalizationState> state_;
    bool has_wrong_mount_ = false;
};

} // namespace scanloom::robot
