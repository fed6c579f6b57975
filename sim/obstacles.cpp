#include "sim/obstacles.hpp"

#include "sim/ray_casting.hpp"

#include <algorithm>
#include <limits>

namespace scanloom::sim {

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

namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

/// One axis of a ray's traversal of the buckets.
class Walk {
public:
    Walk(double origin, double direction, double border, double side, int count)
        : origin_(origin - border), inverse_(1.0 / direction), side_(side), count_(count),
          step_(direction > 0.0   ? 1
                : direction < 0.0 ? -1
                                  : 0) {}

    /// Narrows the interval of metres along the ray to the part between the frame's borders.
    void cut(double& begin, double& end) const {
        const double width = count_ * side_;
        if (step_ == 0) {
            if (origin_ < 0.0 || origin_ > width) end = -1.0;
            return;
        }
        const double first = length_to(step_ > 0 ? 0.0 : width);
        const double last = length_to(step_ > 0 ? width : 0.0);
        begin = std::max(begin, first);
        end = std::min(end, last);
    }

    /// Pre: the ray is inside the frame after `length` metres.
    void start(double length, double direction) {
        at_ = std::clamp(static_cast<int>((origin_ + length * direction) / side_), 0, count_ - 1);
        find_next();
    }

    [[nodiscard]] int at() const { return at_; }
    /// Returns the distance in metres along the ray to the next bucket.
    [[nodiscard]] double next() const { return next_; }
    /// @return whether there is a next bucket
    bool step() {
        at_ += step_;
        find_next();
        return at_ >= 0 && at_ < count_;
    }

private:
    [[nodiscard]] double length_to(double coordinate) const { return (coordinate - origin_) * inverse_; }
    void find_next() { next_ = step_ == 0 ? kFar : length_to((step_ > 0 ? at_ + 1 : at_) * side_); }

    double origin_;  ///< metres from the frame's border
    double inverse_; ///< metres along the ray per metre along this axis
    double side_;    ///< metres
    int count_;      ///< columns or rows
    int step_;       ///< -1, 0 or 1
    int at_ = 0;
    double next_ = kFar;
};

} // namespace

double Obstacles::cast_ray(const Point2& origin, double yaw_rad, double range_max) const {
    const BucketFrame& frame = outlines_.frame();
    if (frame.columns == 0) return kFar;
    const Ray ray(origin, yaw_rad);
    Walk across(ray.origin_x, ray.direction_x, frame.x_min, frame.side, frame.columns);
    Walk up(ray.origin_y, ray.direction_y, frame.y_min, frame.side, frame.rows);
    double entry = 0.0;
    double exit = range_max;
    across.cut(entry, exit);
    up.cut(entry, exit);
    if (entry > exit) return kFar;
    across.start(entry, ray.direction_x);
    up.start(entry, ray.direction_y);
    double nearest = kFar;
    for (;;) {
        for (const Segment& segment : outlines_.in(across.at(), up.at())) {
            nearest = sim::cast_ray(segment, ray, nearest);
        }
        const double next = std::min(across.next(), up.next());
        if (nearest <= next || next > range_max) return nearest;
        if (!(across.next() <= up.next() ? across : up).step()) return nearest;
    }
}

double Obstacles::distance(const Point2& point) const {
    double nearest = kFar;
    outlines_.visit_outwards(
        point, [&] { return nearest; },
        [&](const Segment& segment) { nearest = std::min(nearest, sim::distance(segment, point)); });
    return nearest;
}

bool Obstacles::contain(const Point2& point) const {
    const BucketFrame& frame = solids_.frame();
    const int column = frame.column_of(point.x);
    const int row = frame.row_of(point.y);
    if (column < 0 || column >= frame.columns || row < 0 || row >= frame.rows) return false;
    return std::ranges::any_of(solids_.in(column, row), [&](const Box& box) { return box.contains(point); });
}

} // namespace scanloom::sim
