#include "server/live/core/landmark_news.hpp"

#include "server/live/core/narrator.hpp"
#include "tests/support/live_replay.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <random>

namespace scanloom::live {
namespace {

using landmarks::Landmark;
using testing::IsEmpty;
using testing::SizeIs;
using testing_support::LiveReplay;

/// A session's landmarks while captures come, each of which sees some known ones again and some new ones.
class Seeing {
public:
    explicit Seeing(unsigned seed) : random_(seed) {}

    void capture(std::size_t fresh, std::size_t again) {
        std::map<int, Landmark> seen; // each place once
        for (std::size_t n = 0; n < again && places_ > 0; ++n) see(static_cast<int>(random_() % places_), seen);
        for (std::size_t n = 0; n < fresh; ++n) see(places_++, seen);
        std::vector<Landmark> all;
        for (const auto& [place, landmark] : seen) all.push_back(landmark);
        map_.add(all, ++revision_);
        ++captures_;
    }

    [[nodiscard]] std::shared_ptr<const FoundLandmarks> found(std::string refused = {}) {
        return std::make_shared<const FoundLandmarks>(
            FoundLandmarks{{map_.snapshot(), captures_, {}}, revision_, std::move(refused)});
    }

    [[nodiscard]] landmarks::LandmarkView view() { return map_.snapshot(); }

private:
    void see(int place, std::map<int, Landmark>& seen) const {
        const double x = place % 40; // metres apart, so that none is taken for another
        seen[place] = {.position = {x, place / 40.0}, .points = 12, .size = {0.5, 0.25}, .spread = 0.125};
    }

