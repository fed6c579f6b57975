#include "robot_client/foxglove/map_download.hpp"

#include "common/ros_map/description.hpp"
#include "common/ros_map/pgm.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <span>
#include <utility>

namespace scanloom::robot {

namespace asio = boost::asio;

namespace {

constexpr unsigned kNotModified = 304;
constexpr unsigned kUnauthorizedStatus = 401;
constexpr unsigned kForbidden = 403;
constexpr unsigned kNotFoundStatus = 404;

char cell_of(MapCell cell) {
    switch (cell) {
    case MapCell::kFree: return 0;
    case MapCell::kOccupied: return 100;
    case MapCell::kUnknown: break;
    }
    return -1;
}

} // namespace

Result<RosGrid> grid_of(const std::string& yaml, const std::string& pgm) {
    const auto description = parse_ros_yaml(yaml);
    if (!description) return description.error();
    const auto cells =
        read_ros_pgm(*description, std::span(reinterpret_cast<const std::uint8_t*>(pgm.data()), pgm.size()));
    if (!cells) return cells.error();
    RosGrid grid;
    grid.resolution = description->resolution;
    grid.T_map_grid = {description->origin_x, description->origin_y, 0.0};
    grid.width = cells->width;
    grid.cells.reserve(cells->cells.size());
    for (const MapCell cell : cells->cells) grid.cells.push_back(cell_of(cell));
    return grid;
}

MapDownload::MapDownload(asio::any_io_executor executor, net::HttpPlace place, const std::string& session)
    : http_(std::move(executor), place), server_(place.server.text()),
      prefix_(fmt::format("/api/v1/sessions/{}/", session)) {}

asio::awaitable<Result<net::HttpAnswer>> MapDownload::get(std::string_view file, bool if_changed) {
    std::string target = prefix_ + std::string(file);
    std::string known = if_changed ? etag_ : std::string();
    auto answer = co_await http_.ask(boost::beast::http::verb::get, std::move(target), std::move(known));
    if (!answer) co_return answer;
    const auto status = answer->status;
    if (status == net::kOk || status == kNotModified || status == kNotFoundStatus) co_return answer;
    const bool is_refused = status == kUnauthorizedStatus || status == kForbidden;
    co_return Error{is_refused ? Errc::kUnauthorized : Errc::kMalformed,
                    fmt::format("{}{} of {} is answered with {}{}", prefix_, file, server_, status,
                                is_refused ? "; name the file with the token of a viewer: --http-token-file" : "")};
}

asio::awaitable<Result<std::optional<RosGrid>>> MapDownload::next() {
    const auto before = co_await get("map.yaml", true);
    if (!before) co_return before.error();
    if (before->status != net::kOk) co_return std::optional<RosGrid>();
    const auto image = co_await get("map.pgm", false);
    if (!image) co_return image.error();
    if (image->status != net::kOk) co_return std::optional<RosGrid>();
    if (image->etag != before->etag) { // the map has changed; if its corner has not, the image fits
        const auto after = co_await get("map.yaml", false);
        if (!after) co_return after.error();
        if (after->body != before->body) co_return std::optional<RosGrid>();
    }
    auto grid = grid_of(before->body, image->body);
    if (!grid) co_return grid.error();
    etag_ = image->etag;
    co_return std::optional(std::move(*grid));
}

} // namespace scanloom::robot
