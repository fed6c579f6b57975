#include "server/http/answer_slots.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace scanloom::http {
namespace {

TEST(AnswerSlots, BoundLargeAnswersAndLeaveSmallOnesFree) {
    const AnswerSlots slots;
    std::vector<std::shared_ptr<const void>> unsent;
    for (std::size_t n = 0; n < AnswerSlots::kHugeAnswers; ++n) {
        unsent.push_back(slots.take(AnswerSlots::kLargeMax + 1).value());
    }
    const auto refused = slots.take(AnswerSlots::kLargeMax + 1);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::kOverloaded);
    for (std::size_t n = 0; n < AnswerSlots::kLargeAnswers; ++n) {
        unsent.push_back(slots.take(AnswerSlots::kSmallMax + 1).value());
    }
    EXPECT_FALSE(slots.take(AnswerSlots::kLargeMax));
    EXPECT_TRUE(slots.take(AnswerSlots::kSmallMax));

    unsent.clear();
    EXPECT_TRUE(slots.take(AnswerSlots::kLargeMax));
    EXPECT_TRUE(slots.take(AnswerSlots::kLargeMax + 1));
}

} // namespace
} // namespace scanloom::http
