#include "server/http/handlers/bbox.hpp"

#include "server/http/in_quotes.hpp"
#include "server/http/number.hpp"

#include <fmt/format.h>

#include <array>
#include <string_view>

namespace scanloom::http {
namespace {

std::optional<tiles::Extent> parse_extent(std::string_view text) {
    std::array<double, 4> edges{};
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const auto comma = text.find(',');
        if ((comma == std::string_view::npos) != (i + 1 == edges.size())) return std::nullopt;
        const auto edge = parse_real(text.substr(0, comma));
        if (!edge) return std::nullopt;
        edges[i] = *edge;
        text.remove_prefix(comma == std::string_view::npos ? text.size() : comma + 1);
    }
    return tiles::Extent{edges[0], edges[1], edges[2], edges[3]};
}

} // namespace

Result<std::optional<tiles::Extent>> bbox_parameter(const Query& query) {
    const auto text = query.find("bbox");
    if (!text) return std::optional<tiles::Extent>();
    const auto extent = parse_extent(*text);
    if (extent) return extent;
    return Error{Errc::kInvalidField,
                 fmt::format("bbox is {}; min_x,min_y,max_x,max_y in metres is needed", in_quotes(*text))};
}

} // namespace scanloom::http
