#pragma once

#include "core/scan_matching/place_search.hpp"
#include "core/slam/keyframe_graph.hpp"

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

namespace scanloom::slam {

/// Where people say that a robot is.
struct Surroundings {
    Point2 near{0.0, 0.0}; ///< metres, in the map's frame
    double radius = 0.0;   ///< metres: the robot is at most this far from it
};

/// Finds the places in the map of fragments that are not located: those of robots that start anywhere, or that were
/// lost.
///
/// The newest keyframes of the fragment are looked up in the map of all located ones, a part of the search at each
/// scan. Half of their points may be in space that the map does not show yet. One answer is not enough, because
/// buildings have rooms that look alike: four must agree, over ten metres of the trajectory, and its newest 60 m must
/// then fit the map. A fragment that is located later than possible does no harm; one at a wrong place tears the map.
/// If an operator has said where the robot is, one good answer near that place is enough.
/// Source: own; the search in the map is PlaceSearch.
/// Threads: one at a time.
class FragmentSearch {
public:
    /// Goes on with the search for a fragment that search() has begun, by a small part, so that no scan waits long.
    /// Call it for each of its scans.
    /// @param graph     as for search(), unchanged
    /// @param fragment  index of a fragment that is not located
    /// Cost: at most some milliseconds.
    void continue_search(const KeyframeGraph& graph, std::size_t fragment);

    /// Searches for the place of a fragment. Call it after each of its keyframes.
    /// @param graph     if the place is found, the fragment is moved there, is located, and has loop edges to the map; the
    ///     graph is not optimised
    /// @param fragment  index of a fragment that is not located
    /// @return whether the place is found
    /// Cost: what continue_search() has left of a part of the search, up to some tens of milliseconds; a test of the fragment when
    ///     four answers agree.
    bool search(KeyframeGraph& graph, std::size_t fragment);

    /// Sets whether the map shows all places that may look alike. Then answers that agree over two metres are enough,
    /// and the map may be older than what the robots see.
    void set_map_complete(bool is_complete) noexcept { is_map_complete_ = is_complete; }

    /// Searches for a fragment near a place only, until it has travelled 20 m without success.
    /// @param fragment    index of the fragment
    /// @param place       of one of its keyframes
    /// @param keyframe    index of that keyframe, the newest one or the next one
    /// @param is_tracked  whether the fragment begins where a located robot was tracked: if people are wrong, it is
    ///     located there, unless it does not fit
    void expect(std::size_t fragment, const Surroundings& place, std::size_t keyframe, bool is_tracked);

    /// Returns how many maps have their grids in memory, up to tens of megabytes each. When the map is made again, only
    /// those of the newest map before stay; searches in older ones make theirs again if they go on.
    [[nodiscard]] std::size_t place_map_count() const;

    /// Lists the members that decide later results; see common/archive.
    template <class Self, class Archive>
    static void list(Self& self, Archive& archive) {
        archive(self.map_, self.searched_, self.is_map_complete_);
    }

    /// Returns whether the members fit together, as they always do unless they were read from damaged bytes.
    [[nodiscard]] bool is_consistent(const KeyframeGraph& graph) const;

private:
    /// A place that was found.
    struct Answer {
        std::size_t keyframe = 0; // the newest one then
        Transform2 T_map_keyframe;

        /// Returns T_map_fragment, from the frame that the fragment has now.
        [[nodiscard]] Transform2 placement(const KeyframeGraph& graph) const {
            return T_map_keyframe * inverse(graph.pose(keyframe));
        }
    };

    /// A keyframe of the map, and where it was then.
    struct Located {
        std::size_t keyframe = 0;
        Transform2 T_map_keyframe;
    };

    /// The map of the located keyframes at a moment.
    struct LocatedMap {
        std::vector<Located> keyframes;
        std::shared_ptr<const scan_matching::PlaceMap> places; // null: not computed, or freed

        template <class Self, class Archive>
        static void list(Self& self, Archive& archive) {
            archive(self.keyframes);
        }
    };

    /// What people say about a fragment.
    struct Expectation {
        Surroundings place;
        std::size_t keyframe = 0;
        bool is_tracked = false;
    };

    /// A search for the newest keyframes of a fragment.
    struct Query {
        std::size_t keyframe = 0; // the newest one when it began
        std::size_t done = 0;     // lookups
        std::size_t allowed = 0;  // lookups until the fragment has another keyframe
        std::shared_ptr<LocatedMap> map;
        std::vector<scan_matching::SurfacePoint> points;  // of the keyframes, in the frame of the newest one
        std::optional<scan_matching::PlaceSearch> search; // nullopt: it must be done again

        /// Returns where the keyframe is if one place is better than all others. Precondition: the search has ended.
        [[nodiscard]] std::optional<Answer> answer() const;

        template <class Self, class Archive>
        static void list(Self& self, Archive& archive) {
            archive(self.keyframe, self.done, self.allowed, self.map, self.points);
        }
    };

    /// A fragment that is searched for.
    struct Searched {
        std::vector<Answer> answers;
        std::optional<Query> query; // that has not ended
        std::optional<Expectation> expectation;
    };

    [[nodiscard]] bool add_answer(KeyframeGraph& graph, std::size_t fragment, const Answer& answer);
    [[nodiscard]] bool locate(KeyframeGraph& graph, std::size_t fragment, const Transform2& T_map_fragment) const;
    [[nodiscard]] static bool connect(KeyframeGraph& graph, std::size_t fragment, const Transform2& T_map_newest);
    [[nodiscard]] Searched& searched(std::size_t fragment);
    [[nodiscard]] static const std::shared_ptr<const scan_matching::PlaceMap>& places_of(const KeyframeGraph& graph,
                                                                                         LocatedMap& map);
    [[nodiscard]] static bool run(const KeyframeGraph& graph, Query& query, std::size_t lookups);
    static void make_search(const KeyframeGraph& graph, Query& query, const std::optional<Expectation>& expectation);
    [[nodiscard]] bool is_outdated(const KeyframeGraph& graph, const std::vector<Located>& located) const;
    void update_map(const KeyframeGraph& graph);
    [[nodiscard]] std::optional<Query> ask(const KeyframeGraph& graph, std::size_t fragment,
                                           const std::optional<Expectation>& expectation);
    [[nodiscard]] bool is_confirmed(const KeyframeGraph& graph, const std::vector<Answer>& answers) const;

    std::shared_ptr<LocatedMap> map_ = std::make_shared<LocatedMap>(); // without keyframes: none was needed yet
    std::vector<Searched> searched_;                                   // by fragment
    bool is_map_complete_ = false;
};

} // namespace scanloom::slam
