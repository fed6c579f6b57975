#include "server/foxglove/grid_message.hpp"

#include "common/ros/ros_writer.hpp"
#include "server/foxglove/log_time.hpp"
#include "server/foxglove/robot_messages.hpp"
#include "server/tiles/map_files.hpp"

#include <span>

namespace scanloom::foxglove {

std::string grid_message(const mapping::Snapshot& maps, const tiles::MapFrame& frame, double stamp) {
    RosWriter message(RosEncoding::kCdr);
    message.add_header(nanoseconds_of(stamp), kMapFrame);
    message.add_time(nanoseconds_of(stamp)); // map_load_time
    message.add(static_cast<float>(frame.cell_size));
    message.add_count(frame.pixels_wide());
    message.add_count(static_cast<std::size_t>(frame.height()));
    const Point2 origin = frame.origin();
    message.add_pose({origin.x, origin.y, 0.0});
    const auto cells = tiles::occupancy_grid(tiles::render_map(maps, mapping::Layer::kOccupancy, frame), maps.config);
    message.add_bytes(std::span(cells));
    return message.take();
}

} // namespace scanloom::foxglove
