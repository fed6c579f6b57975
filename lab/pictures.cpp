#include "lab/pictures.hpp"

#include "lab/cloud_pictures.hpp"
#include "lab/map_cells.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>

namespace scanloom::lab {
namespace {

// blue, green, red
const cv::Scalar kPathColour(200, 100, 0);
const cv::Scalar kPointColour(40, 30, 220);
const cv::Scalar kWalkerColour(0, 140, 255);
const cv::Scalar kGapColour(255, 255, 255);
constexpr int kGap = 8;        // pixels between two moments
constexpr int kShift = 4;      // OpenCV draws with a resolution of 1/16 pixel
constexpr double kSnap = 1e-6; // cells: a pixel's edge this close to a cell's edge counts as equal

/// Converts metres to pixels of one moment's picture.
struct Canvas {
    tiles::Extent part;
    int width;
    int height;

    [[nodiscard]] cv::Point at(const Point2& point) const {
        // OpenCV's origin is the centre of the first pixel
        const auto drawn = [](double metres) {
            return static_cast<int>(std::lround((metres * kPixelsPerMetre - 0.5) * (1 << kShift)));
        };
        return {drawn(point.x - part.min_x), drawn(part.max_y - point.y)};
    }

    [[nodiscard]] int length(double metres) const {
        return static_cast<int>(std::lround(metres * kPixelsPerMetre * (1 << kShift)));
    }
};

/// Returns the range of cells that each pixel of a row covers, starting at `begin_m`.
std::vector<std::pair<std::int32_t, std::int32_t>> cells_of_pixels(int pixels, double begin_m, double cell_size_m) {
    std::vector<std::pair<std::int32_t, std::int32_t>> covered;
    for (int pixel = 0; pixel < pixels; ++pixel) {
        const auto at = [&](int n) { return (begin_m + n / kPixelsPerMetre) / cell_size_m; };
        const auto begin = static_cast<std::int32_t>(std::floor(at(pixel) + kSnap));
        const auto end = static_cast<std::int32_t>(std::ceil(at(pixel + 1) - kSnap));
        covered.emplace_back(begin, std::max(end, begin + 1));
    }
    return covered;
}

/// Of cells in one pixel, selects the one most likely occupied, otherwise the one most likely free.
mapping::LogOdds more_telling(mapping::LogOdds a, mapping::LogOdds b) {
    if (a > 0 || b > 0) return std::max(a, b); // unknown is less than all other values
    if (a == mapping::kUnknownLogOdds || b == mapping::kUnknownLogOdds) return std::max(a, b);
    return std::min(a, b);
}

std::uint8_t grey_of(mapping::LogOdds cell) {
    if (cell == mapping::kUnknownLogOdds) return 128;
    return static_cast<std::uint8_t>(std::lround(255.0 * (1.0 - mapping::probability_of(cell))));
}

cv::Mat draw_map(const mapping::Snapshot& snapshot, const Canvas& canvas) {
    const double cell_size = snapshot.config.cell_size;
    const auto columns = cells_of_pixels(canvas.width, canvas.part.min_x, cell_size);
    const auto rows = cells_of_pixels(canvas.height, canvas.part.min_y, cell_size); // bottom row first
    const auto occupancy =
        occupancy_of(snapshot, {columns.front().first, rows.front().first, columns.back().second, rows.back().second});
    cv::Mat picture(canvas.height, canvas.width, CV_8UC3);
    for (int y = 0; y < canvas.height; ++y) {
        for (int x = 0; x < canvas.width; ++x) {
            const auto [i_begin, i_end] = columns[static_cast<std::size_t>(x)];
            const auto [j_begin, j_end] = rows[static_cast<std::size_t>(canvas.height - 1 - y)];
            auto most = mapping::kUnknownLogOdds;
            for_each_cell({i_begin, j_begin, i_end, j_end},
                          [&](grid::Cell cell) { most = more_telling(most, occupancy.at(cell)); });
            const auto grey = grey_of(most);
            picture.at<cv::Vec3b>(y, x) = {grey, grey, grey};
        }
    }
    return picture;
}

void draw_run(cv::Mat& picture, const Canvas& canvas, const Recording& recording, std::size_t scans) {
    for (std::size_t n = 1; n < scans; ++n) {
        const Pose2& from = *recording.scans[n - 1].pose;
        const Pose2& to = *recording.scans[n].pose;
        cv::line(picture, canvas.at({from.x, from.y}), canvas.at({to.x, to.y}), kPathColour, 1, cv::LINE_8, kShift);
    }
    const Scan& newest = recording.scans[scans - 1];
    const Pose2& pose = *newest.pose;
    for (std::size_t beam = 0; beam < newest.ranges.size(); ++beam) {
        const RangeMm range = newest.ranges[beam];
        if (range == kInvalidRange || range == kNoReturn) continue;
        const double angle = beam_angle(recording.laser.angles, beam);
        const Point2 point = transform(pose, range * 1e-3 * Point2{std::cos(angle), std::sin(angle)});
        cv::circle(picture, canvas.at(point), canvas.length(0.02), kPointColour, cv::FILLED, cv::LINE_8, kShift);
    }
    const Point2 robot{pose.x, pose.y};
    cv::circle(picture, canvas.at(robot), canvas.length(sim::kBodyRadius), kPathColour, cv::FILLED, cv::LINE_8, kShift);
    cv::line(picture, canvas.at(robot), canvas.at(transform(pose, {2.0 * sim::kBodyRadius, 0.0})), kPathColour, 2,
             cv::LINE_8, kShift);
    for (const sim::Disc& walker : recording.walkers[scans - 1]) {
        cv::circle(picture, canvas.at(walker.centre), canvas.length(walker.radius), kWalkerColour, 2, cv::LINE_8,
                   kShift);
    }
}

} // namespace

tiles::Bytes strip_png(std::span<const Moment> moments, const Recording& recording, const tiles::Extent& part) {
    const Canvas canvas{part, static_cast<int>(std::lround((part.max_x - part.min_x) * kPixelsPerMetre)),
                        static_cast<int>(std::lround((part.max_y - part.min_y) * kPixelsPerMetre))};
    const int count = static_cast<int>(moments.size());
    cv::Mat strip(canvas.height, count * canvas.width + (count - 1) * kGap, CV_8UC3, kGapColour);
    for (int n = 0; n < count; ++n) {
        const Moment& moment = moments[static_cast<std::size_t>(n)];
        cv::Mat picture = draw_map(moment.snapshot, canvas);
        draw_run(picture, canvas, recording, moment.scans);
        picture.copyTo(strip(cv::Rect(n * (canvas.width + kGap), 0, canvas.width, canvas.height)));
    }
    return png_of(strip);
}

} // namespace scanloom::lab
