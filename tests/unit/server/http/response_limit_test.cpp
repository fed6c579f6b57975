#include "server/http/response_limit.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace scanloom::http {
namespace {

TEST(ResponseLimit, BoundsLargeResponsesAndLeavesSmallOnesFree) {
    const ResponseLimit limit;
    std::vector<std::shared_ptr<const void>> unsent;
    for (std::size_t n = 0; n < ResponseLimit::kHugeResponses; ++n) {
        unsent.push_back(limit.take(ResponseLimit::kLargeMax + 1).value());
    }
    const auto refused = limit.take(ResponseLimit::kLargeMax + 1);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::kOverloaded);
    for (std::size_t n = 0; n < ResponseLimit::kLargeResponses; ++n) {
        unsent.push_back(limit.take(ResponseLimit::kSmallMax + 1).value());
    }
    EXPECT_FALSE(limit.take(ResponseLimit::kLargeMax));
    EXPECT_TRUE(limit.take(ResponseLimit::kSmallMax));

    unsent.clear();
    EXPECT_TRUE(limit.take(ResponseLimit::kLargeMax));
    EXPECT_TRUE(limit.take(ResponseLimit::kLargeMax + 1));
}

} // namespace
} // namespace scanloom::http
