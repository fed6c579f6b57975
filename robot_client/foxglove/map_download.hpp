#pragma once

#include "common/net/http_connection.hpp"
#include "robot_client/ros/outgoing_messages.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>

#include <optional>
#include <string>
#include <string_view>

namespace scanloom::robot {

/// The files of a map as an occupancy grid.
/// @param yaml  map.yaml
/// @param pgm   map.pgm
/// Errors: those of parse_ros_yaml() and read_ros_pgm(); kTooLarge if the image has more pixels than a map file may.
[[nodiscard]] Result<RosGrid> grid_of(const std::string& yaml, const std::string& pgm);

/// Downloads the map of a session over HTTP.
/// Threads: those of the executor; one request at a time.
class MapDownload {
public:
    /// @param session  its name
    MapDownload(boost::asio::any_io_executor executor, net::HttpPlace place, const std::string& session);

    /// Downloads the map if it has changed.
    /// @return the map; nullopt if it has not changed, changed during the download, or the session has no map yet
    /// Errors: kUnreachable, kTimeout; kUnauthorized if the token does not permit it; kMalformed if the answer is no
    ///         map.
    [[nodiscard]] boost::asio::awaitable<Result<std::optional<RosGrid>>> next();

private:
    [[nodiscard]] boost::asio::awaitable<Result<net::HttpAnswer>> get(std::string_view file, bool if_changed);

    net::HttpConnection http_;
    std::string server_;
    std::string prefix_; // of targets
    std::string etag_;   // of the newest map
};

} // namespace scanloom::robot
