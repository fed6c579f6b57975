#pragma once

#include "common/error/error.hpp"
#include "core/mapping/snapshot.hpp"
#include "server/http/target.hpp"
#include "server/http/text.hpp"
#include "server/tiles/map_image.hpp"

#include <fmt/format.h>

#include <concepts>
#include <optional>
#include <string_view>
#include <utility>

/// Parses the parameters of requests.
namespace scanloom::http {

/// Returns a function that parses an integer from `min` to `max`.
template <std::integral T>
[[nodiscard]] auto integer_from(T min, T max) {
    return [min, max](std::string_view text) {
        const auto value = parse_integer<T>(text);
        return value && *value >= min && *value <= max ? value : std::nullopt;
    };
}

/// Returns the value of a parameter, or `absent` if it is not given.
/// @param parse   takes the text and returns an optional value: nullopt for an invalid text
/// @param needed  ends the message about an invalid text: "a revision is needed"
/// Errors: kInvalidField, naming the parameter, if its text is invalid.
template <class T, class Parse>
[[nodiscard]] Result<T> parameter(const Query& query, std::string_view name, T absent, const Parse& parse,
                                  std::string_view needed) {
    const auto text = query.find(name);
    if (!text) return absent;
    if (auto value = parse(*text)) return T(*std::move(value));
    return Error{Errc::kInvalidField, fmt::format("{} is {}; {}", name, in_quotes(*text), needed)};
}

/// Errors: kNotFound if there is no such layer.
[[nodiscard]] Result<mapping::Layer> find_layer(std::string_view name);

/// Returns the layer parameter, or occupancy if it is not given.
/// Errors: kNotFound if there is no such layer.
[[nodiscard]] Result<mapping::Layer> layer_parameter(const Query& query);

/// Returns the since parameter, or 0 if it is not given.
/// Errors: kInvalidField if it is not a revision.
[[nodiscard]] Result<Revision> since_parameter(const Query& query);

/// Returns the revision from which to report changes: usually `since`. Returns 0 if the session has not reached
/// `since`, because then the client knows only a deleted session of this name; and if `since` is before the newest
/// change of exclusions, which may have changed the maps anywhere.
[[nodiscard]] Revision since_in(const mapping::Snapshot& snapshot, Revision since) noexcept;

/// Returns the revision from which to report what hangs on poses of scans: as since_in(), but 0 if poses of earlier
/// scans were corrected after `since`.
[[nodiscard]] Revision since_in_poses(const mapping::Snapshot& snapshot, Revision since) noexcept;

/// Returns the bbox parameter, `min_x,min_y,max_x,max_y` in metres, or nullopt if it is not given.
/// Errors: kInvalidField if it is not four numbers.
[[nodiscard]] Result<std::optional<tiles::Extent>> bbox_parameter(const Query& query);

/// Returns the index of the robot that a parameter or member `robot` names.
/// Errors: kNotFound if no robot of that name ever joined the session.
[[nodiscard]] Result<RobotIndex> robot_named(const mapping::Snapshot& maps, std::string_view name);

} // namespace scanloom::http
