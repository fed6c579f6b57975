#pragma once

#include "server/landmarks/refinement.hpp"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace scanloom::landmarks {

/// How far could be seen from a place in each direction, by what was seen there.
class Horizon {
public:
    /// @param from  where it was seen from, in the frame of the points
    Horizon(std::span<const Point2> points, const Point2& from);

    enum class Verdict {
        kOpen,    ///< what is seen that way is further: a thing here would have been seen
        kHidden,  ///< something stands before it
        kUnknown, ///< about as far as what is seen that way, or nothing is
    };
    [[nodiscard]] Verdict at(const Point2& place) const;

private:
    static constexpr std::size_t kSectors = 360;

    struct Reach {
        double nearest;
        double furthest;
    };
    [[nodiscard]] static std::size_t sector_of(const Point2& offset);

    Point2 from_;
    std::array<Reach, kSectors> reaches_;
};

/// What one view of a place says of another, in surface elements.
struct Evidence {
    std::size_t matched = 0;      ///< lie on the other's surface
    std::size_t contradicted = 0; ///< stand where the other looked through
    std::size_t elements = 0;     ///< all; those neither matched nor contradicted could not be seen by the other

    friend Evidence operator+(const Evidence& a, const Evidence& b) {
        return {a.matched + b.matched, a.contradicted + b.contradicted, a.elements + b.elements};
    }
};

/// Of a second view's elements in a pose, what a first view says.
/// Pre  the surface has elements.
[[nodiscard]] Evidence evidence_of(const Surface& surface, const Horizon& horizon, std::span<const Surfel> second,
                                   const Pose2& T_first_second);

} // namespace scanloom::landmarks
