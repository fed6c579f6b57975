#include "robot_client/spool/synced_file.hpp"

#include <gtest/gtest.h>

#include <fcntl.h>

#include <future>
#include <memory>
#include <vector>

namespace scanloom::robot {
namespace {

std::shared_ptr<const FileDescriptor> file(int descriptor) {
    return std::make_shared<const FileDescriptor>(descriptor);
}

TEST(BackgroundSync, WritesDuringAPauseAreSyncedWithoutFurtherWrites) {
    std::promise<void> first;
    std::promise<void> second;
    BackgroundSync sync([&, times = 0](const FileDescriptor&) mutable { (++times == 1 ? first : second).set_value(); },
                        std::chrono::milliseconds(1));
    const auto written = file(::open("/dev/null", O_WRONLY | O_CLOEXEC));
    sync.wrote(written);
    first.get_future().wait();
    sync.wrote(written);
    second.get_future().wait();
}

TEST(BackgroundSync, ClosedFilesAreSyncedOnceAlsoAtTheEnd) {
    std::vector<int> synced;
    std::vector<int> expected;
    {
        std::promise<void> begun;
        std::promise<void> go_on;
        BackgroundSync sync(
            [&](const FileDescriptor& each) {
                synced.push_back(each.get());
                if (synced.size() > 1) return;
                begun.set_value();
                go_on.get_future().wait();
            },
            std::chrono::hours(1)); // the destructor does not wait for the pause
        for (int n = 0; n < 3; ++n) {
            const auto written = file(::open("/dev/null", O_WRONLY | O_CLOEXEC));
            expected.push_back(written->get());
            sync.wrote(written);
            if (n == 0) begun.get_future().wait();
            if (n > 0) sync.wrote(written);
        }
        go_on.set_value();
    }
    EXPECT_EQ(synced, expected);
}

} // namespace
} // namespace scanloom::robot