    std::mt19937 random_;
    int places_ = 0;
    landmarks::LandmarkMap map_;
    Revision revision_ = 0;
    std::uint64_t captures_ = 0;
};

void expect_equal(const LiveReplay& viewer, const landmarks::LandmarkView& landmarks) {
    ASSERT_EQ(viewer.landmarks.size(), landmarks.size());
    for (const auto& [id, told] : viewer.landmarks) {
        const auto& truth = landmarks[id];
        EXPECT_EQ(told.id(), truth.id);
        EXPECT_EQ(told.x(), truth.landmark.position.x);
        EXPECT_EQ(told.y(), truth.landmark.position.y);
        EXPECT_EQ(told.seen(), truth.seen);
        EXPECT_EQ(told.size_x(), 0.5F);
        EXPECT_EQ(told.size_y(), 0.25F);
        EXPECT_EQ(told.spread(), 0.125F);
        EXPECT_EQ(told.points(), 12U);
        EXPECT_EQ(told.first(), truth.first);
        EXPECT_EQ(told.last(), truth.last);
    }
}

Moment moment_with(std::shared_ptr<const FoundLandmarks> found) {
    Moment moment;
    moment.maps = std::make_shared<const mapping::Snapshot>();
    moment.landmarks = std::move(found);
    return moment;
}

Narrator narrator_for_landmarks() {
    Narrator narrator("tag");
    narrator.set_wishes({{}, false, true});
    return narrator;
}

TEST(LandmarkNews, AreThoseBehindTheLastPlaceWhateverFitsAtOnce) {
    for (const unsigned seed : {1U, 2U, 3U}) {
        Seeing session(seed);
        std::mt19937 random(seed);
        std::map<std::uint32_t, landmarks::MapLandmark> known;
        LandmarkPlace told;
        for (int step = 0; step < 200; ++step) {
            if (random() % 3 == 0) session.capture(random() % 7, random() % 9);
            const std::size_t most = 1 + random() % 5;
            const auto view = session.view();
            const auto news = news_in(view, told, most);
            EXPECT_LE(news.first.size(), most);
            if (news.following > 0) {
                EXPECT_THAT(news.first, SizeIs(most));
            }
            for (const auto* one : news.first) {
                EXPECT_LT(told, place_of(*one)) << "each is told once, in order";
                told = place_of(*one);
                known[one->id] = *one;
            }
        }
        const auto view = session.view();
        for (const auto* one : news_in(view, told, view.size()).first) known[one->id] = *one;
        ASSERT_EQ(known.size(), view.size());
        for (const auto& [id, one] : known) EXPECT_EQ(one, view[id]) << "seed " << seed;
    }
}

TEST(NarratorOfLandmarks, WhoeverReadsEveryEventKnowsThemAll) {
    Seeing session(1);
    Narrator narrator = narrator_for_landmarks();
    LiveReplay viewer;
    std::mt19937 random(1);
    for (int step = 0; step < 60; ++step) {
        session.capture(random() % 60, random() % 40);
        if (random() % 2 == 0) continue; // the viewer is busy
        const Moment moment = moment_with(session.found());
        if (const auto event = narrator.next(moment)) viewer.take(wire::encode(*event));
        ASSERT_NO_FATAL_FAILURE(expect_equal(viewer, session.view()));
        EXPECT_EQ(viewer.last_landmarks.captures(), moment.landmarks->state.captures);
        EXPECT_EQ(viewer.last_landmarks.revision(), moment.landmarks->revision);
        EXPECT_FALSE(narrator.has_more());
        EXPECT_EQ(narrator.next(moment), std::nullopt) << "nothing is said twice";
    }
}

TEST(NarratorOfLandmarks, WhatOneEventHasNoPlaceForIsInTheNext) {
    Seeing session(1);
    session.capture(2 * kLandmarksMax + 7, 0);
    Narrator narrator = narrator_for_landmarks();
    const Moment moment = moment_with(session.found());
    LiveReplay viewer;
    for (const std::size_t left : {kLandmarksMax + 7, std::size_t{7}, std::size_t{0}}) {
        viewer.take(wire::encode(narrator.next(moment).value()));
        EXPECT_EQ(viewer.last_landmarks.following(), left);
        EXPECT_EQ(narrator.has_more(), left > 0);
    }
    expect_equal(viewer, session.view());
    EXPECT_EQ(narrator.next(moment), std::nullopt);
}

TEST(NarratorOfLandmarks, TheyAreToldOnlyToWhoAsksAndGoOnFromWhereTheyWere) {
    Seeing session(1);
    session.capture(5, 0);
    Narrator narrator("tag");
    EXPECT_FALSE(narrator.wishes_for_landmarks());
    EXPECT_FALSE(narrator.next(moment_with(session.found()))->landmarks);
    narrator.set_wishes({{}, false, true});
    EXPECT_THAT(narrator.next(moment_with(session.found()))->landmarks->landmarks, SizeIs(5));
    narrator.set_wishes({{}, false, false});
    session.capture(2, 0);
    EXPECT_EQ(narrator.next(moment_with(session.found())), std::nullopt);
    narrator.set_wishes({{}, false, true});
    EXPECT_THAT(narrator.next(moment_with(session.found()))->landmarks->landmarks, SizeIs(2));
}

TEST(NarratorOfLandmarks, ThatThereAreNoneAndThatNoMoreAreFoundIsToldOnce) {
    Seeing session(1);
    Narrator narrator = narrator_for_landmarks();
    EXPECT_FALSE(narrator.next(moment_with(nullptr))->landmarks) << "nobody has looked yet";
    const auto none = narrator.next(moment_with(session.found()));
    ASSERT_TRUE(none && none->landmarks);
    EXPECT_THAT(none->landmarks->landmarks, IsEmpty());
    const auto refused = narrator.next(moment_with(session.found("there are too many")));
    ASSERT_TRUE(refused && refused->landmarks);
    EXPECT_EQ(refused->landmarks->refused, "there are too many");
    EXPECT_EQ(narrator.next(moment_with(session.found("there are too many"))), std::nullopt);
    EXPECT_EQ(narrator.next(moment_with(session.found()))->landmarks->refused, "");
}

TEST(NarratorOfLandmarks, AFullEventOfThemIsSmall) {
    Seeing session(1);
    session.capture(kLandmarksMax, 0);
    Narrator narrator = narrator_for_landmarks();
    EXPECT_LE(wire::encode(narrator.next(moment_with(session.found())).value()).size(), 64U * 1024U);
}

} // namespace
} // namespace scanloom::live
