#include "robot_client/ros/frame_tree.hpp"
#include "tests/fuzz/check.hpp"

#include <algorithm>
#include <cstddef>
#include <set>
#include <span>
#include <string>
#include <variant>

namespace scanloom::robot {
namespace {

constexpr std::size_t kFrames = 6;
constexpr std::size_t kBytesOfTransform = 4;
constexpr RosTime kSecond = 1'000'000'000;

std::string frame(std::size_t number) { return std::string(1, static_cast<char>('a' + number % kFrames)); }

/// @param has_loops  whether frames may be above themselves; otherwise only those with lower letters are above others
FrameTree tree_of(std::span<const std::uint8_t> input, bool has_loops) {
    FrameTree tree;
    for (; input.size() >= kBytesOfTransform; input = input.subspan(kBytesOfTransform)) {
        RosTransform transform;
        const std::size_t child = input[0] / kFrames % kFrames;
        transform.header.frame = frame(has_loops ? input[0] : input[0] % kFrames % std::max<std::size_t>(child, 1));
        transform.child = frame(child);
        if (!has_loops && child == 0) continue;
        transform.header.stamp = input[1] * kSecond / 4;
        transform.T_parent_child.translation() << input[2] * 0.1, 1.0, 0.0;
        transform.T_parent_child.rotate(Eigen::AngleAxisd(input[3] * 0.05, Eigen::Vector3d::UnitZ()));
        tree.add(transform, input[0] >= 216); // a few are static
    }
    return tree;
}

void check_lookups(const FrameTree& tree, RosTime stamp) {
    for (std::size_t n = 0; n < kFrames * kFrames; ++n) {
        const auto there = tree.find(frame(n), frame(n / kFrames), stamp);
        const auto back = tree.find(frame(n / kFrames), frame(n), stamp);
        fuzz::check(there.index() == back.index(), "a transform has an inverse");
        const auto* found = std::get_if<Eigen::Isometry3d>(&there);
        if (found == nullptr) continue;
        const Eigen::Isometry3d round = *found * std::get<Eigen::Isometry3d>(back);
        fuzz::check((round.matrix() - Eigen::Matrix4d::Identity()).norm() < 1e-6, "there and back is no motion");
    }
}

} // namespace
} // namespace scanloom::robot

/// Input: whether there may be loops, then transforms of four bytes each (parent and child, stamp, translation,
/// rotation) between six frames.
SCANLOOM_FUZZER(frame_tree)(const std::uint8_t* data, std::size_t size) {
    using namespace scanloom;
    using namespace scanloom::robot;
    constexpr std::size_t kBytesMax = 4000;
    if (size == 0 || size > kBytesMax) return 0;
    const bool has_loops = data[0] % 2 != 0;
    FrameTree tree = tree_of(std::span(data + 1, size - 1), has_loops);
    for (const RosTime stamp : {RosTime{0}, 3 * kSecond, 10 * kSecond + 1, 64 * kSecond}) check_lookups(tree, stamp);
    for (std::size_t n = 0; n < kFrames; ++n) {
        const auto above = tree.ancestors(frame(n));
        fuzz::check(std::set(above.begin(), above.end()).size() == above.size(), "the list of ancestors ends");
    }
    const auto before = tree.size();
    tree.keep_ancestors({frame(0)});
    fuzz::check(tree.size() <= before, "nothing is added");
    check_lookups(tree, 3 * kSecond);
    return 0;
}
