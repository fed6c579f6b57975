#include "server/app/options.hpp"

#include "server/app/guards.hpp"
#include "server/auth/token_text.hpp"
#include "tests/support/temporary_directory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <fstream>

namespace scanloom::app {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::variant<ServerOptions, Leave> read(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"scanloom-server", "--store", "s"});
    std::vector<const char*> argv;
    for (const auto& argument : arguments) argv.push_back(argument.c_str());
    return read_options(static_cast<int>(argv.size()), argv.data());
}

std::string refusal(std::vector<std::string> arguments) {
    const auto outcome = read(std::move(arguments));
    const auto* leave = std::get_if<Leave>(&outcome);
    if (leave == nullptr) return "taken";
    EXPECT_EQ(leave->code, kExitUsage);
    EXPECT_EQ(leave->text.find('\n'), leave->text.size() - 1) << leave->text;
    return leave->text;
}

class ServerOptionsTest : public testing::Test {
protected:
    std::string file(const std::string& name, const std::string& content) {
        const auto path = directory_.path() / name;
        std::ofstream(path) << content;
        return path.string();
    }

    TemporaryDirectory directory_;
};

TEST_F(ServerOptionsTest, ReportsErrorsOfTheFileWithoutTermsOfCli11) {
    const auto unknown = refusal({"--config", file("a.toml", "lissen = \"127.0.0.1:1\"\n")});
    EXPECT_THAT(unknown, AllOf(HasSubstr("the file of --config"), HasSubstr("lissen"), Not(HasSubstr("INI"))));
    const auto missing = refusal({"--config", "no-such-file.toml"});
    EXPECT_THAT(missing, AllOf(HasSubstr("the file of --config cannot be read"), HasSubstr("no-such-file.toml")));
    EXPECT_THAT(refusal({"--config", file("b.toml", "threads = 0\n")}), HasSubstr("--threads"));
}

TEST_F(ServerOptionsTest, ReportsTheLineOfAnUnclosedStringOrArray) {
    const auto string = file("string.toml", "threads = 2\nlog-level = \"info\nlisten = \"127.0.0.1:0\"\n");
    EXPECT_THAT(refusal({"--config", string}), HasSubstr(string + ":2: a string is not closed; end it with \""));
    const auto array = file("array.toml", "http-host = [\"maps.lab\"\n");
    EXPECT_THAT(refusal({"--config", array}), HasSubstr(array + ":1: a [ is not closed; end it with ]"));
    setenv("SCANLOOM_CONFIG", array.c_str(), 1);
    EXPECT_THAT(refusal({}), HasSubstr(array + ":1:"));
    unsetenv("SCANLOOM_CONFIG");
}

TEST_F(ServerOptionsTest, ReadsHashInAStringAsText) {
    const auto config =
        file("a.toml", "store = \"/maps#1, old\" # not here\nhttp-host = [ # two\n \"a\",\n \"b\", # b\n]\n");
    std::vector<const char*> argv = {"scanloom-server", "--config", config.c_str()};
    const auto options = std::get<ServerOptions>(read_options(static_cast<int>(argv.size()), argv.data()));
    EXPECT_EQ(options.store, "/maps#1, old");
    EXPECT_THAT(options.http_hosts, ElementsAre("a", "b"));
}

TEST_F(ServerOptionsTest, RejectsAGivenDirectoryWithoutViewer) {
    const auto path = directory_.path().string();
    EXPECT_THAT(refusal({"--web", path}), AllOf(HasSubstr("--web: " + path), HasSubstr("index.html")));
    EXPECT_THAT(refusal({"--config", file("a.toml", "web = \"" + path + "\"\n")}), HasSubstr("index.html"));
    file("index.html", "<html></html>");
    EXPECT_EQ(std::get<ServerOptions>(read({"--web", path})).web, path);
}

/// A script's variable that was never set would switch off what it was to name, or serve in place of a task.
TEST_F(ServerOptionsTest, RejectsEmptyValues) {
    for (const auto* option : {"--tokens", "--robot-client-ca", "--http-client-ca", "--robot-tls-cert", "--restore",
                               "--repair", "--backups", "--store", "--web", "--listen", "--http-host"}) {
        EXPECT_THAT(refusal({option, ""}), AllOf(HasSubstr(option), HasSubstr("empty"))) << option;
    }
    EXPECT_THAT(refusal({"--config", file("a.toml", "tokens = \"\"\n")}), HasSubstr("empty"));
    setenv("SCANLOOM_TOKENS", "", 1);
    EXPECT_THAT(refusal({}), AllOf(HasSubstr("SCANLOOM_TOKENS"), HasSubstr("empty")));
    unsetenv("SCANLOOM_TOKENS");
}

