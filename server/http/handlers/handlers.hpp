#pragma once

#include "common/error/error.hpp"
#include "server/http/context.hpp"
#include "server/http/response.hpp"

#include <boost/asio/awaitable.hpp>

/// The handlers of the routes, by the file that has them.
namespace scanloom::http {

// system.cpp

/// GET /livez: responds if the process runs.
[[nodiscard]] Result<Response> get_livez(Context& context);

/// GET /readyz: returns 200 with the address for robots and the sessions that are damaged or accept no scans, or 503
/// with the reasons: sessions not recovered yet, draining, a failed store. Does not wait. Sessions are named only to a
/// client whose token is for them.
[[nodiscard]] Result<Response> get_readyz(Context& context);

/// GET /metrics: returns the counters and the current state of the process, the store and the sessions.
[[nodiscard]] Result<Response> get_metrics(Context& context);

/// GET /openapi.json: returns openapi().
[[nodiscard]] Result<Response> get_openapi(Context& context);

/// GET /: returns the viewer's page. Only the viewer reads the query.
[[nodiscard]] Result<Response> get_viewer(Context& context);

/// GET /assets/{file}
[[nodiscard]] Result<Response> get_viewer_asset(Context& context);

/// GET /api/v1/backups: lists the backups, oldest first.
/// Errors: kNotFound if the server keeps none; those of Backups::list().
[[nodiscard]] Result<Response> list_backups(Context& context);

/// POST /api/v1/backups: makes a backup. The response follows when it is complete, after the new data has been copied.
/// Errors: those of list_backups() and Backups::make().
[[nodiscard]] Result<Response> make_backup(Context& context);

// login.cpp

/// GET /api/v1/login: returns whether this server requires tokens, and the properties of the request's token if it is
/// known.
[[nodiscard]] Result<Response> get_login(Context& context);

/// POST /api/v1/login {"token": "..."}: signs a browser in with a cookie that scripts cannot read. Responds as GET
/// /login, or 401 if the token is not valid.
/// Errors: kMalformed or kInvalidField for the body.
[[nodiscard]] Result<Response> post_login(Context& context);

/// DELETE /api/v1/login: signs the browser out. Responds 204, also if it was not signed in.
[[nodiscard]] Result<Response> delete_login(Context& context);

// sessions.cpp

/// GET /api/v1/sessions: lists at most `limit` (1..1000, default 100) sessions that the token is for, by ascending
/// name, starting after the name `after`. Sessions with a damaged log are included and marked. For sessions that are
/// served despite damage, "damage" contains the finding of the background check.
[[nodiscard]] Result<Response> list_sessions(Context& context);

/// POST /api/v1/sessions
[[nodiscard]] Result<Response> create_session(Context& context);

/// GET /api/v1/sessions/{session}
[[nodiscard]] Result<Response> get_session(Context& context);

/// DELETE /api/v1/sessions/{session}
[[nodiscard]] Result<Response> delete_session(Context& context);

/// POST .../import: creates the session from a ROS map. The form has the fields `yaml` and `image` (PGM or PNG), and
/// any settings of a session. The cell size is that of the map unless cell_size is given. Responds as POST /sessions.
[[nodiscard]] Result<Response> import_map(Context& context);

// exclusions.cpp

/// POST .../exclude: excludes scans of a robot from the maps. The maps are computed again at the next request for them.
[[nodiscard]] Result<Response> exclude_scans(Context& context);

/// GET .../exclusions: lists the exclusions in effect, by ascending id.
[[nodiscard]] Result<Response> list_exclusions(Context& context);

/// DELETE .../exclusions/{exclusion}: lifts an exclusion. The maps are computed again at the next request for them.
[[nodiscard]] Result<Response> lift_exclusion(Context& context);

// tiles.cpp

/// GET .../tiles/{layer}/{z}/{x}/{y}.png, in the colours of style_of(layer), and .bin: 65,536 codes, row 0 on top.
///
/// The parameters are `v`, a revision, and `id`, that of the session. A response that cannot change for these
/// parameters may be cached without limit. Without them the client must revalidate it with its entity tag.
[[nodiscard]] boost::asio::awaitable<Result<Response>> get_tile_png(Context& context);
[[nodiscard]] boost::asio::awaitable<Result<Response>> get_tile_bin(Context& context);

/// GET .../tiles/{layer}.json: returns TileJSON 3.0.0. Its bounds and center are longitudes and latitudes, so metres
/// are in additional members: cell_size, extent (covered by the tiles), bounds_m (the observed area), frame_id.
[[nodiscard]] Result<Response> get_tilejson(Context& context);

/// GET .../changes?layer&since: lists every tile of every zoom that changed after revision `since`. If `since` is
/// greater than the current revision, the session was recreated, and every tile is listed.
[[nodiscard]] Result<Response> get_changes(Context& context);

// maps.cpp

/// GET .../map.png, .../map.pgm, .../map.yaml, .../map.csv, .../map.npy: returns the whole map of a layer, or with
/// `bbox=min_x,min_y,max_x,max_y` (metres) the cells that overlap this rectangle. ROS loads the PGM and the YAML.
///
/// A large file takes a permit until its last byte is sent. If none is free, the response is 503.
[[nodiscard]] boost::asio::awaitable<Result<Response>> get_map_png(Context& context);
[[nodiscard]] boost::asio::awaitable<Result<Response>> get_map_pgm(Context& context);
[[nodiscard]] boost::asio::awaitable<Result<Response>> get_map_csv(Context& context);
[[nodiscard]] boost::asio::awaitable<Result<Response>> get_map_npy(Context& context);
[[nodiscard]] boost::asio::awaitable<Result<Response>> get_map_yaml(Context& context);

/// GET .../digest?layer: returns a hash of the canonical cells of each layer. Equal digests mean equal maps.
[[nodiscard]] boost::asio::awaitable<Result<Response>> get_digest(Context& context);

/// GET .../difference, .../difference.png `?weave=A&with=B&layer&bbox`: returns the differences between two maps of a
/// session, as numbers or as an image. Each map is that of a replay job, or the session's own map if it is not named.
/// See tiles/difference.hpp.
///
/// The image has `Scanloom-Bounds: min_x,min_y,max_x,max_y`, its bounds in the map frame in metres. It takes a permit,
/// as map.png does.
[[nodiscard]] Result<Response> get_difference(Context& context);
[[nodiscard]] Result<Response> get_difference_png(Context& context);

// weaves.cpp

/// POST .../weave: starts a replay job: maps of the same log with other settings, or up to `until`. Responds 202 while
/// the job runs, 200 if its maps exist already. Every URL of maps accepts `weave={id}` to return them.
[[nodiscard]] Result<Response> start_weave(Context& context);

/// GET .../weave: lists all replay jobs of the session, most recently used first.
[[nodiscard]] Result<Response> list_weaves(Context& context);

/// GET .../weave/{weave}: returns the progress of a replay job.
[[nodiscard]] Result<Response> get_weave(Context& context);

/// DELETE .../weave/{weave}: cancels and deletes a replay job.
[[nodiscard]] Result<Response> delete_weave(Context& context);

// planning.cpp

/// POST .../plan {from, to, allow_unknown?, body_radius?, danger_cost?}: returns the cheapest path as a LineString, or
/// 409 with the reason if there is none. `from` may be {"robot": name}.
[[nodiscard]] Result<Response> post_plan(Context& context);

/// POST .../coverage {start?, spacing?, region?, body_radius?}: returns a path over all free ground as a LineString,
/// and the ground that no such path covers as areas. `start` may be {"robot": name}. Without `start`, the path begins
/// at the only robot.
[[nodiscard]] Result<Response> post_coverage(Context& context);

/// GET .../frontiers.geojson?robot&size_min&body_radius: returns a feature for each frontier, largest first: its cells
/// as areas, and the goal for exploring it with the cheapest path from the named robot, or from any robot.
[[nodiscard]] Result<Response> get_frontiers(Context& context);

// goals.cpp

/// GET .../goal?robot=: returns the robot's current goal and the path to it. The outcome is "none" if it has no goal
/// and "complete" if nothing was left that it could explore. Assigns nothing.
/// Errors: kInvalidField or kNotFound for the robot.
[[nodiscard]] Result<Response> get_goal(Context& context);

/// POST .../goal {robot, size_min?, body_radius?}: assigns to the robot the next frontier to explore. No other robot is
/// assigned the same frontier from then on; see GoalAssignments.
[[nodiscard]] Result<Response> assign_goal(Context& context);

/// GET .../goals.geojson: returns for each robot its last planned path and its assigned goal, if any. The revision is
/// that of the RobotPaths, as LiveEvent::goals_revision. Assigns nothing.
[[nodiscard]] Result<Response> get_goals(Context& context);

// landmarks.cpp

/// GET .../landmarks.geojson?since&bbox&seen_min: returns the session's landmarks as points by id, in metres of the map
/// frame: all of them, or those observed after `since`, with a position in `bbox`, in at least `seen_min` captures. The
/// collection states how consistent successive observations are: persistence, stability and continuity, each a mean,
/// null without data. "revision" is the `since` for the next request. "reset" means that the session has not reached
/// `since` because it was recreated; then all landmarks are returned. Waits until the log has been read, which takes
/// seconds for a long log at the first request.
/// Errors: those of Context::session and LandmarkLayers::up_to(); kInvalidField for a parameter.
[[nodiscard]] Result<Response> get_landmarks(Context& context);

/// GET .../points.csv and .../points.ply?since&until&robot&threshold: returns what robots observed from many positions
/// as one point cloud (landmarks::fuse_captures). It contains the captures that ended after log entry `since`, up to
/// `until`, of all robots or of one. Unfinished captures count as ended now. Therefore consecutive parts contain each
/// capture once. Points of different captures are fused if they are at most `threshold` metres apart (default 0.05).
/// Reads the log from its beginning, which takes seconds for a long log.
/// Errors: those of Context::session and read_captures(); kInvalidField for a parameter; kNotFound for the robot;
///         kTooLarge if the captures have more than a million points (the message names a part that has fewer), or if
///         it takes more than 5 s.
[[nodiscard]] Result<Response> get_points_csv(Context& context);
[[nodiscard]] Result<Response> get_points_ply(Context& context);

// trajectory.cpp

/// GET .../trajectory.geojson?since&times: returns the trajectory of each robot as a feature, in metres of the map
/// frame (RFC 7946 knows only degrees; the foreign members state the difference). With times=true the properties also
/// have the revision, the stamp (seconds, the robot's clock) and the yaw (radians) of each position. `revision` is the
/// end of the trajectories: that of the maps, unless they exceed sessions::kPathPointsMax. A long trajectory takes a
/// permit, as a large map image does. Points that are not in memory any more are read from the log.
[[nodiscard]] Result<Response> get_trajectory(Context& context);

// log.cpp

/// GET .../log: returns the session's whole log up to its newest entry.
///   format=protobuf (default)  each entry as a scanloom.v1.LogEntry after its length: uint32, big-endian
///   format=clf                 as a CARMEN log (exchange/carmen_text.hpp)
[[nodiscard]] Result<Response> get_log(Context& context);

// live.cpp

/// Accepts a WebSocket that watches the session: 101 with the session that a viewer will show. Responds 426 if the
/// request is not for a WebSocket of version 13, and 403 to a page of another host, because browsers let any page open
/// a WebSocket and read it. The viewer watches as long as its token permits it.
/// Errors: kInvalidField for an unknown parameter; those of Context::session.
[[nodiscard]] Result<Response> get_live(Context& context);

} // namespace scanloom::http
