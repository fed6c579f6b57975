#include "server/http/handlers/difference.hpp"

#include "server/http/conditional.hpp"
#include "server/http/handlers/bbox.hpp"
#include "server/http/handlers/session_lookup.hpp"
#include "server/http/number.hpp"
#include "server/tiles/difference.hpp"

#include <boost/json/object.hpp>
#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace scanloom::http {
namespace {

/// A parsed request for a comparison.
struct WantedDifference {
    TwoMaps maps;
    mapping::Layer layer;
    tiles::MapFrame frame;

    [[nodiscard]] tiles::ComparedMaps compared() const { return {*maps.a.snapshot, *maps.b.snapshot, layer}; }
};

Result<WantedDifference> wanted_difference(const MapsLookup& lookup, const Call& call) {
    const auto bbox = bbox_parameter(call.query);
    if (!bbox) return bbox.error();
    auto maps = lookup.find_two(call, {"layer", "bbox"});
    if (!maps) return maps.error();
    const auto layer = layer_parameter(call.query);
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

boost::json::object shown(const tiles::Extent& extent) {
    return {{"min_x", rounded_metres(extent.min_x)},
            {"min_y", rounded_metres(extent.min_y)},
            {"max_x", rounded_metres(extent.max_x)},
            {"max_y", rounded_metres(extent.max_y)}};
}

/// Returns part / whole, or null if the whole is 0.
boost::json::value part_of(double part, std::uint64_t whole) {
    if (whole == 0) return nullptr;
    return part / static_cast<double>(whole);
}

bool is_probability(mapping::Layer layer) {
    return layer == mapping::Layer::kOccupancy || layer == mapping::Layer::kSonar;
}

} // namespace

Result<Response> get_difference(const MapsLookup& maps, const Call& call) {
    const auto wanted = wanted_difference(maps, call);
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
                             {"a", shown(wanted->maps.a, call.query.find("weave"))},
                             {"b", shown(wanted->maps.b, call.query.find("with"))},
                             {"cell_size", frame.cell_size},
                             {"width", frame.width()},
                             {"height", frame.height()},
                             {"bounds", shown(tiles::extent_of(frame.cells, frame.cell_size))},
                             {"cells", std::move(cells)},
                             {"areas", std::move(areas)},
                             {"agreement", part_of(static_cast<double>(sums.agreeing), sums.known)},
                             {"mean_difference", nullptr}};
    if (is_probability(wanted->layer)) json["mean_difference"] = part_of(sums.difference, sums.known);
    return ok(json);
}

Result<Response> get_difference_png(const MapsLookup& maps, const AnswerSlots& slots, const Call& call) {
    const auto wanted = wanted_difference(maps, call);
    if (!wanted) return wanted.error();
    const auto& [a, b] = wanted->maps;
    const auto etag =
        fmt::format("\"{}-{}-{}-{}-difference\"", a.tag, a.snapshot->revision, b.tag, b.snapshot->revision);
    if (if_none_match_has(call.request.if_none_match, etag)) return not_modified(etag, kRevalidate);
    struct File {
        std::shared_ptr<const void> slot;
        tiles::Bytes bytes;
    };
    auto slot = slots.take(wanted->frame.pixels());
    if (!slot) return slot.error();
    const auto file =
        std::make_shared<const File>(File{std::move(*slot), tiles::difference_png(wanted->compared(), wanted->frame)});
    const auto extent = tiles::extent_of(wanted->frame.cells, wanted->frame.cell_size);
    return ok("image/png", Body(std::shared_ptr<const tiles::Bytes>(file, &file->bytes)))
        .set("ETag", etag)
        .set("Cache-Control", kRevalidate)
        .set("Scanloom-Bounds", fmt::format("{},{},{},{}", rounded_metres(extent.min_x), rounded_metres(extent.min_y),
                                            rounded_metres(extent.max_x), rounded_metres(extent.max_y)));
}

} // namespace scanloom::http
