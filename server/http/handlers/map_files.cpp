#include "server/http/handlers/map_files.hpp"

#include "server/http/conditional.hpp"
#include "server/http/handlers/bbox.hpp"
#include "server/http/handlers/session_lookup.hpp"
#include "server/http/problem.hpp"
#include "server/tiles/map_files.hpp"
#include "server/tiles/map_image.hpp"

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace scanloom::http {
namespace {

/// A parsed request for a map.
struct WantedMapFile {
    std::shared_ptr<const mapping::Snapshot> snapshot;
    mapping::Layer layer;
    tiles::MapFrame frame;
    std::string etag;
};

/// Returns the maximum bytes of a file for each cell of a layer, before compression.
using BytesPerCell = std::int64_t (*)(mapping::Layer);

std::int64_t one_byte(mapping::Layer) { return 1; }

Result<WantedMapFile> wanted_map(const MapsLookup& maps, const Call& call, BytesPerCell bytes_per_cell) {
    const auto bbox = bbox_parameter(call.query);
    if (!bbox) return bbox.error();
    auto found = maps.find_or_weave(call, {"layer", "bbox"});
    if (!found) return found.error();
    const auto layer = layer_parameter(call.query);
    if (!layer) return layer.error();

    const auto frame = tiles::map_frame(*found->snapshot, *layer, *bbox, bytes_per_cell(*layer));
    if (!frame) return frame.error();
    auto etag = fmt::format("\"{}-map-{}\"", found->tag, found->snapshot->revision);
    return WantedMapFile{std::move(found->snapshot), *layer, *frame, std::move(etag)};
}

Response map_answer(std::string_view content_type, Body body, std::string_view etag) {
    return ok(content_type, std::move(body)).set("ETag", etag).set("Cache-Control", kRevalidate);
}

/// Writes the requested file as bytes or text.
template <class Write>
Result<Response> get_file(const MapsLookup& maps, const AnswerSlots& slots, const Call& call,
                          std::string_view content_type, BytesPerCell bytes_per_cell, Write&& write) {
    const auto wanted = wanted_map(maps, call, bytes_per_cell);
    if (!wanted) return wanted.error();
    if (if_none_match_has(call.request.if_none_match, wanted->etag)) return not_modified(wanted->etag, kRevalidate);
    using Bytes = decltype(write(*wanted));
    struct File {
        std::shared_ptr<const void> slot;
        Bytes bytes;
    };
    auto slot = slots.take(wanted->frame.pixels() * static_cast<std::size_t>(bytes_per_cell(wanted->layer)));
    if (!slot) return slot.error();
    auto file = std::make_shared<File>(File{std::move(*slot), {}});
    file->bytes = write(*wanted);
    return map_answer(content_type, Body(std::shared_ptr<const Bytes>(file, &file->bytes)), wanted->etag);
}

tiles::MapImage rendered(const WantedMapFile& wanted) {
    return tiles::render_map(*wanted.snapshot, wanted.layer, wanted.frame);
}

} // namespace

Result<Response> get_map_png(const MapsLookup& maps, const AnswerSlots& slots, const Call& call) {
    return get_file(maps, slots, call, "image/png", one_byte,
                    [](const WantedMapFile& wanted) { return tiles::map_png(rendered(wanted)); });
}

Result<Response> get_map_pgm(const MapsLookup& maps, const AnswerSlots& slots, const Call& call) {
    return get_file(maps, slots, call, "image/x-portable-graymap", one_byte, [](const WantedMapFile& wanted) {
        return tiles::map_pgm(rendered(wanted), wanted.snapshot->config);
    });
}

Result<Response> get_map_csv(const MapsLookup& maps, const AnswerSlots& slots, const Call& call) {
    const auto text_per_cell = [](mapping::Layer) -> std::int64_t { return 4; }; // "100,"
    return get_file(maps, slots, call, "text/csv", text_per_cell,
                    [](const WantedMapFile& wanted) { return tiles::map_csv(rendered(wanted)); });
}

Result<Response> get_map_npy(const MapsLookup& maps, const AnswerSlots& slots, const Call& call) {
    return get_file(
        maps, slots, call, "application/octet-stream", tiles::npy_bytes_per_cell,
        [](const WantedMapFile& wanted) { return tiles::map_npy(*wanted.snapshot, wanted.layer, wanted.frame); });
}

Result<Response> get_map_yaml(const MapsLookup& maps, const Call& call) {
    const auto wanted = wanted_map(maps, call, one_byte);
    if (!wanted) return wanted.error();
    if (if_none_match_has(call.request.if_none_match, wanted->etag)) return not_modified(wanted->etag, kRevalidate);
    return map_answer("application/yaml", Body(tiles::map_yaml(wanted->frame)), wanted->etag);
}

} // namespace scanloom::http
