#include "server/sessions/session_info.hpp"

#include "core/classify/class_layer.hpp"
#include "core/mapping/laser_chunk.hpp"
#include "core/mapping/sonar_layer.hpp"
#include "server/sessions/replay_jobs.hpp"

#include <gtest/gtest.h>

namespace scanloom::sessions {
namespace {

constexpr std::size_t kBytesOfAChunk = sizeof(mapping::LaserChunk) + classify::ClassLayer::kChunkBytes;
static_assert(sizeof(mapping::SonarChunk) <= kBytesOfAChunk);

TEST(SessionLimits, TakeTheDocumentedMemory) {
    for (const std::size_t chunks :
         {SessionLimits{}.chunks_max, ReplayLimits{}.chunks_max, ReplayLimits{}.chunks_kept_max}) {
        const double gibibytes = static_cast<double>(chunks * kBytesOfAChunk) / (1 << 30);
        EXPECT_NEAR(gibibytes, 2.5, 0.05) << "see the headers of both and docs/internals/threads.md";
    }
}

} // namespace
} // namespace scanloom::sessions
