#include "server/http/handlers/handlers.hpp"

#include "core/mapping/snapshot.hpp"
#include "server/http/handlers/lookup.hpp"
#include "server/http/handlers/parameters.hpp"
#include "server/http/handlers/session_json.hpp"
#include "server/http/header_fields.hpp"
#include "server/http/problem.hpp"
#include "server/http/text.hpp"
#include "server/tiles/difference.hpp"
#include "server/tiles/map_files.hpp"
#include "server/tiles/map_image.hpp"

#include <boost/json/object.hpp>
#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace scanloom::http {

namespace asio = boost::asio;

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

std::int64_t csv_bytes(mapping::Layer) { return 4; } // "100,"

asio::awaitable<Result<WantedMapFile>> wanted_map(Context& context, BytesPerCell bytes_per_cell) {
    const auto bbox = bbox_parameter(context.query);
    if (!bbox) co_return bbox.error();
    auto found = co_await find_maps_or_replay(context);
    if (!found) co_return found.error();
    const auto layer = layer_parameter(context.query);
    if (!layer) co_return layer.error();

    const auto frame = tiles::map_frame(*found->snapshot, *layer, *bbox, bytes_per_cell(*layer));
    if (!frame) co_return frame.error();
    auto etag = fmt::format("\"{}-map-{}\"", found->tag, found->snapshot->revision);
    co_return WantedMapFile{std::move(found->snapshot), *layer, *frame, std::move(etag)};
}

Response map_answer(std::string_view content_type, Body body, std::string_view etag) {
    return ok(content_type, std::move(body)).set("ETag", etag).set("Cache-Control", kRevalidate);
}

/// Writes the requested file as bytes or text.
template <class Write>
asio::awaitable<Result<Response>> get_file(Context& context, std::string_view content_type, BytesPerCell bytes_per_cell,
                                           Write write) {
    const auto wanted = co_await wanted_map(context, bytes_per_cell);
    if (!wanted) co_return wanted.error();
    const auto& etag = wanted->etag;
    if (if_none_match_has(context.request.if_none_match, etag)) co_return not_modified(etag, kRevalidate);
    auto permit = context.services.responses.take(wanted->frame.pixels() *
                                                  static_cast<std::size_t>(bytes_per_cell(wanted->layer)));
    if (!permit) co_return permit.error();
    co_return map_answer(content_type, with_permit(std::move(*permit), write(*wanted)), etag);
}

tiles::MapImage rendered(const WantedMapFile& wanted) {
    return tiles::render_map(*wanted.snapshot, wanted.layer, wanted.frame);
}

} // namespace

asio::awaitable<Result<Response>> get_map_png(Context& context) {
    return get_file(context, "image/png", one_byte,
                    [](const WantedMapFile& wanted) { return tiles::map_png(rendered(wanted)); });
}

asio::awaitable<Result<Response>> get_map_pgm(Context& context) {
    return get_file(context, "image/x-portable-graymap", one_byte, [](const WantedMapFile& wanted) {
        return tiles::map_pgm(rendered(wanted), wanted.snapshot->config);
    });
}

asio::awaitable<Result<Response>> get_map_csv(Context& context) {
    return get_file(context, "text/csv", csv_bytes,
                    [](const WantedMapFile& wanted) { return tiles::map_csv(rendered(wanted)); });
}

asio::awaitable<Result<Response>> get_map_npy(Context& context) {
    return get_file(context, "application/octet-stream", tiles::npy_bytes_per_cell, [](const WantedMapFile& wanted) {
        return tiles::map_npy(*wanted.snapshot, wanted.layer, wanted.frame);
    });
}

namespace {

/// Describes the image that is requested with the same parameters.
asio::awaitable<Result<Response>> get_description(Context& context, std::string_view content_type,
                                                  std::string (*describe)(const tiles::MapFrame&)) {
    const auto wanted = co_await wanted_map(context, one_byte);
    if (!wanted) co_return wanted.error();
    const auto& etag = wanted->etag;
    if (if_none_match_has(context.request.if_none_match, etag)) co_return not_modified(etag, kRevalidate);
    co_return map_answer(content_type, Body(describe(wanted->frame)), etag);
}

} // namespace

asio::awaitable<Result<Response>> get_map_yaml(Context& context) {
    return get_description(context, "application/yaml", tiles::map_yaml);
}

asio::awaitable<Result<Response>> get_map_pgw(Context& context) {
    return get_description(context, "text/plain; charset=utf-8", tiles::world_file);
}

