#include "sim/bucket_grid.hpp"

namespace scanloom::robot {

BucketFrame BucketFrame::over(const Box& extent, std::size_t items) {
    constexpr double kMargin = 1e-3; // metres: no shape lies on the frame's own border
    constexpr double kBucketsEachWayMax = 4096.0;
    const Box box = widened(extent, kMargin);
    const double width = box.x_max - box.x_min;
    const double height = box.y_max - box.y_min;
    BucketFrame frame{box.x_min, box.y_min, std::sqrt(width * height / (2.0 * static_cast<double>(items))), 0, 0};
    frame.side = std::max(frame.side, std::max(width, height) / kBucketsEachWayMax);
    frame.columns = static_cast<int>(std::ceil(width / frame.side));
    frame.rows = static_cast<int>(std::ceil(height / frame.side));
    return frame;
}

} // namespace scanloom::robot