TEST_F(ServerOptionsTest, TileCacheIsInMebibytes) {
    const auto bytes = [](std::vector<std::string> arguments) {
        return std::get<ServerOptions>(read(std::move(arguments))).tile_cache_bytes;
    };
    EXPECT_EQ(bytes({}), std::size_t{64} << 20);
    EXPECT_EQ(bytes({"--tile-cache", "1.5"}), std::size_t{3} << 19);
    EXPECT_EQ(bytes({"--tile-cache", "0"}), 0U);
    for (const auto* wrong : {"-1", "64M", "nan"}) {
        EXPECT_THAT(refusal({"--tile-cache", wrong}), HasSubstr("--tile-cache")) << wrong;
    }
}

TEST_F(ServerOptionsTest, ProxiesMustBeAddresses) {
    const auto options = std::get<ServerOptions>(read({"--http-proxy", "192.0.2.7,::1"}));
    EXPECT_THAT(options.http_proxies,
                ElementsAre(boost::asio::ip::make_address("192.0.2.7"), boost::asio::ip::make_address("::1")));
    EXPECT_THAT(refusal({"--http-proxy", "proxy.lab"}), HasSubstr("'proxy.lab' is not an address"));
}

TEST_F(ServerOptionsTest, RejectsADiskReserveBelowTheMinimum) {
    EXPECT_EQ(std::get<ServerOptions>(read({"--disk-reserve", "32"})).disk_reserve_bytes, std::uint64_t{32} << 20);
    for (const auto* wrong : {"0", "5", "31.9"}) {
        EXPECT_THAT(refusal({"--disk-reserve", wrong}), HasSubstr("the store needs 32 MiB")) << wrong;
    }
}

TEST_F(ServerOptionsTest, MapMemoryIsInMebibytes) {
    const auto options = std::get<ServerOptions>(read({"--map-memory", "100", "--weave-memory", "64.5"}));
    EXPECT_EQ(options.map_memory_bytes, std::size_t{100} << 20);
    EXPECT_EQ(options.replay_memory_bytes, std::size_t{129} << 19);
    for (const auto* wrong : {"63", "-1", "nan"}) {
        EXPECT_THAT(refusal({"--weave-memory", wrong}), HasSubstr("--weave-memory")) << wrong;
    }
}

TEST_F(ServerOptionsTest, AcceptsSeveralHostNames) {
    EXPECT_THAT(std::get<ServerOptions>(read({"--http-host", "maps.lab", "--http-host", "maps"})).http_hosts,
                ElementsAre("maps.lab", "maps"));
    EXPECT_THAT(std::get<ServerOptions>(read({"--http-host", "maps.lab,maps"})).http_hosts,
                ElementsAre("maps.lab", "maps"));
    const auto config = file("a.toml", "http-host = [\"maps.lab\", \"maps\"]\n");
    EXPECT_THAT(std::get<ServerOptions>(read({"--config", config})).http_hosts, ElementsAre("maps.lab", "maps"));
    for (const auto* wrong : {"http://maps.lab", "maps.lab:80", "a b"}) {
        EXPECT_THAT(refusal({"--http-host", wrong}), HasSubstr(wrong));
    }
}

TEST_F(ServerOptionsTest, NamesPagesThatMayWatch) {
    const auto origins = [&](std::vector<std::string> arguments) {
        return std::get<ServerOptions>(read(std::move(arguments))).viewer_origins;
    };
    EXPECT_THAT(origins({}), ElementsAre("https://app.foxglove.dev"));
    EXPECT_THAT(origins({"--viewer-origin", "https://a.lab,http://b:8080"}),
                ElementsAre("https://a.lab", "http://b:8080"));
    EXPECT_THAT(origins({"--viewer-origin", "none"}), ElementsAre("none")) << "which no page has";
    for (const auto* wrong : {"a.lab", "https://a.lab/", "://a", "https://a.lab?x"}) {
        EXPECT_THAT(refusal({"--viewer-origin", wrong}), HasSubstr("is not an origin"));
    }
}