asio::awaitable<Result<Response>> get_digest(Context& context) {
    if (auto corrected = co_await wait_for_corrections(context); !corrected) co_return corrected.error();
    const auto found = co_await find_maps_or_replay(context);
    if (!found) co_return found.error();
    const auto layer = layer_parameter(context.query);
    if (!layer) co_return layer.error();

    const auto& snapshot = found->snapshot;
    boost::json::object layers;
    for (const mapping::Layer each : mapping::kLayers) {
        const bool is_asked = !context.query.find("layer") || each == *layer;
        if (is_asked) layers[mapping::name_of(each)] = mapping::digest_of(*snapshot, each);
    }
    const boost::json::object json{{"revision", snapshot->revision}, {"layers", std::move(layers)}};
    co_return ok(json);
}

namespace {

/// A parsed request for a comparison.
struct WantedDifference {
    TwoMaps maps;
    mapping::Layer layer;
    tiles::MapFrame frame;

    [[nodiscard]] tiles::ComparedMaps compared() const { return {*maps.a.snapshot, *maps.b.snapshot, layer}; }
};

Result<WantedDifference> wanted_difference(const Context& context) {
    const auto bbox = bbox_parameter(context.query);
    if (!bbox) return bbox.error();
    auto maps = find_two_maps(context);
    if (!maps) return maps.error();
    const auto layer = layer_parameter(context.query);
    if (!layer) return layer.error();
    const auto frame = tiles::difference_frame({*maps->a.snapshot, *maps->b.snapshot, *layer}, *bbox);
    if (!frame) return frame.error();
    return WantedDifference{std::move(*maps), *layer, *frame};
}

boost::json::object shown(const Maps& maps, std::optional<std::string_view> weave) {
    boost::json::object json{
        {"weave", nullptr}, {"revision", maps.snapshot->revision}, {"cell_size", maps.snapshot->config.cell_size}};
    if (weave) json["weave"] = *weave;
    return json;
}

/// Returns part / whole, or null if the whole is 0.
boost::json::value part_of(double part, std::uint64_t whole) {
    if (whole == 0) return nullptr;
    return part / static_cast<double>(whole);
}

} // namespace

Result<Response> get_difference(Context& context) {
    const auto wanted = wanted_difference(context);
    if (!wanted) return wanted.error();
    const auto& frame = wanted->frame;
    const auto sums = tiles::compare(wanted->compared(), frame);
    boost::json::object cells;
    boost::json::object areas;
    for (std::size_t n = 0; n < sums.cells.size(); ++n) {
        cells[tiles::kDifferenceNames[n]] = sums.cells[n];
        areas[tiles::kDifferenceNames[n]] =
            rounded_metres(static_cast<double>(sums.cells[n]) * frame.cell_size * frame.cell_size);
    }
    boost::json::object json{{"layer", mapping::name_of(wanted->layer)},
                             {"a", shown(wanted->maps.a, context.query.find("weave"))},
                             {"b", shown(wanted->maps.b, context.query.find("with"))},
                             {"cell_size", frame.cell_size},
                             {"width", frame.width()},
                             {"height", frame.height()},
                             {"bounds", to_json(tiles::extent_of(frame.cells, frame.cell_size))},
                             {"cells", std::move(cells)},
                             {"areas", std::move(areas)},
                             {"agreement", part_of(static_cast<double>(sums.agreeing), sums.known)},
                             {"mean_difference", nullptr}};
    if (mapping::is_probability(wanted->layer)) json["mean_difference"] = part_of(sums.difference, sums.known);
    return ok(json);
}

Result<Response> get_difference_png(Context& context) {
    const auto wanted = wanted_difference(context);
    if (!wanted) return wanted.error();
    const auto& [a, b] = wanted->maps;
    const auto etag =
        fmt::format("\"{}-{}-{}-{}-difference\"", a.tag, a.snapshot->revision, b.tag, b.snapshot->revision);
    if (if_none_match_has(context.request.if_none_match, etag)) return not_modified(etag, kRevalidate);
    auto permit = context.services.responses.take(wanted->frame.pixels());
    if (!permit) return permit.error();
    const auto extent = tiles::extent_of(wanted->frame.cells, wanted->frame.cell_size);
    auto image = tiles::difference_png(wanted->compared(), wanted->frame);
    return ok("image/png", with_permit(std::move(*permit), std::move(image)))
        .set("ETag", etag)
        .set("Cache-Control", kRevalidate)
        .set("Scanloom-Bounds", fmt::format("{},{},{},{}", rounded_metres(extent.min_x), rounded_metres(extent.min_y),
                                            rounded_metres(extent.max_x), rounded_metres(extent.max_y)));
}

} // namespace scanloom::http
