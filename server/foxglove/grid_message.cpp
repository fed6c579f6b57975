#include "server/foxglove/grid_message.hpp"

#include "server/foxglove/robot_messages.hpp"
#include "server/foxglove/ros_fields.hpp"
#include "server/tiles/map_files.hpp"

#include <span>

namespace scanloom::foxglove {

std::string grid_message(const mapping::Snapshot& snapshot, mapping::Layer layer, const tiles::MapFrame& frame,
                         double stamp) {
    CdrWriter message;
    add_header(stamp, kMapFrame, message);
    add_time(stamp, message); // map_load_time
    message.add(static_cast<float>(frame.cell_size));
    message.add_count(frame.pixels_wide());
    message.add_count(static_cast<std::size_t>(frame.height()));
    const Point2 origin = frame.origin();
    add_pose({origin.x, origin.y, 0.0}, message);
    const auto cells = tiles::occupancy_grid(tiles::render_map(snapshot, layer, frame), snapshot.config);
    message.add_bytes(std::span(cells));
    return message.take();
}

} // namespace scanloom::foxglove
