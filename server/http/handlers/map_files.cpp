#include "server/http/handlers/map_files.hpp"

#include "server/http/conditional.hpp"
#include "server/http/handlers/session_lookup.hpp"
#include "server/http/in_quotes.hpp"
#include "server/http/number.hpp"
#include "server/http/problem.hpp"
#include "server/tiles/map_image.hpp"
#include "server/tiles/ros_map.hpp"

#include <fmt/format.h>

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>

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

/// What a request for a map comes to before anything is drawn.
struct Wanted {
    std::shared_ptr<const mapping::Snapshot> snapshot;
    tiles::MapFrame frame;
    std::string etag;
};

Result<Wanted> wanted_map(const session::SessionRegistry& sessions, const Call& call) {
    if (auto known = call.query.check_only({"layer", "bbox"}); !known) return known.error();
    const auto bbox = bbox_parameter(call.query);
    if (!bbox) return bbox.error();
    const auto session = find_session(sessions, call);
    if (!session) return session.error();
    if (auto known = check_layer_parameter(call.query); !known) return known.error();

    auto snapshot = (*session)->snapshot();
    const auto frame = tiles::map_frame(*snapshot, *bbox);
    if (!frame) return frame.error();
    auto etag = fmt::format("\"{}-map-{}\"", session_tag((*session)->info()), snapshot->revision);
    return Wanted{std::move(snapshot), *frame, std::move(etag)};
}

Response map_answer(std::string_view content_type, Body body, std::string_view etag) {
    return ok(content_type, std::move(body)).set("ETag", etag).set("Cache-Control", kRevalidate);
}

using Write = tiles::Bytes (*)(const tiles::MapImage&);

Result<Response> get_image(const session::SessionRegistry& sessions, const AnswerSlots& slots, const Call& call,
                           std::string_view content_type, Write write) {
    const auto wanted = wanted_map(sessions, call);
    if (!wanted) return wanted.error();
    if (if_none_match_has(call.request.if_none_match, wanted->etag)) return not_modified(wanted->etag, kRevalidate);
    struct Image {
        std::shared_ptr<const void> slot;
        tiles::Bytes bytes;
    };
    const auto pixels = static_cast<std::size_t>(wanted->frame.cells.width() * wanted->frame.cells.height());
    auto slot = slots.take(pixels); // a byte each, before compression
    if (!slot) return slot.error();
    auto image = std::make_shared<Image>(Image{std::move(*slot), {}});
    image->bytes = write(tiles::render_map(*wanted->snapshot, wanted->frame));
    return map_answer(content_type, Body(std::shared_ptr<const tiles::Bytes>(image, &image->bytes)), wanted->etag);
}

} // namespace

Result<Response> get_map_png(const session::SessionRegistry& sessions, const AnswerSlots& slots, const Call& call) {
    return get_image(sessions, slots, call, "image/png", tiles::map_png);
}

Result<Response> get_map_pgm(const session::SessionRegistry& sessions, const AnswerSlots& slots, const Call& call) {
    return get_image(sessions, slots, call, "image/x-portable-graymap", tiles::map_pgm);
}

Result<Response> get_map_yaml(const session::SessionRegistry& sessions, const Call& call) {
    const auto wanted = wanted_map(sessions, call);
    if (!wanted) return wanted.error();
    if (if_none_match_has(call.request.if_none_match, wanted->etag)) return not_modified(wanted->etag, kRevalidate);
    return map_answer("application/yaml", Body(tiles::map_yaml(wanted->frame)), wanted->etag);
}

} // namespace scanloom::http
