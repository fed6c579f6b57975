#include "server/live/core/event_encoder.hpp"
#include "tests/support/live_replay.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

namespace scanloom::live {
namespace {

using landmarks::Landmark;
using testing::IsEmpty;
using testing::SizeIs;
using testing_support::LiveReplay;

/// The landmarks of a session. Each new capture contains some known landmarks and some new ones.
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
    for (const auto& [id, sent] : viewer.landmarks) {
        const auto& truth = landmarks[id];
        EXPECT_EQ(sent.id(), truth.id);
        EXPECT_EQ(sent.x(), truth.landmark.position.x);
        EXPECT_EQ(sent.y(), truth.landmark.position.y);
        EXPECT_EQ(sent.seen(), truth.seen);
        EXPECT_EQ(sent.size_x(), 0.5F);
        EXPECT_EQ(sent.size_y(), 0.25F);
        EXPECT_EQ(sent.spread(), 0.125F);
        EXPECT_EQ(sent.points(), 12U);
        EXPECT_EQ(sent.first(), truth.first);
        EXPECT_EQ(sent.last(), truth.last);
    }
}

SessionSnapshot snapshot_with(std::shared_ptr<const FoundLandmarks> found) {
    SessionSnapshot snapshot;
    snapshot.maps = std::make_shared<const mapping::Snapshot>();
    snapshot.landmarks = std::move(found);
    return snapshot;
}

EventEncoder landmark_encoder() {
    EventEncoder encoder("tag");
    encoder.set_subscription({{}, false, true});
    return encoder;
}

TEST(LandmarkChanges, ReturnsEachChangeOnceInOrder) {
    for (const unsigned seed : {1U, 2U, 3U}) {
        Seeing session(seed);
        std::mt19937 random(seed);
        std::map<std::uint32_t, landmarks::MapLandmark> known;
        LandmarkKey sent;
        for (int step = 0; step < 200; ++step) {
            if (random() % 3 == 0) session.capture(random() % 7, random() % 9);
            const std::size_t most = 1 + random() % 5;
            const auto view = session.view();
            const auto changed = changed_landmarks(view, sent, most);
            EXPECT_LE(changed.first.size(), most);
            if (changed.following > 0) {
                EXPECT_THAT(changed.first, SizeIs(most));
            }
            for (const auto* one : changed.first) {
                EXPECT_LT(sent, key_of(*one)) << "each is sent once, in order";
                sent = key_of(*one);
                known[one->id] = *one;
            }
        }
        const auto view = session.view();
        for (const auto* one : changed_landmarks(view, sent, view.size()).first) known[one->id] = *one;
        ASSERT_EQ(known.size(), view.size());
        for (const auto& [id, one] : known) EXPECT_EQ(one, view[id]) << "seed " << seed;
    }
}

TEST(LandmarkEvents, GiveAllLandmarksToClientThatReadsEveryEvent) {
    Seeing session(1);
    EventEncoder encoder = landmark_encoder();
    LiveReplay viewer;
    std::mt19937 random(1);
    for (int step = 0; step < 60; ++step) {
        session.capture(random() % 60, random() % 40);
        if (random() % 2 == 0) continue; // the viewer is busy
        const SessionSnapshot snapshot = snapshot_with(session.found());
        if (const auto event = encoder.next(snapshot)) viewer.take(wire::encode(*event));
        ASSERT_NO_FATAL_FAILURE(expect_equal(viewer, session.view()));
        EXPECT_EQ(viewer.last_landmarks.captures(), snapshot.landmarks->state.captures);
        EXPECT_EQ(viewer.last_landmarks.revision(), snapshot.landmarks->revision);
        EXPECT_FALSE(encoder.has_more());
        EXPECT_EQ(encoder.next(snapshot), std::nullopt) << "nothing is sent twice";
    }
}

TEST(LandmarkEvents, ContinueInNextEventBeyondMaximum) {
    Seeing session(1);
    session.capture(2 * kLandmarksMax + 7, 0);
    EventEncoder encoder = landmark_encoder();
    const SessionSnapshot snapshot = snapshot_with(session.found());
    LiveReplay viewer;
    for (const std::size_t left : {kLandmarksMax + 7, std::size_t{7}, std::size_t{0}}) {
        viewer.take(wire::encode(encoder.next(snapshot).value()));
        EXPECT_EQ(viewer.last_landmarks.following(), left);
        EXPECT_EQ(encoder.has_more(), left > 0);
    }
    expect_equal(viewer, session.view());
    EXPECT_EQ(encoder.next(snapshot), std::nullopt);
}

TEST(LandmarkEvents, AreSentOnlyWhileSubscribed) {
    Seeing session(1);
    session.capture(5, 0);
    EventEncoder encoder("tag");
    EXPECT_FALSE(encoder.subscribes_to_landmarks());
    EXPECT_FALSE(encoder.next(snapshot_with(session.found()))->landmarks);
    encoder.set_subscription({{}, false, true});
    EXPECT_THAT(encoder.next(snapshot_with(session.found()))->landmarks->landmarks, SizeIs(5));
    encoder.set_subscription({{}, false, false});
    session.capture(2, 0);
    EXPECT_EQ(encoder.next(snapshot_with(session.found())), std::nullopt);
    encoder.set_subscription({{}, false, true});
    EXPECT_THAT(encoder.next(snapshot_with(session.found()))->landmarks->landmarks, SizeIs(2));
}

TEST(LandmarkEvents, ReportNoLandmarksAndRefusalOnce) {
    Seeing session(1);
    EventEncoder encoder = landmark_encoder();
    EXPECT_FALSE(encoder.next(snapshot_with(nullptr))->landmarks) << "no search has ended yet";
    const auto none = encoder.next(snapshot_with(session.found()));
    ASSERT_TRUE(none && none->landmarks);
    EXPECT_THAT(none->landmarks->landmarks, IsEmpty());
    const auto refused = encoder.next(snapshot_with(session.found("there are too many")));
    ASSERT_TRUE(refused && refused->landmarks);
    EXPECT_EQ(refused->landmarks->refused, "there are too many");
    EXPECT_EQ(encoder.next(snapshot_with(session.found("there are too many"))), std::nullopt);
    EXPECT_EQ(encoder.next(snapshot_with(session.found()))->landmarks->refused, "");
}

TEST(LandmarkEvents, FullEventIsAtMost64KiB) {
    Seeing session(1);
    session.capture(kLandmarksMax, 0);
    EventEncoder encoder = landmark_encoder();
    EXPECT_LE(wire::encode(encoder.next(snapshot_with(session.found())).value()).size(), 64U * 1024U);
}

} // namespace
} // namespace scanloom::live
