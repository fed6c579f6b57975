#include "server/http/handlers/map_files.hpp"

#include "server/http/conditional.hpp"
#include "server/http/handlers/session_lookup.hpp"
#include "server/http/in_quotes.hpp"
#include "server/http/number.hpp"
#include "server/tiles/map_image.hpp"
#include "server/tiles/ros_map.hpp"

#include <fmt/format.h>

#include <array>
#include <memory>
#include <optional>

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

Result<std::optional<tiles::Extent>> bbox_parameter(const Query& query) {
    const auto text = query.find("bbox");
    if (!text) return std::optional<tiles::Extent>();
    const auto extent = parse_extent(*text);
    if (extent) return extent;
    return Error{Errc::kInvalidField,
                 fmt::format("bbox is {}; min_x,min_y,max_x,max_y in metres is needed", in_quotes(*text))};
}

Body png_of(const mapping::Snapshot& snapshot, const tiles::MapFrame& frame) {
    return Body(std::make_shared<const tiles::Bytes>(tiles::map_png(tiles::render_map(snapshot, frame))));
}

Body pgm_of(const mapping::Snapshot& snapshot, const tiles::MapFrame& frame) {
    return Body(std::make_shared<const tiles::Bytes>(tiles::map_pgm(tiles::render_map(snapshot, frame))));
}

Body yaml_of(const mapping::Snapshot&, const tiles::MapFrame& frame) { return Body(tiles::map_yaml(frame)); }

using Write = Body (*)(const mapping::Snapshot&, const tiles::MapFrame&);

Result<Response> get_map(const session::SessionRegistry& sessions, const Call& call, std::string_view content_type,
                         Write write) {
    if (auto known = call.query.check_only({"layer", "bbox"}); !known) return known.error();
    const auto bbox = bbox_parameter(call.query);
    if (!bbox) return bbox.error();
    const auto session = find_session(sessions, call);
    if (!session) return session.error();
    if (auto known = check_layer_parameter(call.query); !known) return known.error();

    const auto snapshot = (*session)->snapshot();
    const auto frame = tiles::map_frame(*snapshot, *bbox);
    if (!frame) return frame.error();
    const auto etag = fmt::format("\"{}-map-{}\"", session_tag((*session)->info()), snapshot->revision);
    if (if_none_match_has(call.request.if_none_match, etag)) return not_modified(etag, kRevalidate);
    return ok(content_type, write(*snapshot, *frame)).set("ETag", etag).set("Cache-Control", kRevalidate);
}

} // namespace

Result<Response> get_map_png(const session::SessionRegistry& sessions, const Call& call) {
    return get_map(sessions, call, "image/png", png_of);
}

Result<Response> get_map_pgm(const session::SessionRegistry& sessions, const Call& call) {
    return get_map(sessions, call, "image/x-portable-graymap", pgm_of);
}

Result<Response> get_map_yaml(const session::SessionRegistry& sessions, const Call& call) {
    return get_map(sessions, call, "application/yaml", yaml_of);
}

} // namespace scanloom::http
