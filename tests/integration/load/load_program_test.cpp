#include "tests/integration/load/closing_server.hpp"
#include "tests/integration/load/falsifying_proxy.hpp"
#include "tests/support/postgres_server.hpp"
#include "tests/support/running_server.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/test_certificate.hpp"

#include <boost/json/parse.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <iterator>

/// scanloom-load as a program, with a running server.
namespace scanloom::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

using Words = std::vector<std::string>;

/// Large cells: these tests are about links and counts, not about maps.
const Words kSmallLoad{"--robots", "20", "--rate", "40", "--duration", "3", "--cell-size", "0.2", "--world", "room"};
constexpr std::uint64_t kSmallLoadScans = 20 * 40 * 3;

struct LoadOutcome {
    int code = 0;
    boost::json::value report; ///< null if there is none
    std::string errors;

    [[nodiscard]] std::string verdict() const { return std::string(report.at("verdict").at("sentence").as_string()); }
    [[nodiscard]] std::uint64_t count(const char* part, const char* name) const {
        return report.at(part).at(name).to_number<std::uint64_t>();
    }
};

class LoadProgram : public testing::Test {
protected:
    [[nodiscard]] Words arguments(const Words& further, std::uint16_t http_port) const {
        Words all{"--server", server_->robot_address(), "--http", "127.0.0.1:" + std::to_string(http_port), "--json",
                  "-"};
        all.insert(all.end(), further.begin(), further.end());
        return all;
    }

    [[nodiscard]] LoadOutcome finish(ChildProcess& load) const {
        const auto line = load.read_line();
        const int code = load.wait();
        std::ifstream file(errors());
        return {
            code, line ? boost::json::parse(*line) : boost::json::value(), {std::istreambuf_iterator<char>(file), {}}};
    }

    [[nodiscard]] LoadOutcome run(const Words& further, std::uint16_t http_port = 0) const {
        std::filesystem::remove(errors());
        ChildProcess load(program("scanloom-load"),
                          arguments(further, http_port == 0 ? server_->http_port() : http_port), errors());
        return finish(load);
    }

    [[nodiscard]] std::filesystem::path errors() const { return place_.path() / "errors"; }

    [[nodiscard]] std::size_t sessions() const {
        return server_->get_json("/api/v1/sessions").at("sessions").as_array().size();
    }

    void start_server(std::uint16_t robot_port = 0, std::uint16_t http_port = 0) {
        server_.reset();
        server_ =
            std::make_unique<RunningServer>(place_.path() / "store", place_.path() / "log", robot_port, http_port);
    }

    TemporaryDirectory place_;
    std::unique_ptr<RunningServer> server_ =
        std::make_unique<RunningServer>(place_.path() / "store", place_.path() / "log");
};

Words operator+(Words words, const Words& further) {
    words.insert(words.end(), further.begin(), further.end());
    return words;
}

TEST_F(LoadProgram, StoresEveryScanOnceOverFailingLinks) {
    const auto outcome = run(kSmallLoad + Words{"--faults", "cut=1,half-open=2,stall=5"});
    EXPECT_EQ(outcome.code, 0) << outcome.errors;
    ASSERT_TRUE(outcome.report.is_object()) << outcome.errors;
    EXPECT_THAT(outcome.verdict(),
                StartsWith("nothing lost: 2,400 of 2,400 scans acknowledged, 2,400 in the 20 sessions"));
    EXPECT_EQ(outcome.count("scans", "acknowledged"), kSmallLoadScans);
    EXPECT_EQ(outcome.count("verdict", "scans_in_sessions"), kSmallLoadScans);
    EXPECT_EQ(outcome.count("verdict", "digests_equal"), 20U);
    EXPECT_EQ(outcome.count("ack_from_intended", "count"), kSmallLoadScans);
    EXPECT_GT(outcome.count("links", "reconnects"), 10U);
    EXPECT_GT(outcome.report.at("links").at("faults").at("cut").to_number<int>(), 10);
    EXPECT_GT(outcome.report.at("links").at("faults").at("half-open").to_number<int>(), 5);
    EXPECT_GT(outcome.report.at("links").at("faults").at("stall").to_number<int>(), 1);
    EXPECT_EQ(sessions(), 0U); // the tool deletes them
}

