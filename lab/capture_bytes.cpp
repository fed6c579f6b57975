#include "lab/capture_bytes.hpp"

#include "common/wire/messages.hpp"
#include "server/landmarks/cell_index.hpp"
#include "server/landmarks/distinct_points.hpp"
#include "server/landmarks/point_tree.hpp"

#include <optional>

namespace scanloom::lab {

std::size_t robot_bytes(std::span<const Scan> scans) {
    std::size_t bytes = 0;
    std::string frame;
    for (const Scan& scan : scans) {
        frame.clear();
        wire::encode(wire::ScanBatch{{scan}}, frame);
        bytes += frame.size();
    }
    return bytes;
}

std::size_t clustering_bytes(std::span<const Point2> points, double eps) {
    using landmarks::CellIndex;
    constexpr std::size_t kNumber = sizeof(std::uint32_t);
    // the point; index of its distinct point; its cluster
    constexpr std::size_t kEach = sizeof(Point2) + 2 * kNumber;
    // the point and its count; position in the grid and cell; point and index among the core points; cluster
    constexpr std::size_t kDistinct = 2 * sizeof(Point2) + 5 * kNumber;
    // the cell; start of its core points and their tree; its set and cluster
    constexpr std::size_t kCell =
        sizeof(CellIndex::Cell) + sizeof(std::size_t) + sizeof(std::optional<landmarks::PointTree>) + 2 * kNumber;
    const auto distinct = landmarks::distinct_points(points);
    const auto cells = CellIndex::of_radius(distinct.points, eps).cells().size();
    return kEach * points.size() + kDistinct * distinct.points.size() + kCell * cells;
}

} // namespace scanloom::lab
