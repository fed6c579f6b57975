#include "server/app/places.hpp"

#include "tests/support/temporary_directory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

/// Where a store, its backups and what it is repaired into may be.
namespace scanloom::app {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class PlacesTest : public testing::Test {
protected:
    PlacesTest() {
        fs::create_directories(at("store") / "sub");
        fs::create_directory_symlink(at("store") / "sub", at("deep"));
        fs::create_directory_symlink(at("store"), at("link"));
    }

    [[nodiscard]] fs::path at(const std::string& name) const { return directory_.path() / name; }

    [[nodiscard]] std::string refusal(Task task, const fs::path& other, const fs::path& store) const {
        ServerOptions options;
        options.task = task;
        options.store = store;
        (task == Task::kRepair ? options.repaired : options.backups) = other;
        const auto checked = check_places(options);
        return checked ? "taken" : checked.error().message;
    }

    TemporaryDirectory directory_;
};

TEST_F(PlacesTest, RejectsDirectoriesInsideEachOther) {
    for (const auto task : {Task::kServe, Task::kRestore, Task::kRepair}) {
        for (const auto* inside :
             {"store/in", "store/a/b", "store/./in", "x/../store/in", "link/in", "link/a/b/", "deep", "deep/in"}) {
            EXPECT_THAT(refusal(task, at(inside), at("store")), HasSubstr("is inside --store")) << inside;
            EXPECT_THAT(refusal(task, at("store"), at(inside)),
                        HasSubstr("--store " + at(inside).native() + " is inside --"))
                << inside;
            EXPECT_THAT(refusal(task, at(inside), at("link")), HasSubstr("is inside --store")) << inside;
        }
        for (const auto* same : {"store", "store/", "link", "store/../store/."}) {
            EXPECT_THAT(refusal(task, at(same), at("store")), HasSubstr("is the same directory as --store")) << same;
        }
        for (const auto* apart : {"other", "store2", "stor", "store.lost", "link2/in", "store/../in"}) {
            EXPECT_EQ(refusal(task, at(apart), at("store")), "taken") << apart;
        }
        EXPECT_THAT(refusal(task, "/", at("store")), HasSubstr("is inside"));
    }
}

TEST_F(PlacesTest, ResolvesRelativePaths) {
    const auto before = fs::current_path();
    fs::current_path(at("store"));
    EXPECT_THAT(refusal(Task::kServe, "backups", at("store")), HasSubstr("--backups backups is inside --store"));
    EXPECT_EQ(refusal(Task::kServe, "../backups", "."), "taken");
    fs::current_path(before);
}

TEST_F(PlacesTest, IgnoresUnusedDirectories) {
    EXPECT_EQ(refusal(Task::kServe, "", at("store")), "taken");
    EXPECT_EQ(refusal(Task::kCheck, at("store"), at("store")), "taken") << "nothing is written";
}

} // namespace
} // namespace scanloom::app
