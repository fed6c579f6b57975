#include "common/scan/limits.hpp"
#include "common/wire/compression.hpp"
#include "common/wire/frame_decoder.hpp"
#include "common/wire/messages.hpp"
#include "tests/fuzz/check.hpp"

namespace scanloom::wire {
namespace {

/// Checks the properties of every message that decode() accepts.
void check_scan_batch(const ScanBatch& batch) {
    fuzz::check(!batch.scans.empty() && batch.scans.size() <= kScansPerBatchMax, "a batch has 1 to 1024 scans");
    for (const Scan& scan : batch.scans) {
        fuzz::check(!scan.pose || is_finite(*scan.pose), "poses are finite");
        fuzz::check(!scan.ranges.empty() && scan.ranges.size() <= kBeamsMax, "a scan has 1 to 4096 beams");
        fuzz::check(scan.intensities.empty() || scan.intensities.size() == scan.ranges.size(), "intensities fit");
        fuzz::check(!scan.angles || beam_count(*scan.angles) == scan.ranges.size(), "angles fit");
    }
}

void check_points(const std::vector<Point2>& points) {
    for (const Point2& point : points) fuzz::check(is_finite(point), "points are finite");
}

void check_path(const Path& path) {
    fuzz::check(!path.points.empty() && path.points.size() <= kReplyPointsMax, "a path has 1 to 65,000 points");
    check_points(path.points);
}

void check_requests_and_replies(const Message& message) {
    if (const auto* plan = std::get_if<PlanRequest>(&message)) check_points({plan->goal});
    if (const auto* coverage = std::get_if<CoverageRequest>(&message)) check_points(coverage->region);
    if (const auto* plan = std::get_if<PlanReply>(&message); plan != nullptr && plan->result) check_path(*plan->result);
    if (const auto* goal = std::get_if<GoalReply>(&message); goal != nullptr && goal->result) {
        fuzz::check(goal->result->path.has_value() == (goal->result->exploration == Exploration::kGoal),
                    "a goal has a path");
        if (goal->result->path) check_path(*goal->result->path);
    }
    if (const auto* coverage = std::get_if<CoverageReply>(&message); coverage != nullptr && coverage->result) {
        check_path(coverage->result->path);
    }
}

} // namespace
} // namespace scanloom::wire

/// Input: one frame body.
SCANLOOM_FUZZER(messages)(const std::uint8_t* data, std::size_t size) {
    using namespace scanloom;
    const std::string_view body(reinterpret_cast<const char*>(data), size);
    const auto message = wire::decode(body);
    if (!message) {
        fuzz::check(!message.error().message.empty(), "every error has a message");
        return 0;
    }
    if (const auto* batch = std::get_if<wire::ScanBatch>(&*message)) wire::check_scan_batch(*batch);
    if (const auto* compressed = std::get_if<wire::CompressedScanBatch>(&*message)) {
        if (const auto inner = wire::decompress(*compressed)) wire::check_scan_batch(*inner);
    }
    wire::check_requests_and_replies(*message);

    // Compared as bytes, not as values: the server rejects a NaN in hello.create, and NaN differs from itself.
    std::string once;
    wire::encode(*message, once);
    const auto again = wire::decode(std::string_view(once).substr(wire::kLengthPrefixBytes));
    fuzz::check(again.has_value(), "an encoded message can be decoded");
    std::string twice;
    wire::encode(*again, twice);
    fuzz::check(once == twice, "encoding and decoding change nothing");
    return 0;
}
