#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace scanloom::access {

/// What a token is for.
enum class Role {
    kRobot,    ///< robot links: sends scans, creates its sessions; over HTTP: has goals assigned
    kViewer,   ///< reads over HTTP; has ways planned, which changes nothing
    kOperator, ///< everything: as robots and viewers do, and creates, imports and deletes
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

[[nodiscard]] constexpr std::optional<Role> role_of(std::string_view name) noexcept {
    for (const Role role : kRoles) {
        if (name_of(role) == name) return role;
    }
    return std::nullopt;
}

/// On robot links.
[[nodiscard]] constexpr bool may_drive(Role role) noexcept { return role != Role::kViewer; }

/// Over HTTP, without changing anything.
[[nodiscard]] constexpr bool may_look(Role role) noexcept { return role != Role::kRobot; }

/// Over HTTP: to assign goals to robots.
[[nodiscard]] constexpr bool may_guide(Role role) noexcept { return role != Role::kViewer; }

/// Over HTTP.
[[nodiscard]] constexpr bool may_change(Role role) noexcept { return role == Role::kOperator; }

} // namespace scanloom::access
