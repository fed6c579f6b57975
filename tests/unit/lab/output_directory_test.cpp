#include "lab/run.hpp"

#include "tests/support/temporary_directory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

namespace scanloom::lab {
namespace {

using testing::HasSubstr;

TEST(OutputDirectory, IsCreatedWithParentsAndReplacesFiles) {
    const TemporaryDirectory place;
    const auto directory = OutputDirectory::open(place.path() / "a" / "b");
    ASSERT_TRUE(directory);
    ASSERT_TRUE(directory->write("file", "a longer text"));
    ASSERT_TRUE(directory->write("file", "text"));
    std::ifstream file(place.path() / "a" / "b" / "file");
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), "text");
}

TEST(OutputDirectory, ErrorsContainThePath) {
    const TemporaryDirectory place;
    std::ofstream(place.path() / "file") << "no directory";
    EXPECT_THAT(OutputDirectory::open(place.path() / "file" / "below").error().message, HasSubstr("/file/below: "));
    const auto directory = OutputDirectory::open(place.path());
    std::filesystem::create_directory(place.path() / "taken");
    EXPECT_THAT(directory->write("taken", "x").error().message, HasSubstr("/taken: cannot be written"));
}

} // namespace
} // namespace scanloom::lab