TEST_F(LoadProgram, RobotsGoOnAtTheServerThatHasTheirSession) {
    PostgresServer postgres;
    const auto database = postgres.new_database();
    const auto start = [&](const char* node) {
        return std::make_unique<RunningServer>(database, place_.path() / node, 0, 0,
                                               Words{"--allow-unreplicated", "--node", node});
    };
    server_ = start("a"); // the only one that the robots know
    const auto b = start("b");
    const auto known = [&] { return server_->get_json("/api/v1/nodes").at("nodes").as_array(); };
    while (known().size() < 2 || known().at(1).at("robots").as_string() != b->robot_address()) { // a second later
    }
    ChildProcess load(program("scanloom-load"), arguments(kSmallLoad + Words{"--verify", "counts"}, b->http_port()),
                      errors());
    const auto have_scans = [&] {
        const auto all = server_->get_json("/api/v1/sessions").at("sessions").as_array();
        return std::ranges::count_if(all, [](const auto& one) { return one.at("scans") != 0; }) == 20;
    };
    while (!have_scans()) {
    }
    server_->process().signal(SIGTERM);
    const auto outcome = finish(load);
    EXPECT_EQ(outcome.code, 0) << outcome.verdict();
    EXPECT_EQ(outcome.count("scans", "acknowledged"), kSmallLoadScans);
    EXPECT_GE(outcome.count("links", "reconnects"), 20U);
}

TEST_F(LoadProgram, UsesOneCertificateForBothPorts) {
    const auto server = testing_support::write_certificate(place_.path(), "127.0.0.1");
    const auto own = testing_support::write_certificate(place_.path(), "load.example");
    const auto& chain = server.certificate.native();
    server_.reset();
    server_ = std::make_unique<RunningServer>(place_.path() / "store", place_.path() / "log", 0, 0,
                                              Words{"--http-tls-cert", chain, "--http-tls-key", server.key.native(),
                                                    "--http-client-ca", own.certificate.native(), "--robot-tls-cert",
                                                    chain, "--robot-tls-key", server.key.native(), "--robot-client-ca",
                                                    own.certificate.native()});
    const auto load = [&](const Words& further) {
        std::filesystem::remove(errors());
        ChildProcess running(program("scanloom-load"),
                             kSmallLoad +
                                 Words{"--server", server_->robot_address(), "--http",
                                       "https://127.0.0.1:" + std::to_string(server_->http_port()), "--json", "-",
                                       "--tls-ca", chain, "--viewers", "3", "--tile-readers", "2"} +
                                 further,
                             errors());
        return finish(running);
    };
    const auto known = load({"--tls-cert", own.certificate.native(), "--tls-key", own.key.native()});
    EXPECT_EQ(known.code, 0) << known.errors;
    ASSERT_TRUE(known.report.is_object()) << known.errors;
    EXPECT_THAT(known.verdict(), StartsWith("nothing lost: 2,400 of 2,400 scans acknowledged"));
    EXPECT_EQ(known.report.at("audience").at("viewers_let_in").to_number<int>(), 3);
    const auto stranger = load({});
    EXPECT_EQ(stranger.code, 1);
    EXPECT_THAT(stranger.errors, HasSubstr("--tls-cert and --tls-key"));
}

TEST_F(LoadProgram, UsesOneTokenForBothPorts) {
    ChildProcess maker(program("scanloom-server"), {"token", "--name", "load", "--role", "operator"}, errors());
    const auto secret = maker.read_line().value();
    std::ofstream tokens(place_.path() / "tokens.toml");
    while (const auto line = maker.read_line()) tokens << *line << "\n";
    tokens.close();
    std::ofstream(place_.path() / "secret") << secret << "\n";
    std::filesystem::permissions(place_.path() / "tokens.toml", std::filesystem::perms::owner_read);
    server_.reset();
    server_ = std::make_unique<RunningServer>(place_.path() / "store", place_.path() / "log", 0, 0,
                                              Words{"--tokens", (place_.path() / "tokens.toml").string()});
    const Words onlookers{"--viewers", "2", "--tile-readers", "2"};
    const auto let_in = run(kSmallLoad + onlookers + Words{"--token-file", (place_.path() / "secret").string()});
    EXPECT_EQ(let_in.code, 0) << let_in.errors;
    ASSERT_TRUE(let_in.report.is_object()) << let_in.errors;
    EXPECT_EQ(let_in.count("verdict", "digests_equal"), 20U);
    EXPECT_EQ(let_in.count("audience", "viewers_let_in"), 2U);
    EXPECT_EQ(let_in.count("audience", "viewers_refused"), 0U);
    EXPECT_EQ(http_request(server_->http_port(), "GET", "/api/v1/sessions").status, 401U);
    EXPECT_EQ(run(kSmallLoad + onlookers).code, 1);
}

