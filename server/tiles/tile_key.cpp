#include "server/tiles/tile_key.hpp"

#include "common/text/parse_number.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace scanloom::tiles {
namespace {

/// Accepts "0", "12", "-3", but not "", "-", "-0", "+1", "01", "1.0" or " 1".
bool is_whole_number(std::string_view text) noexcept {
    const bool negative = text.starts_with('-');
    const auto digits = text.substr(negative ? 1 : 0);
    const bool all_digits = std::all_of(digits.begin(), digits.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (digits.empty() || !all_digits) return false;
    return digits.front() != '0' || text == "0";
}

Result<> check_written(std::string_view name, std::string_view text) {
    if (is_whole_number(text)) return {};
    return Error{Errc::kInvalidField,
                 fmt::format("tile {} is not a whole number in plain digits; tiles are addressed as "
                             "z/x/y, for example 9/256/255",
                             name)};
}

/// Precondition: is_whole_number(text).
Result<std::uint32_t> parse_up_to(std::uint32_t last, std::string_view name, std::string_view text) {
    const auto value = parse_number<std::uint32_t>(text); // rejects a sign too
    if (value && *value <= last) return *value;
    return Error{Errc::kNotFound, fmt::format("there is no such tile: {} must be from 0 to {}", name, last)};
}

} // namespace

Result<TileKey> parse_tile_key(std::string_view zoom, std::string_view x, std::string_view y) {
    // Text that is not a number is a bad request even if another coordinate is out of range.
    for (const auto& [name, text] : {std::pair{"z", zoom}, {"x", x}, {"y", y}}) {
        if (const auto written = check_written(name, text); !written) return written.error();
    }
    const auto z = parse_up_to(kZoomNative, "z", zoom);
    if (!z) return z.error();
    const std::uint32_t last = (std::uint32_t{1} << *z) - 1;
    const auto column = parse_up_to(last, "x", x);
    if (!column) return column.error();
    const auto row = parse_up_to(last, "y", y);
    if (!row) return row.error();
    return TileKey{*z, *column, *row};
}

} // namespace scanloom::tiles
