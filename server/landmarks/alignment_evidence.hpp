#pragma once

#include "server/landmarks/refinement.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
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
    [[nodiscard]] const Point2& from() const noexcept { return from_; }
    [[nodiscard]] double reach() const noexcept { return reach_; } ///< metres, to the furthest that was seen
    /// Whether anything as far away was seen at all, whichever way: quicker told than at(), which is kOpen for no
    /// other.
    [[nodiscard]] bool reaches(const Point2& place) const { return squared_norm(place - from_) < reach_ * reach_; }

private:
    static constexpr std::size_t kSectors = 360;

    struct Reach {
        double nearest;
        double furthest;
    };
    [[nodiscard]] static std::size_t sector_of(const Point2& offset);

    Point2 from_;
    double reach_ = 0.0;
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

/// What one view says of a surface element of another.
enum class Finding : std::uint8_t {
    kUnseen,       ///< it could not be seen
    kMatched,      ///< it lies on the surface
    kContradicted, ///< it stands where was looked through
};

/// Of a second view's elements in a pose, what a first one says, which was seen from where the horizons are: what any
/// of them looked through, and nothing of the surface is at, contradicts.
/// Pre  the surface has elements.
[[nodiscard]] std::vector<Finding> findings_of(const Surface& surface, std::span<const Horizon* const> horizons,
                                               std::span<const Surfel> second, const Pose2& T_first_second);

[[nodiscard]] Evidence evidence_of(std::span<const Finding> findings);

/// Whether somebody has looked through a place.
[[nodiscard]] bool is_open(std::span<const Horizon* const> horizons, const Point2& place);

} // namespace scanloom::landmarks
