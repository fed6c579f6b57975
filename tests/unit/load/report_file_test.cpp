#include "load/app/report_file.hpp"

#include "tests/support/temporary_directory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace scanloom::load {
namespace {

namespace fs = std::filesystem;

class ReportFileTest : public testing::Test {
protected:
    void put(const std::string& text) const { std::ofstream(file_) << text; }

    [[nodiscard]] std::string text() const {
        std::ifstream file(file_);
        return {std::istreambuf_iterator<char>(file), {}};
    }
    [[nodiscard]] std::ptrdiff_t files() const {
        return std::distance(fs::directory_iterator(place_.path()), fs::directory_iterator());
    }

    TemporaryDirectory place_;
    fs::path file_ = place_.path() / "report.json";
};

TEST_F(ReportFileTest, EarlierReportStaysUntilTheNewOneIsComplete) {
    put("earlier");
    auto prepared = ReportFile::prepare(file_);
    ASSERT_TRUE(prepared);
    EXPECT_EQ(text(), "earlier");
    ASSERT_TRUE(prepared->write("newer"));
    EXPECT_EQ(text(), "newer");
    EXPECT_EQ(files(), 1);
}

TEST_F(ReportFileTest, RunWithoutReportLeavesNoFile) {
    put("earlier");
    ASSERT_TRUE(ReportFile::prepare(file_));
    EXPECT_EQ(text(), "earlier");
    EXPECT_EQ(files(), 1);
}

TEST_F(ReportFileTest, UnwritablePathIsRefusedInAdvance) {
    const auto nowhere = ReportFile::prepare(place_.path() / "missing" / "report.json");
    ASSERT_FALSE(nowhere);
    EXPECT_THAT(nowhere.error().message, testing::HasSubstr("report.json.part cannot be written: No such file"));
    const auto directory = ReportFile::prepare(place_.path());
    ASSERT_FALSE(directory);
    EXPECT_THAT(directory.error().message, testing::HasSubstr("cannot be written: Is a directory"));
}

TEST_F(ReportFileTest, SpecialFileIsWrittenDirectly) {
    auto full = ReportFile::prepare("/dev/full");
    ASSERT_TRUE(full);
    const auto written = full->write("newer");
    ASSERT_FALSE(written);
    EXPECT_THAT(written.error().message, testing::HasSubstr("/dev/full cannot be written: No space left"));
}

TEST_F(ReportFileTest, SymlinkIsKept) {
    put("earlier");
    const auto link = place_.path() / "newest";
    fs::create_symlink(file_, link);
    auto prepared = ReportFile::prepare(link);
    ASSERT_TRUE(prepared);
    ASSERT_TRUE(prepared->write("newer"));
    EXPECT_TRUE(fs::is_symlink(link));
    EXPECT_EQ(text(), "newer");
}

} // namespace
} // namespace scanloom::load