TEST_F(LoadProgram, AKilledServerLosesNoScan) {
    ChildProcess load(program("scanloom-load"), arguments(kSmallLoad, server_->http_port()), errors());
    while (server_->get("/api/v1/sessions/load-1-7").status != 200 ||
           server_->get_json("/api/v1/sessions/load-1-7").at("scans").to_number<int>() < 10) {
    }
    server_->process().signal(SIGKILL);
    server_->process().wait();
    start_server(server_->robot_port(), server_->http_port());
    const auto outcome = finish(load);
    EXPECT_EQ(outcome.code, 0) << outcome.errors;
    ASSERT_TRUE(outcome.report.is_object()) << outcome.errors;
    EXPECT_EQ(outcome.count("scans", "acknowledged"), kSmallLoadScans);
    EXPECT_EQ(outcome.count("links", "reconnects"), 20U);
    EXPECT_EQ(outcome.count("verdict", "digests_equal"), 20U);
    const auto& server = outcome.report.at("server").as_object();
    EXPECT_TRUE(server.contains("resident_bytes"));
    EXPECT_FALSE(server.contains("cpu_seconds")) << "the CPU time of two servers is unknown";
}

TEST_F(LoadProgram, SeveralRobotsShareASessionWithViewers) {
    const Words load{"--robots", "6",           "--sessions", "2",           "--rate",
                     "20",       "--duration",  "2",          "--cell-size", "0.2",
                     "--world",  "room",        "--viewers",  "3",           "--tile-readers",
                     "2",        "--tile-rate", "50",         "--keep",      "--threads",
                     "2",        "--batch",     "3"};
    const auto outcome = run(load);
    EXPECT_EQ(outcome.code, 0) << outcome.errors;
    ASSERT_TRUE(outcome.report.is_object()) << outcome.errors;
    EXPECT_THAT(outcome.verdict(), HasSubstr("digests cannot be compared, because robots share a session"));
    EXPECT_EQ(outcome.count("scans", "acknowledged"), 240U);
    EXPECT_EQ(outcome.count("scans", "frames"), 84U); // 13 frames of three scans and a last one for each robot
    EXPECT_GT(outcome.count("audience", "events"), 3U);
    EXPECT_EQ(outcome.count("audience", "viewers_let_in"), 3U);
    EXPECT_EQ(outcome.count("audience", "viewers_refused"), 0U);
    EXPECT_GT(outcome.count("audience", "tile_requests"), 10U);
    EXPECT_EQ(outcome.count("audience", "tiles_failed"), 0U);
    EXPECT_GT(outcome.report.at("server").at("cpu_seconds").to_number<double>(), 0.0);
    EXPECT_EQ(server_->get_json("/api/v1/sessions/load-1-1").at("scans").to_number<int>(), 120);

    const auto again = run(load);
    EXPECT_EQ(again.code, 1);
    EXPECT_THAT(again.errors, HasSubstr("2 sessions of an earlier run with --seed 1 are on the server, load-1-0 first; "
                                        "delete them with --replace, or use another --seed"));
    EXPECT_EQ(run(load + Words{"--replace"}).code, 0);
    EXPECT_EQ(sessions(), 2U);
}

TEST_F(LoadProgram, UnpacedSessionsAreComparedAtTheirOwnLengths) {
    const auto outcome = run({"--robots", "3", "--rate", "0", "--duration", "1", "--cell-size", "0.2", "--world",
                              "room", "--course", "50", "--threads", "2"});
    EXPECT_EQ(outcome.code, 0) << outcome.errors;
    ASSERT_TRUE(outcome.report.is_object()) << outcome.errors;
    EXPECT_EQ(outcome.count("verdict", "digests_equal"), 3U);
    EXPECT_GT(outcome.count("scans", "acknowledged"), 50U);
    EXPECT_EQ(outcome.count("scans", "due"), outcome.count("scans", "sent"));
}

const Words kShort{"--robots", "4", "--rate", "20", "--duration", "1", "--cell-size", "0.2", "--world", "room"};

/// The tool's output when one session differs from the expected one.
TEST_F(LoadProgram, WrongServerReportsAreDetected) {
    const auto through = [&](FalsifyingProxy::Lie lie) {
        const FalsifyingProxy front(server_->http_port(), std::move(lie));
        return run(kShort, front.port());
    };
    const auto honest = through([](const std::string&, std::string body) { return body; });
    EXPECT_EQ(honest.code, 0) << honest.errors;
    EXPECT_EQ(honest.count("verdict", "digests_equal"), 4U);

    const auto another_map = through([](const std::string& target, std::string body) {
        if (target != "/api/v1/sessions/load-1-2/digest") return body;
        const auto digit = body.find("\"himm\":\"") + 10;
        body[digit] = body[digit] == '0' ? '1' : '0';
        return body;
    });
    EXPECT_EQ(another_map.code, 1);
    EXPECT_THAT(another_map.verdict(),
                StartsWith("WRONG: 80 of 80 scans acknowledged, but the maps of session load-1-2 differ from those of "
                           "an undisturbed session with its 20 scans"));
    EXPECT_EQ(another_map.count("verdict", "digests_equal"), 3U);

    const auto one_less = through([](const std::string& target, std::string body) {
        if (target != "/api/v1/sessions/load-1-3") return body;
        return body.replace(body.find("\"scans\":20"), 10, "\"scans\":19");
    });
    EXPECT_EQ(one_less.code, 1);
    EXPECT_THAT(one_less.verdict(), HasSubstr("session load-1-3 has"));
    EXPECT_THAT(one_less.verdict(), HasSubstr("19 scans"));

    const auto gone = through([](const std::string& target, std::string body) {
        return target == "/api/v1/sessions/load-1-0" ? "{}" : body;
    });
    EXPECT_EQ(gone.code, 1);
    EXPECT_THAT(gone.verdict(), HasSubstr("/api/v1/sessions/load-1-0: the answer cannot be parsed"));
}

