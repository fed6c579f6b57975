#include "server/auth/token_file.hpp"

#include "tests/support/temporary_directory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace scanloom::auth {
namespace {

using std::filesystem::perms;
using testing::HasSubstr;
using testing::StartsWith;

class TokenFileTest : public testing::Test {
protected:
    std::filesystem::path write(const std::string& content, perms allowed = perms::owner_read | perms::owner_write) {
        const auto path = directory_.path() / "tokens.toml";
        std::ofstream(path) << content;
        std::filesystem::permissions(path, allowed);
        return path;
    }

    static std::string fault(const std::filesystem::path& path) {
        const auto tokens = read_tokens(path);
        return tokens ? "taken" : tokens.error().message;
    }

    const std::string good_ =
        "[[token]]\nname = \"a\"\nsha256 = \"" + std::string(64, 'a') + "\"\nrole = \"robot\"\nsessions = [\"*\"]\n";
    TemporaryDirectory directory_;
};

TEST_F(TokenFileTest, IsReadIfOnlyItsOwnerCanWrite) {
    EXPECT_EQ(fault(write(good_)), "taken");
    EXPECT_EQ(fault(write(good_, perms::owner_read | perms::owner_write | perms::group_read | perms::others_read)),
              "taken");
    for (const auto others : {perms::group_write, perms::others_write}) {
        const auto path = write(good_, perms::owner_read | perms::owner_write | others);
        EXPECT_THAT(fault(path), AllOf(StartsWith(path.string() + ": users other than its owner can write"),
                                       HasSubstr("chmod go-w " + path.string())));
    }
}

TEST_F(TokenFileTest, UnusableFilesAreRefused) {
    EXPECT_THAT(fault(directory_.path() / "none"), HasSubstr("cannot be read"));
    EXPECT_THAT(fault(directory_.path()), HasSubstr("this is no file"));
    EXPECT_THAT(fault(write(std::string(5 << 20, '#'))), HasSubstr("bytes"));
}

} // namespace
} // namespace scanloom::auth
