#include "server/live/viewer_limits.hpp"

#include <gtest/gtest.h>

#include <optional>

namespace scanloom::live {
namespace {

TEST(ViewerSemaphore, SlotsMayOutliveIt) {
    std::optional<ViewerSemaphore> viewers(LiveConfig{});
    const auto slot = viewers->try_take(1);
    viewers.reset();
    EXPECT_TRUE(slot);
}

} // namespace
} // namespace scanloom::live
