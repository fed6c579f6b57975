#pragma once

#include "common/geometry/point2.hpp"
#include "core/scan_matching/place_map.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <queue>
#include <span>
#include <tuple>

#include <vector>

namespace scanloom::scan_matching {

/// Where points fit a map best.
struct FoundPlace {
    Transform2 T_map_points; ///< within 5 cm and half of a turn of 0.4 degrees of the best pose
    int score = 0;           ///< PlaceMap::score_of() there
    int rival_score = 0;     ///< upper bound of the score of any place more than kApart or kTurnApart away
};

/// What PlaceSearch looks for.
struct PlaceQuestion {
    int score_min = 1;       ///< places with a lower score are not found; positive
    Point2 center{0.0, 0.0}; ///< metres, in the map's frame: places are searched for around it
    double radius = std::numeric_limits<double>::infinity(); ///< metres: up to this distance
    double rival_share = 0.9; ///< the search ends when no rival has more than this share of the best score, 0 to 1
};

/// A search for the place of points in a map, without an estimate of it and in every rotation, a part at a time: by
/// branch and bound, from cells of 3.2 m and 12 degrees down to 10 cm and 0.4 degrees, with the origin of the points in
/// seen free space. The result is that of trying all of the finest ones. Deterministic: equal inputs give equal bits on
/// every processor, in however many parts.
/// Memory: 20 bytes for each cell that waits, up to some megabytes. Threads: one at a time.
/// Source: as for PlaceMap; here with intervals of rotations.
class PlaceSearch {
public:
    static constexpr double kApart = 1.0;     ///< metres between places that are rivals, at least
    static constexpr double kTurnApart = 0.3; ///< radians, or at least this
    static constexpr auto kUnlimited = std::numeric_limits<std::size_t>::max(); ///< lookups: until the search ends

    /// Prepares a search.
    /// @param map       where to search
    /// @param points    in a frame of their own; a few hundred, in any order that does not follow the surfaces
    /// @param question  what counts
    PlaceSearch(std::shared_ptr<const PlaceMap> map, std::span<const SurfacePoint> points,
                const PlaceQuestion& question);

    /// Goes on with the search. Where it stops depends on the lookups alone, not on the calls before.
    /// @param lookups  of points in the map since the beginning, about; 8 million take some tens of milliseconds
    /// @return whether it has ended
    bool run(std::size_t lookups = kUnlimited);

    /// Returns the best place; nullopt: none is as good as `score_min`. Precondition: the search has ended.
    [[nodiscard]] const std::optional<FoundPlace>& place() const noexcept { return best_; }

private:
    static constexpr std::int32_t kTurns = 960; // of the finest level in a full turn: 15 m * 2 pi / 960 = 0.098 m

    /// The poses in a cell of a level, and a bound of their scores.
    struct Node {
        int bound = 0;
        int level = 0;
        std::int32_t column = 0; // cell of the origin of the points
        std::int32_t row = 0;
        std::int32_t turn = 0;
    };

    /// Of equal bounds, the finer node comes first, then the one of the first place.
    struct IsWorse {
        bool operator()(const Node& a, const Node& b) const {
            return std::tuple(a.bound, -a.level, -a.turn, -a.row, -a.column) <
                   std::tuple(b.bound, -b.level, -b.turn, -b.row, -b.column);
        }
    };

    struct Point {
        Point2 at;
        double direction; // radians
        double distance;  // metres, from the origin
        SurfacePoint surface;
    };

    /// Where a point may be in an interval of rotations, if the origin is in the first cell.
    struct Rotated {
        std::int16_t column; // the last cell that it touches
        std::int16_t row;
        PlaceMap::Bits facing;
        std::uint8_t square; // index in PlaceMap::Squares
    };
    using Rotation = std::vector<Rotated>;

    static constexpr std::int32_t turns_of(int level) { return kTurns >> level; }
    [[nodiscard]] static double turn_of(int level);
    [[nodiscard]] static double angle_of_turn(int level, std::int32_t turn);

    void push_roots(std::int32_t turn);
    void open(const Node& node);
    void end(int rival_score);
    void push_children(const Node& node);
    [[nodiscard]] const Rotation& rotation(int level, std::int32_t turn);
    void push(Node node);
    [[nodiscard]] Point2 middle_of(const Node& node) const;
    [[nodiscard]] bool is_within(const Node& node) const;
    [[nodiscard]] bool is_close(const Node& node) const;

    std::shared_ptr<const PlaceMap> map_;
    PlaceQuestion question_;
    std::size_t lookups_ = 0; // so far
    int least_;               // bound of nodes that matter
    std::int32_t roots_ = 0;  // turns of the coarsest level whose nodes were added
    bool has_ended_ = false;
    std::vector<Point> points_;
    std::array<std::vector<Rotation>, PlaceMap::kLevels> rotations_; // by level and turn; empty: not computed yet
    std::priority_queue<Node, std::vector<Node>, IsWorse> open_;
    std::optional<FoundPlace> best_;
    Node best_node_;
};

} // namespace scanloom::scan_matching
