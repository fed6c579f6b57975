#pragma once

#include "common/error/error.hpp"
#include "server/http/context.hpp"
#include "server/http/response.hpp"

#include <boost/asio/awaitable.hpp>

/// The handlers of the routes, by the file that has them. Each is called after the checks of its row in routes.cpp.
/// openapi.yaml describes their parameters, responses and statuses.
namespace scanloom::http {

// system.cpp

[[nodiscard]] Result<Response> get_livez(Context& context);        ///< waits for nothing
[[nodiscard]] Result<Response> get_readyz(Context& context);       ///< waits for nothing
[[nodiscard]] Result<Response> get_metrics(Context& context);      ///< the counters of all parts
[[nodiscard]] Result<Response> get_openapi(Context& context);      ///< openapi()
[[nodiscard]] Result<Response> get_viewer(Context& context);       ///< only the page reads its query
[[nodiscard]] Result<Response> get_viewer_asset(Context& context); ///< a file that the page names
[[nodiscard]] Result<Response> list_nodes(Context& context);       ///< as a second ago; empty for one server
[[nodiscard]] Result<Response> drain_node(Context& context);       ///< responds before the server stops
[[nodiscard]] Result<Response> list_backups(Context& context);     ///< oldest first
[[nodiscard]] Result<Response> make_backup(Context& context);      ///< responds when the backup is complete

// login.cpp

[[nodiscard]] Result<Response> get_login(Context& context);    ///< the token of the request, if it is known
[[nodiscard]] Result<Response> post_login(Context& context);   ///< sets a cookie that scripts cannot read
[[nodiscard]] Result<Response> delete_login(Context& context); ///< also if the browser is not signed in

// sessions.cpp

[[nodiscard]] Result<Response> list_sessions(Context& context);    ///< damaged ones included; loads none
[[nodiscard]] Result<Response> create_session(Context& context);   ///< waits until it is durable
[[nodiscard]] Result<Response> get_session(Context& context);      ///< does not load it
[[nodiscard]] Result<Response> estimate_session(Context& context); ///< begins to estimate its poses
[[nodiscard]] Result<Response> delete_session(Context& context);   ///< also a damaged session
[[nodiscard]] Result<Response> import_map(Context& context);       ///< creates the session

// exclusions.cpp

[[nodiscard]] Result<Response> exclude_scans(Context& context);   ///< evicts the session: its maps are made again
[[nodiscard]] Result<Response> list_exclusions(Context& context); ///< those in effect, by ascending id
[[nodiscard]] Result<Response> lift_exclusion(Context& context);  ///< evicts the session, as exclude_scans()

// tiles.cpp

[[nodiscard]] boost::asio::awaitable<Result<Response>> get_tile_png(Context& context); ///< coloured by style_of()
[[nodiscard]] boost::asio::awaitable<Result<Response>> get_tile_bin(Context& context); ///< 65,536 codes
[[nodiscard]] Result<Response> get_tilejson(Context& context);                         ///< TileJSON 3.0.0
[[nodiscard]] Result<Response> get_changes(Context& context);                          ///< tiles of every zoom

// maps.cpp: whole maps; a large one takes a permit of Services::responses until its last byte is sent

[[nodiscard]] boost::asio::awaitable<Result<Response>> get_map_png(Context& context);  ///< an image
[[nodiscard]] boost::asio::awaitable<Result<Response>> get_map_pgm(Context& context);  ///< for ROS
[[nodiscard]] boost::asio::awaitable<Result<Response>> get_map_csv(Context& context);  ///< a table
[[nodiscard]] boost::asio::awaitable<Result<Response>> get_map_npy(Context& context);  ///< a NumPy array
[[nodiscard]] boost::asio::awaitable<Result<Response>> get_map_yaml(Context& context); ///< describes map.pgm
[[nodiscard]] boost::asio::awaitable<Result<Response>> get_map_pgw(Context& context);  ///< describes map.png
[[nodiscard]] boost::asio::awaitable<Result<Response>> get_digest(Context& context);   ///< of each layer
[[nodiscard]] Result<Response> get_difference(Context& context);                       ///< see tiles/difference.hpp
[[nodiscard]] Result<Response> get_difference_png(Context& context);                   ///< the same as an image

// weaves.cpp: replay jobs

[[nodiscard]] boost::asio::awaitable<Result<Response>>
start_weave(Context& context);                                 ///< 200 if the maps exist, else 202
[[nodiscard]] Result<Response> list_weaves(Context& context);  ///< most recently used first
[[nodiscard]] Result<Response> get_weave(Context& context);    ///< its progress
[[nodiscard]] Result<Response> delete_weave(Context& context); ///< cancels it first

// planning.cpp

[[nodiscard]] Result<Response> post_plan(Context& context);     ///< the cheapest path
[[nodiscard]] Result<Response> post_coverage(Context& context); ///< stopped by guidance::SearchLimit
[[nodiscard]] Result<Response> get_frontiers(Context& context); ///< with the cheapest path to each

// goals.cpp

[[nodiscard]] Result<Response> get_goal(Context& context);    ///< assigns nothing
[[nodiscard]] Result<Response> assign_goal(Context& context); ///< see guidance::GoalAssignments
[[nodiscard]] Result<Response> get_goals(Context& context);   ///< see guidance::RobotPaths

// landmarks.cpp: reads the log, for seconds if it is long

[[nodiscard]] Result<Response> get_landmarks(Context& context);  ///< see sessions::LandmarkLayers
[[nodiscard]] Result<Response> get_points_csv(Context& context); ///< see landmarks::fuse_captures()
[[nodiscard]] Result<Response> get_points_ply(Context& context); ///< see landmarks::fuse_captures()
[[nodiscard]] Result<Response> get_points_pcd(Context& context);

// trajectory.cpp

[[nodiscard]] Result<Response> get_trajectory(Context& context); ///< reads points from the log that memory lacks

// poses.cpp: poses that the server estimates

[[nodiscard]] boost::asio::awaitable<Result<Response>> get_trajectory_tum(Context& context); ///< of sent poses, too
[[nodiscard]] boost::asio::awaitable<Result<Response>> get_trajectory_kitti(Context& context);
[[nodiscard]] boost::asio::awaitable<Result<Response>> get_pose_graph(Context& context);     ///< keyframes and edges
[[nodiscard]] boost::asio::awaitable<Result<Response>> get_pose_graph_g2o(Context& context); ///< of those that count
[[nodiscard]] boost::asio::awaitable<Result<Response>> relocalize(Context& context);         ///< by an operator
[[nodiscard]] boost::asio::awaitable<Result<Response>> change_mode(Context& context);        ///< localize-only mode

// log.cpp

[[nodiscard]] Result<Response> get_log(Context& context); ///< reads the log while it is sent

// live.cpp

[[nodiscard]] Result<Response> get_live(Context& context); ///< opens a WebSocket, not to pages of other hosts
[[nodiscard]] Result<Response>
get_foxglove(Context& context); ///< likewise, and to pages of ServerConfig::viewer_origins

} // namespace scanloom::http
