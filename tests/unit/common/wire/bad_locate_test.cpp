#include "common/scan/limits.hpp"
#include "tests/unit/common/wire/example_messages.hpp"
#include "tests/unit/common/wire/refusals.hpp"

#include "scanloom/v1/frame.pb.h"

#include <string>

/// Invalid localization requests and invalid replies.
namespace scanloom::wire {
namespace {

TEST(BadCorrection, IsRefusedByFieldName) {
    const InvalidCase<Correction> kCases[] = {
        {[](Correction& c) { c.T_map_odom.y = kNan; }, "T_map_odom.y is nan;"},
        {[](Correction& c) { c.explained = 1.01; }, "explained is 1.01;"},
        {[](Correction& c) { c.explained = kNan; }, "explained is nan;"},
        {[](Correction& c) { c.position_sigma = -0.1; }, "position_sigma is -0.1;"},
        {[](Correction& c) { c.yaw_sigma = kInfinity; }, "yaw_sigma is inf;"},
        {[](Correction& c) { c.mount_yaw_error = 3.2; }, "mount_yaw_error is 3.2;"},
        {[](Correction& c) { c.mount_yaw_error = kNan; }, "mount_yaw_error is nan;"},
    };
    for (const auto& invalid : kCases) {
        Correction correction = example_correction();
        invalid.make_invalid(correction);
        expect_refused(body_of(correction), invalid.code, std::string("correction.") + invalid.beginning);
        expect_refused(body_of(LocateReply{1, 2, correction}), invalid.code,
                       std::string("locate_reply.correction.") + invalid.beginning);
    }
}

TEST(Correction, StatesOfLaterVersionsAreUnspecified) {
    v1::Frame frame;
    ASSERT_TRUE(frame.ParseFromString(body_of(example_correction())));
    frame.mutable_correction()->set_state(static_cast<v1::LocalizationState>(99));
    Correction unspecified = example_correction();
    unspecified.state = LocalizationState::kGiven;
    EXPECT_EQ(decode(frame.SerializeAsString()).value(), Message(unspecified));
}

TEST(BadLocateRequest, IsRefusedByFieldName) {
    const InvalidCase<LocateRequest> kCases[] = {
        {[](LocateRequest& r) { r.points.resize(19); }, "locate_request.points has 19 points; at least 20"},
        {[](LocateRequest& r) { r.points.resize(kViewPointsMax + 1); },
         "locate_request.points has 32769 points, at most 32768", Errc::kTooLarge},
        {[](LocateRequest& r) {
             r.points[3] = {0, 1'000'000'001};
         },
         "locate_request.points[7] leads to 1000000001 mm; at most 1000000000"},
        {[](LocateRequest& r) { r.from.x = kNan; }, "locate_request.from.x is nan;"},
        {[](LocateRequest& r) { r.near->point.y = -kInfinity; }, "locate_request.near.y is -inf;"},
        {[](LocateRequest& r) { r.near->radius = 0.0; }, "locate_request.radius is 0 m;"},
        {[](LocateRequest& r) { r.near->radius = 1000.5; }, "locate_request.radius is 1000.5 m;"},
        {[](LocateRequest& r) { r.near->radius = kNan; }, "locate_request.radius is nan m;"},
    };
    for (const auto& invalid : kCases) {
        LocateRequest request = example_locate_request();
        invalid.make_invalid(request);
        expect_refused(body_of(request), invalid.code, invalid.beginning);
    }
}

/// Other implementations of the client can send messages that our client cannot create.
TEST(BadLocateRequest, RefusesMessagesThatOurClientCannotCreate) {
    v1::Frame frame;
    ASSERT_TRUE(frame.ParseFromString(body_of(example_locate_request())));
    auto& request = *frame.mutable_locate_request();
    request.mutable_points()->RemoveLast();
    expect_refused(frame.SerializeAsString(), Errc::kInvalidField, "locate_request.points has 39 numbers;");

    request.clear_points();
    for (int n = 0; n < 40; ++n) request.add_points(2'147'483'647); // the sums are far beyond 32 bits
    expect_refused(frame.SerializeAsString(), Errc::kInvalidField, "locate_request.points[0] leads to 2147483647 mm;");

    request.clear_points();
    for (int n = 0; n < 40; ++n) request.add_points(1);
    request.clear_near();
    expect_refused(frame.SerializeAsString(), Errc::kInvalidField, "locate_request.radius is given, but near is not;");

    frame.mutable_locate_reply()->set_id(1);
    expect_refused(frame.SerializeAsString(), Errc::kInvalidField, "locate_reply.outcome is absent;");
}

TEST(LocateRequest, LargestRequestFitsInAFrame) {
    LocateRequest request = example_locate_request();
    request.points.clear();
    for (std::size_t n = 0; n < kViewPointsMax; ++n) {
        const std::int32_t far = n % 2 == 0 ? 1'000'000'000 : -1'000'000'000;
        request.points.push_back({far, -far});
    }
    const auto decoded = decode(body_of(request));
    ASSERT_TRUE(decoded) << decoded.error().message;
    EXPECT_EQ(*decoded, Message(request));
    EXPECT_LE(body_of(request).size(), std::size_t{1} << 20);
}

} // namespace
} // namespace scanloom::wire
