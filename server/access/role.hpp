#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace scanloom::access {

/// The set of actions that a token permits.
enum class Role {
    kRobot,    ///< on robot links: sends scans, creates its sessions; over HTTP: requests goals
    kViewer,   ///< over HTTP: reads, and plans paths, which changes nothing
    kOperator, ///< everything that robots and viewers may do; also creates, imports and deletes
};

inline constexpr std::array kRoles = {Role::kRobot, Role::kViewer, Role::kOperator};

[[nodiscard]] constexpr std::string_view name_of(Role role) noexcept {
    switch (role) {
    case Role::kRobot: return "robot";
    case Role::kViewer: return "viewer";
    case Role::kOperator: return "operator";
    }
    return "unknown";
}

/// Returns the role of that name, or nullopt if there is none.
[[nodiscard]] constexpr std::optional<Role> role_of(std::string_view name) noexcept {
    for (const Role role : kRoles) {
        if (name_of(role) == name) return role;
    }
    return std::nullopt;
}

/// Returns whether the role permits robot links.
[[nodiscard]] constexpr bool may_drive(Role role) noexcept { return role != Role::kViewer; }

/// Returns whether the role permits HTTP requests that change nothing.
[[nodiscard]] constexpr bool may_look(Role role) noexcept { return role != Role::kRobot; }

/// Returns whether the role permits assigning goals to robots over HTTP.
[[nodiscard]] constexpr bool may_guide(Role role) noexcept { return role != Role::kViewer; }

/// Returns whether the role permits HTTP requests that change something.
[[nodiscard]] constexpr bool may_change(Role role) noexcept { return role == Role::kOperator; }

} // namespace scanloom::access