TEST_F(LoadProgram, AMissingServerIsReportedAndExitsWith1) {
    const Words nowhere{"--server", "127.0.0.1:1", "--http", "127.0.0.1:1", "--give-up-after", "0.5"};
    std::filesystem::remove(errors());
    ChildProcess load(program("scanloom-load"), nowhere + kShort, errors());
    const auto result = finish(load);
    EXPECT_EQ(result.code, 1);
    EXPECT_THAT(result.errors, HasSubstr("scanloom-load: 127.0.0.1:1 does not answer HTTP"));

    ChildProcess unasked(program("scanloom-load"), nowhere + kShort + Words{"--verify", "none", "--json", "-"},
                         errors());
    const auto outcome = finish(unasked);
    EXPECT_EQ(outcome.code, 1);
    ASSERT_TRUE(outcome.report.is_object());
    EXPECT_THAT(outcome.verdict(), HasSubstr("cannot connect to 127.0.0.1:1: Connection refused"));
}

TEST_F(LoadProgram, AServerThatClosesSilentlyGivesAHintOnTls) {
    const ClosingServer server;
    ChildProcess load(program("scanloom-load"),
                      kShort + Words{"--server", "127.0.0.1:" + std::to_string(server.port()), "--give-up-after", "0.5",
                                     "--verify", "none", "--json", "-"},
                      errors());
    const auto outcome = finish(load);
    EXPECT_EQ(outcome.code, 1);
    ASSERT_TRUE(outcome.report.is_object());
    EXPECT_THAT(outcome.verdict(), HasSubstr("before the server said a word; it may want TLS (--tls)"));
}

TEST_F(LoadProgram, AnUnwritableReportIsRefusedBeforeTheRun) {
    ChildProcess load(program("scanloom-load"),
                      kShort + Words{"--server", "127.0.0.1:1", "--http", "127.0.0.1:1", "--json", "/proc/nowhere/x"},
                      errors());
    const auto outcome = finish(load);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.errors, StartsWith("scanloom-load: --json: /proc/nowhere/x.part cannot be written: "));
}

TEST_F(LoadProgram, AnInterruptedRunVerifiesItsSentScans) {
    ChildProcess load(program("scanloom-load"),
                      arguments({"--robots", "3", "--duration", "100000", "--cell-size", "0.2", "--course", "10"},
                                server_->http_port()),
                      errors());
    while (server_->get("/api/v1/sessions/load-1-2").status != 200 ||
           server_->get_json("/api/v1/sessions/load-1-2").at("scans").to_number<int>() < 5) {
    }
    load.signal(SIGINT);
    const auto outcome = finish(load);
    EXPECT_EQ(outcome.code, 0) << outcome.errors;
    ASSERT_TRUE(outcome.report.is_object()) << outcome.errors;
    EXPECT_THAT(outcome.verdict(), StartsWith("nothing lost: "));
    EXPECT_EQ(outcome.count("verdict", "digests_equal"), 3U);
    EXPECT_EQ(sessions(), 0U);
}

TEST_F(LoadProgram, AnEarlyInterruptReportsNoLoss) {
    const Words slow{"--robots", "8", "--rate", "0.01", "--duration", "100000", "--cell-size", "0.2", "--course", "10"};
    ChildProcess load(program("scanloom-load"), arguments(slow, server_->http_port()), errors());
    while (server_->get("/api/v1/sessions/load-1-0").status != 200 ||
           server_->get_json("/api/v1/sessions/load-1-0").at("scans").to_number<int>() < 1) {
    }
    load.signal(SIGINT);
    const auto outcome = finish(load);
    EXPECT_EQ(outcome.code, 0) << outcome.errors;
    ASSERT_TRUE(outcome.report.is_object()) << outcome.errors;
    EXPECT_THAT(outcome.verdict(), StartsWith("nothing lost: "));
    EXPECT_GE(outcome.count("verdict", "digests_equal"), 1U);
    EXPECT_LT(outcome.count("verdict", "digests_equal"), 8U)
        << "the interrupt must come before each robot has sent a scan";
}

} // namespace
} // namespace scanloom::test
