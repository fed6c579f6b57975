#include "common/app/machine.hpp"

#include "tests/support/temporary_directory.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

namespace scanloom {
namespace {

namespace fs = std::filesystem;

class ControlGroupLimit : public testing::Test {
protected:
    void write(const fs::path& file, const std::string& text) {
        fs::create_directories((root_.path() / file).parent_path());
        std::ofstream(root_.path() / file) << text << '\n';
    }

    TemporaryDirectory root_;
};

TEST_F(ControlGroupLimit, IsTheLeastOfAllEnclosingGroups) {
    write("proc/self/cgroup", "0::/system.slice/scanloom.service");
    EXPECT_EQ(control_group_limit(root_.path()), std::nullopt);
    write("sys/fs/cgroup/system.slice/scanloom.service/memory.max", "max");
    EXPECT_EQ(control_group_limit(root_.path()), std::nullopt);
    write("sys/fs/cgroup/system.slice/memory.max", "3000000");
    EXPECT_EQ(control_group_limit(root_.path()), 3'000'000U);
    write("sys/fs/cgroup/system.slice/scanloom.service/memory.max", "2000000");
    EXPECT_EQ(control_group_limit(root_.path()), 2'000'000U);
    write("sys/fs/cgroup/memory.max", "1000000"); // a container sees its group as the root
    EXPECT_EQ(control_group_limit(root_.path()), 1'000'000U);
    write("sys/fs/cgroup/user.slice/memory.max", "1000"); // of others
    EXPECT_EQ(control_group_limit(root_.path()), 1'000'000U);
}

TEST_F(ControlGroupLimit, IsReadFromVersion1Hierarchies) {
    write("proc/self/cgroup", "9:name=systemd:/\n4:cpu,memory:/docker/1\n0::/");
    write("sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712"); // no limit
    write("sys/fs/cgroup/memory/docker/1/memory.limit_in_bytes", "500000000");
    EXPECT_EQ(control_group_limit(root_.path()), 500'000'000U);
}

TEST_F(ControlGroupLimit, IsAbsentWithoutControlGroups) { EXPECT_EQ(control_group_limit(root_.path()), std::nullopt); }

} // namespace
} // namespace scanloom
