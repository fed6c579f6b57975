#include "core/landmarks/landmark_map.hpp"

#include "core/landmarks/landmark_matching.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace scanloom::landmarks {
namespace {

Landmark at(double x, double y) { return {.position = {x, y}, .points = 9, .size = {0.3, 0.1}, .spread = 0.05}; }

TEST(LandmarkMap, MatchesKnownLandmarksAndAddsNewOnes) {
    LandmarkMap map;
    EXPECT_EQ(map.add(std::vector{at(0, 0), at(5, 5)}, 10), 0U);
    EXPECT_EQ(map.add(std::vector{at(5.1, 5), at(0.3, 0), at(9, 9)}, 20), 1U);
    const auto view = map.snapshot();
    ASSERT_EQ(view.size(), 4U);
    EXPECT_EQ(view[1].seen, 2U);
    EXPECT_EQ(view[1].first, 10U);
    EXPECT_EQ(view[1].last, 20U);
    EXPECT_EQ(view[0].seen, 1U);
    EXPECT_EQ(view[2].landmark.position, (Point2{0.3, 0})) << "a landmark 0.3 m away is a new one";
    EXPECT_EQ(view[3].id, 3U);
}

TEST(LandmarkMap, PositionIsTheMedianOfTheLastSightings) {
    LandmarkMap map;
    std::mt19937 random(1);
    std::vector<Point2> sightings;
    for (int n = 0; n < 40; ++n) {
        const Point2 seen{0.001 * static_cast<double>(random() % 100), 0.001 * static_cast<double>(random() % 100)};
        sightings.push_back(seen);
        map.add(std::vector{at(seen.x, seen.y)}, 100 + static_cast<Revision>(n));
        const auto kept = std::min(sightings.size(), kSightingsKept);
        std::vector<double> x;
        std::vector<double> y;
        for (auto back = sightings.rbegin(); back != sightings.rbegin() + static_cast<std::ptrdiff_t>(kept); ++back) {
            x.push_back(back->x);
            y.push_back(back->y);
        }
        std::ranges::sort(x);
        std::ranges::sort(y);
        const Point2 median{0.5 * (x[(kept - 1) / 2] + x[kept / 2]), 0.5 * (y[(kept - 1) / 2] + y[kept / 2])};
        const auto view = map.snapshot();
        ASSERT_EQ(view.size(), 1U);
        EXPECT_EQ(view[0].landmark.position, median);
        EXPECT_EQ(view[0].seen, sightings.size());
    }
}

/// Known landmarks, matched by comparing all pairs.
class NaiveMap {
public:
    void add(const std::vector<Landmark>& seen) {
        std::vector<Point2> known;
        for (const auto& sightings : sightings_) known.push_back(place_of(sightings));
        std::vector<bool> is_known(seen.size());
        for (std::size_t n = 0; n < seen.size(); ++n) {
            std::size_t nearest = known.size();
            for (std::size_t k = 0; k < known.size(); ++k) {
                if (nearest == known.size() || distance(seen[n], known[k]) < distance(seen[n], known[nearest]))
                    nearest = k;
            }
            if (nearest == known.size() || distance(seen[n], known[nearest]) > kTolerance) continue;
            bool mutual = true;
            for (std::size_t other = 0; other < seen.size(); ++other) {
                const double its = distance(seen[other], known[nearest]);
                const double ours = distance(seen[n], known[nearest]);
                mutual = mutual && !(its < ours || (its == ours && other < n));
            }
            if (!mutual) continue;
            is_known[n] = true;
            sightings_[nearest].push_back(seen[n].position);
        }
        for (std::size_t n = 0; n < seen.size(); ++n) {
            if (!is_known[n]) sightings_.push_back({seen[n].position});
        }
    }

    [[nodiscard]] std::vector<Point2> places() const {
        std::vector<Point2> out;
        for (const auto& sightings : sightings_) out.push_back(place_of(sightings));
        return out;
    }

private:
    static double distance(const Landmark& seen, const Point2& known) {
        return squared_norm(seen.position - known) > 0 ? norm(seen.position - known) : 0.0;
    }

    static Point2 place_of(const std::vector<Point2>& sightings) {
        const auto kept = std::min(sightings.size(), kSightingsKept);
        std::vector<double> x;
        std::vector<double> y;
        for (std::size_t n = sightings.size() - kept; n < sightings.size(); ++n) {
            x.push_back(sightings[n].x);
            y.push_back(sightings[n].y);
        }
        std::ranges::sort(x);
        std::ranges::sort(y);
        return {0.5 * (x[(kept - 1) / 2] + x[kept / 2]), 0.5 * (y[(kept - 1) / 2] + y[kept / 2])};
    }

    std::vector<std::vector<Point2>> sightings_;
};

TEST(LandmarkMap, MatchesBruteForceOverAllPairs) {
    std::mt19937 random(2);
    for (int round = 0; round < 200; ++round) {
        LandmarkMap map;
        NaiveMap naive;
        for (Revision capture = 1; capture <= 20; ++capture) {
            std::vector<Landmark> seen;
            for (auto n = random() % 12; n > 0; --n) {
                seen.push_back(at(0.013 * static_cast<double>(random() % 200) - 1.3,
                                  0.013 * static_cast<double>(random() % 200) - 1.3));
            }
            map.add(seen, capture);
            naive.add(seen);
        }
        std::vector<Point2> places;
        const auto view = map.snapshot();
        for (std::size_t id = 0; id < view.size(); ++id) places.push_back(view[id].landmark.position);
        ASSERT_EQ(places, naive.places()) << "round " << round;
    }
}

TEST(LandmarkMap, ViewsDoNotChange) {
    LandmarkMap map;
    for (int n = 0; n < 100; ++n) map.add(std::vector{at(n, 0)}, 1);
    const auto before = map.snapshot();
    map.add(std::vector{at(3.1, 0), at(200, 0)}, 2);
    EXPECT_EQ(before.size(), 100U);
    EXPECT_EQ(before[3].seen, 1U);
    EXPECT_EQ(map.snapshot()[3].seen, 2U);
    EXPECT_EQ(map.snapshot()[7].seen, 1U);
    EXPECT_EQ(map.snapshot().size(), 101U);
    EXPECT_EQ(map.snapshot().blocks()[1], before.blocks()[1]) << "unchanged blocks are not copied";
}

} // namespace
} // namespace scanloom::landmarks
