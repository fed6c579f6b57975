#pragma once

#include "core/slam/fragment_search.hpp"
#include "core/slam/keyframe_graph.hpp"
#include "core/slam/loop_search.hpp"

#include <cstddef>
#include <optional>
#include <vector>

namespace scanloom::slam {

/// What a laser would see at a place of a map that is known before any robot drives.
struct KnownView {
    Transform2 T_map_laser; ///< the place
    ScanPoints points;      ///< in the laser's frame
};

/// The map that the robots of a session share: their keyframes, loops, and the search for places of those who start
/// anywhere. The frame of the map is that of the first robot's first scan, or a given one.
/// Threads: one at a time.
class SharedMap {
public:
    /// Begins with a given frame, in which all robots are to be located. Call it before any fragment is located.
    /// @param views        all over the map that is known so far, neighbours after each other
    /// @param is_imported  whether the map was imported, so that it shows all places that may look alike; other maps do
    ///     while they are frozen
    void begin_with(std::vector<KnownView> views, bool is_imported);

    /// Adds a keyframe of a robot that sends its poses, or a view of the known map. Call it if the frame is given.
    /// @param robot           whose scan it is; kNoRobot: it is a view
    /// @param scan            its points
    /// @param T_map_keyframe  its pose, which does not change
    void add_given(std::size_t robot, ScanPoints scan, const Transform2& T_map_keyframe);

    /// Returns whether the frame of the map is given: that of a known map, or of robots that send their poses.
    [[nodiscard]] bool is_frame_given() const noexcept { return is_frame_given_; }

    /// Freezes the map, or lets it change again.
    /// @param is_frozen  true: what the map contains now does not change, and robots are only located in it; false:
    ///     mapping goes on. If nothing is located then, and the frame is not given, the first fragment becomes the map
    void freeze(bool is_frozen);

    /// Begins a fragment that is located: that of a robot which was located in the frozen map and goes on mapping.
    /// @param robot               whose scan it is
    /// @param scan                its points
    /// @param from                keyframe of the map
    /// @param T_from_keyframe     the fragment's first keyframe relative to it, as matched
    /// @return the fragment's index
    std::size_t continue_from(std::size_t robot, ScanPoints scan, std::size_t from, const Transform2& T_from_keyframe);

    /// Begins a fragment; it is located if it is the first one, the frame is not given, and the map not frozen.
    /// @param robot           whose scan it is
    /// @param scan            its points
    /// @param T_map_keyframe  its pose; in a frame of its own if the fragment is not the first one
    /// @param place           where people say that it is; nullopt: it may be anywhere
    /// @param is_tracked      whether the pose is in the map's frame, and counts if people are wrong
    /// @return the fragment's index
    std::size_t begin_fragment(std::size_t robot, ScanPoints scan, const Transform2& T_map_keyframe,
                               const std::optional<Surroundings>& place = std::nullopt, bool is_tracked = false);

    /// Searches for the next keyframe of a fragment near a place.
    /// @param fragment  index of a fragment that is not located
    /// @param place     where people say that the keyframe is
    void expect(std::size_t fragment, const Surroundings& place) {
        fragments_.expect(fragment, place, graph_.size(), false);
    }

    /// Adds a keyframe to a fragment, and searches for loops, or for the place of the fragment.
    /// @param fragment           index of the fragment
    /// @param scan               its points
    /// @param T_newest_keyframe  its pose relative to the fragment's newest keyframe, as matched
    void add_keyframe(std::size_t fragment, ScanPoints scan, const Transform2& T_newest_keyframe);

    /// Goes on with the search for the place of a fragment. Call it for each of its scans.
    /// @param fragment  index of a fragment that is not located
    void continue_search(std::size_t fragment) { fragments_.continue_search(graph_, fragment); }

    /// Moves the keyframes once more so that they agree with the edges, as at the end of a log.
    void finish();

    /// Returns whether the map is frozen.
    [[nodiscard]] bool is_frozen() const noexcept { return is_frozen_; }

    /// Returns the keyframes and their edges.
    [[nodiscard]] const KeyframeGraph& graph() const noexcept { return graph_; }
    /// Returns the search for places.
    [[nodiscard]] const FragmentSearch& fragment_search() const noexcept { return fragments_; }
    /// Returns the figures of the loop search.
    [[nodiscard]] const LoopFigures& loop_figures() const noexcept { return loops_.figures(); }
    /// Returns how often the graph was optimised: poses of earlier keyframes change only then.
    [[nodiscard]] std::size_t optimization_count() const noexcept {
        return optimizations_ + loops_.optimization_count();
    }

    /// Lists the members that decide later results; see common/archive.
    template <class Self, class Archive>
    static void list(Self& self, Archive& archive) {
        archive(self.graph_, self.loops_, self.fragments_, self.optimizations_, self.is_frozen_, self.is_frame_given_,
                self.is_imported_);
    }

    /// Returns whether the members fit together, as they always do unless they were read from damaged bytes.
    [[nodiscard]] bool is_consistent() const;

private:
    void search(std::size_t fragment);

    KeyframeGraph graph_;
    LoopSearch loops_;
    FragmentSearch fragments_;
    std::size_t optimizations_ = 0; // by others than the loop search
    bool is_frozen_ = false;
    bool is_frame_given_ = false;
    bool is_imported_ = false; // and no robot has sent poses since
};

} // namespace scanloom::slam
