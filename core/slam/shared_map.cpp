#include "core/slam/shared_map.hpp"

#include <algorithm>
#include <memory>
#include <utility>

namespace scanloom::slam {

void SharedMap::begin_with(std::vector<KnownView> views, bool is_imported) {
    is_frame_given_ = true;
    is_imported_ = is_imported;
    fragments_.set_map_complete(is_imported_ || is_frozen_);
    for (KnownView& view : views) add_given(kNoRobot, std::move(view.points), view.T_map_laser);
}

void SharedMap::add_given(std::size_t robot, ScanPoints scan, const Transform2& T_map_keyframe) {
    const std::size_t fragment =
        graph_.add_given(robot, std::make_shared<const ScanPoints>(std::move(scan)), T_map_keyframe);
    loops_.add_submaps(graph_, fragment);
    if (robot == kNoRobot) return;
    is_imported_ = false; // it grows
    fragments_.set_map_complete(is_frozen_);
}

void SharedMap::freeze(bool is_frozen) {
    if (is_frozen) finish();
    graph_.freeze(is_frozen);
    is_frozen_ = is_frozen;
    if (is_frame_given_) fragments_.set_map_complete(is_imported_ || is_frozen_);
    if (is_frozen || is_frame_given_ || graph_.size() == 0) return;
    if (std::ranges::none_of(graph_.fragments(), &Fragment::is_located)) graph_.move(0, Transform2(), true);
}

std::size_t SharedMap::continue_from(std::size_t robot, ScanPoints scan, std::size_t from,
                                     const Transform2& T_from_keyframe) {
    const std::size_t fragment = graph_.begin_fragment(robot, std::make_shared<const ScanPoints>(std::move(scan)),
                                                       graph_.pose(from) * T_from_keyframe, true);
    graph_.add_loop({from, graph_.size() - 1, T_from_keyframe, information_of(kFitSigma, kFitTurnSigma), true});
    search(fragment);
    return fragment;
}

std::size_t SharedMap::begin_fragment(std::size_t robot, ScanPoints scan, const Transform2& T_map_keyframe,
                                      const std::optional<Surroundings>& place, bool is_tracked) {
    const bool is_first = graph_.size() == 0 && !is_frame_given_ && !is_frozen_;
    const std::size_t fragment =
        graph_.begin_fragment(robot, std::make_shared<const ScanPoints>(std::move(scan)), T_map_keyframe, is_first);
    if (place) fragments_.expect(fragment, *place, graph_.size() - 1, is_tracked);
    search(fragment);
    return fragment;
}

void SharedMap::add_keyframe(std::size_t fragment, ScanPoints scan, const Transform2& T_newest_keyframe) {
    graph_.add(fragment, std::make_shared<const ScanPoints>(std::move(scan)), T_newest_keyframe);
    search(fragment);
}

void SharedMap::search(std::size_t fragment) {
    loops_.search(graph_, fragment);
    if (graph_.fragments()[fragment].is_located) return;
    if (!fragments_.search(graph_, fragment)) return;
    ++optimizations_;
    graph_.optimize_after_jump();
}

void SharedMap::finish() {
    constexpr int kIterations = 5;
    ++optimizations_;
    graph_.optimize(kIterations);
}

} // namespace scanloom::slam