TEST_F(ServerOptionsTest, SelectsCheckRepairAndRestore) {
    const auto options = [](std::vector<std::string> arguments) {
        return std::get<ServerOptions>(read(std::move(arguments)));
    };
    EXPECT_EQ(options({}).task, Task::kServe);
    EXPECT_EQ(options({"--check"}).task, Task::kCheck);
    EXPECT_EQ(options({"--check=deep"}).task, Task::kCheckMaps);
    EXPECT_EQ(options({"--repair", "new"}).task, Task::kRepair);
    EXPECT_EQ(options({"--repair", "new"}).repaired, "new");
    EXPECT_EQ(options({"--backups", "b"}).task, Task::kServe);
    EXPECT_EQ(options({"--backups", "b"}).backups_kept, 7U);
    const auto newest = options({"--restore", "newest", "--backups", "b"});
    EXPECT_EQ(newest.task, Task::kRestore);
    EXPECT_EQ(newest.backup, std::nullopt);
    EXPECT_EQ(options({"--restore", "12", "--backups", "b"}).backup, 12U);

    EXPECT_THAT(refusal({"--check=all"}), HasSubstr("--check"));
    EXPECT_THAT(refusal({"--check", "--repair", "new"}), HasSubstr("--repair"));
    EXPECT_THAT(refusal({"--restore", "newest"}), HasSubstr("--backups"));
    EXPECT_THAT(refusal({"--backups", "b", "--backups-kept", "0"}), HasSubstr("--backups-kept"));
    for (const auto* wrong : {"0", "-1", "12x", "latest", "99999999999"}) {
        EXPECT_THAT(refusal({"--restore", wrong, "--backups", "b"}), HasSubstr("--restore")) << wrong;
    }
}

std::string refusal_of(std::vector<const char*> argv) {
    argv.insert(argv.begin(), "scanloom-server");
    return std::get<Leave>(read_options(static_cast<int>(argv.size()), argv.data())).text;
}

TEST_F(ServerOptionsTest, CopiesNameBothStores) {
    const std::array argv = {"scanloom-server", "--copy", "a", "--to", "postgresql://u@h/d"};
    const auto options = std::get<ServerOptions>(read_options(static_cast<int>(argv.size()), argv.data()));
    EXPECT_EQ(options.task, Task::kCopy);
    EXPECT_EQ(options.store, "a");
    EXPECT_EQ(options.copied, "postgresql://u@h/d");
    EXPECT_THAT(refusal_of({"--copy", "a"}), HasSubstr("--to"));
    EXPECT_THAT(refusal_of({"--store", "a", "--to", "b"}), HasSubstr("--copy"));
    EXPECT_THAT(refusal_of({"--copy", "a", "--to", "a"}), HasSubstr("is the same directory as"));
    EXPECT_THAT(refusal_of({"--copy", "a", "--to", "a/b"}), HasSubstr("inside"));
    EXPECT_THAT(refusal_of({"--copy", "postgresql://u@h/d", "--to", "postgresql://u@h/d"}),
                HasSubstr("name another one"));
    EXPECT_THAT(refusal_of({"--copy", "a", "--to", "b", "--store", "c"}), HasSubstr("leave --store out"));
    EXPECT_THAT(refusal_of({"--copy", "a", "--to", "b", "--check"}), HasSubstr("--check"));
    EXPECT_THAT(refusal_of({"--http", "127.0.0.1:0"}), HasSubstr("--store is required"));
}

TEST_F(ServerOptionsTest, StoresAreDirectoriesOrDatabases) {
    for (const auto* database : {"postgresql://u@h/d", "postgres://u:p@h:1,i:2/d?sslmode=require"}) {
        const std::array argv = {"scanloom-server",      "--store",          database,
                                 "--allow-unreplicated", "--store-size-max", "1000"};
        const auto options = std::get<ServerOptions>(read_options(static_cast<int>(argv.size()), argv.data()));
        EXPECT_EQ(options.store, database);
        EXPECT_TRUE(options.allow_unreplicated);
        EXPECT_EQ(options.store_bytes_max, std::uint64_t{1000} << 20);
    }
    EXPECT_THAT(refusal_of({"--store", "postgresql://u@h"}), HasSubstr("names no database"));
    EXPECT_THAT(refusal_of({"--store", "mysql://u@h/d"}), HasSubstr("neither a directory nor a database"));
    EXPECT_THAT(refusal_of({"--store", "postgresql://u@h/d", "--backups", "b"}),
                HasSubstr("--backups is for a store in"));
    EXPECT_THAT(refusal_of({"--store", "postgresql://u@h/d", "--repair", "b"}),
                HasSubstr("--repair is for a store in"));
    EXPECT_THAT(refusal_of({"--store", "directory", "--store-size-max", "1000"}),
                HasSubstr("--store-size-max is for a store in a database"));
}

std::vector<std::string> warnings(std::vector<std::string> arguments) {
    return guard_warnings(std::get<ServerOptions>(read(std::move(arguments))));
}

