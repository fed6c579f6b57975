#include "common/app/standard_streams.hpp"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

namespace scanloom {
namespace {

/// In a process of its own: the streams of the test stay open.
[[noreturn]] void close_open_and_tell(int closed_first, int closed_second) {
    close(closed_first);
    close(closed_second);
    open_missing_standard_streams();
    bool all_open = true;
    for (const int stream : {0, 1, 2}) all_open = all_open && fcntl(stream, F_GETFD) >= 0;
    const auto leads_to = [](int stream) {
        return std::filesystem::read_symlink("/proc/self/fd/" + std::to_string(stream));
    };
    const bool replaced = leads_to(closed_first) == "/dev/null" && leads_to(closed_second) == "/dev/null";
    std::_Exit(all_open && replaced ? 0 : 1);
}

TEST(StandardStreams, ThoseThatCameClosedLeadNowhere) {
    EXPECT_EXIT(close_open_and_tell(0, 2), testing::ExitedWithCode(0), "");
    EXPECT_EXIT(close_open_and_tell(1, 2), testing::ExitedWithCode(0), "");
    EXPECT_EXIT(close_open_and_tell(0, 1), testing::ExitedWithCode(0), "");
}

TEST(StandardStreams, OpenOnesStayAsTheyAre) {
    const auto before = std::filesystem::read_symlink("/proc/self/fd/1");
    open_missing_standard_streams();
    EXPECT_EQ(std::filesystem::read_symlink("/proc/self/fd/1"), before);
}

} // namespace
} // namespace scanloom