TEST_F(ServerOptionsTest, RejectsUnprotectedPortsBeyondLoopback) {
    const std::vector<std::string> tls = {"--robot-tls-cert", "c", "--robot-tls-key", "k"};
    const auto with = [](std::vector<std::string> a, const std::vector<std::string>& b) {
        a.insert(a.end(), b.begin(), b.end());
        return a;
    };
    const std::vector<std::string> robots = {"--listen", "0.0.0.0:7447"};
    const std::vector<std::string> people = {"--http", "[::]:8080"};
    EXPECT_THAT(refusal(robots),
                AllOf(HasSubstr("--listen 0.0.0.0"), HasSubstr("--robot-tls-cert"), HasSubstr("--insecure")));
    EXPECT_THAT(refusal(people), AllOf(HasSubstr("--http ::"), HasSubstr("--http-tls-cert"), HasSubstr("--insecure")));
    EXPECT_THAT(refusal(with(people, tls)), HasSubstr("--http ::")) << "robots' TLS does not guard it";
    EXPECT_EQ(refusal(with(people, {"--http-tls-cert", "c", "--http-tls-key", "k"})), "taken");
    for (const auto& port : {robots, people}) {
        EXPECT_EQ(refusal(with(port, {"--tokens", "t"})), "taken");
        EXPECT_EQ(refusal(with(port, {"--insecure"})), "taken");
    }
    EXPECT_EQ(refusal(with(robots, tls)), "taken");
}

TEST_F(ServerOptionsTest, WarnsOfRemainingAccess) {
    EXPECT_THAT(warnings({}), testing::IsEmpty());
    EXPECT_THAT(warnings({"--tokens", "t"}), testing::IsEmpty()) << "loopback needs no TLS";
    EXPECT_THAT(warnings({"--listen", "0.0.0.0:1", "--tokens", "t"}),
                ElementsAre(AllOf(HasSubstr("--listen"), HasSubstr("without TLS"))));
    EXPECT_THAT(warnings({"--listen", "0.0.0.0:1", "--robot-tls-cert", "c", "--robot-tls-key", "k"}),
                ElementsAre(AllOf(HasSubstr("--listen"), HasSubstr("no token is required"))));
    EXPECT_THAT(warnings({"--listen", "0.0.0.0:1", "--tokens", "t", "--robot-tls-cert", "c", "--robot-tls-key", "k"}),
                testing::IsEmpty());
    EXPECT_THAT(warnings({"--http", "0.0.0.0:1", "--tokens", "t", "--http-tls-cert", "c", "--http-tls-key", "k"}),
                testing::IsEmpty());
    EXPECT_THAT(
        warnings({"--http", "0.0.0.0:1", "--http-tls-cert", "c", "--http-tls-key", "k", "--http-client-ca", "a.pem"}),
        ElementsAre(HasSubstr("every client that presents a certificate signed by a.pem can")));
    EXPECT_THAT(refusal({"--robot-client-ca", "a.pem"}), HasSubstr("--robot-tls-cert"));
    EXPECT_THAT(warnings({"--http", "0.0.0.0:1", "--insecure"}), ElementsAre(HasSubstr("--http: no token")));
}

std::variant<ServerOptions, Leave> token(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"scanloom-server", "token"});
    std::vector<const char*> argv;
    for (const auto& argument : arguments) argv.push_back(argument.c_str());
    return read_options(static_cast<int>(argv.size()), argv.data());
}

TEST(TokenCommand, PrintsASecretAndItsLines) {
    const auto leave = std::get<Leave>(token({"--name", "depot", "--role", "robot", "--session", "depot-*", "lab"}));
    ASSERT_EQ(leave.code, kExitDone);
    const auto secret = leave.text.substr(0, leave.text.find('\n'));
    const auto tokens = auth::parse_tokens(leave.text.substr(leave.text.find("[[token]]"))).value();
    const auto made = tokens.find(secret);
    ASSERT_NE(made, nullptr);
    EXPECT_EQ(made->name, "depot");
    EXPECT_EQ(made->role, auth::Role::kRobot);
    EXPECT_THAT(made->sessions, ElementsAre("depot-*", "lab"));
    EXPECT_NE(leave.text, std::get<Leave>(token({"--name", "depot", "--role", "robot"})).text);
}

TEST(TokenCommand, ReportsInvalidArguments) {
    const auto said = [](std::vector<std::string> arguments) {
        const auto leave = std::get<Leave>(token(std::move(arguments)));
        EXPECT_EQ(leave.code, kExitUsage);
        return leave.text;
    };
    EXPECT_THAT(said({"--role", "robot"}), HasSubstr("--name"));
    EXPECT_THAT(said({"--name", "a", "--role", "admin"}), HasSubstr("--role"));
    EXPECT_THAT(said({"--name", "a b", "--role", "robot"}), HasSubstr("is not a name"));
    EXPECT_THAT(said({"--name", "a", "--role", "robot", "--session", "a/b"}), HasSubstr("is not a pattern"));
}

} // namespace
} // namespace scanloom::app
