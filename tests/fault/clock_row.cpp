#include "tests/fault/clock_row.hpp"

#include "tests/fault/cases.hpp"
#include "tests/fault/server_process.hpp"
#include "tests/fault/verification.hpp"
#include "tests/support/robot_socket.hpp"
#include "tests/support/running_server.hpp"
#include "tests/support/temporary_directory.hpp"

#include <boost/json/parse.hpp>
#include <boost/json/serialize.hpp>
#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

namespace scanloom::fault {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kScansPerJump = 400;
constexpr std::uint64_t kJumpsPerStore = 10;
constexpr std::uint64_t kMicrosUntilJump = 20'000;

/// Debian's library for programs with several threads.
std::optional<fs::path> faketime_library() {
    for (const auto& folder : fs::directory_iterator("/usr/lib")) {
        const auto library = folder.path() / "faketime" / "libfaketimeMT.so.1";
        std::error_code ignored;
        if (fs::exists(library, ignored)) return library;
    }
    return std::nullopt;
}

/// The wall clock of a program under test, which jumps on request. The program's other clocks stay correct.
class JumpingClock {
public:
    JumpingClock(const fs::path& library, fs::path file) : file_(std::move(file)) {
        words_ = {"LD_PRELOAD=" + library.string(), "FAKETIME_TIMESTAMP_FILE=" + file_.string(), "FAKETIME_NO_CACHE=1",
                  "FAKETIME_DONT_FAKE_MONOTONIC=1", "DONT_FAKE_MONOTONIC=1"};
        jump_to("+0d");
    }

    /// Sets the offset from the true time in days.
    void jump_to(const std::string& days) const {
        const fs::path new_file = file_.string() + ".new";
        std::ofstream(new_file) << days << '\n';
        fs::rename(new_file, file_); // so that a partly written file is never read
    }

    /// Returns `env` and its arguments, to precede a program.
    [[nodiscard]] const std::vector<std::string>& words() const noexcept { return words_; }

private:
    fs::path file_;
    std::vector<std::string> words_;
};

/// A robot program that sends the scans of a simulated drive up to this number.
std::vector<std::string> robot_words(std::uint16_t port, std::uint64_t seed, std::uint64_t scans) {
    return {test::program("scanloom-robot").string(),
            "--server",
            fmt::format("127.0.0.1:{}", port),
            "--session",
            "s",
            "--robot",
            "r",
            "--cell-size",
            "0.1",
            "simulate",
            "--world",
            "office",
            "--drive",
            "wall_follower",
            "--seed",
            std::to_string(seed),
            "--speed",
            "0",
            "--scans",
            std::to_string(scans)};
}

/// Starts a robot with environment variables.
test::ChildProcess start_robot(std::vector<std::string> variables, const std::vector<std::string>& robot,
                               const fs::path& log) {
    variables.insert(variables.end(), robot.begin(), robot.end());
    return {"/usr/bin/env", variables, log};
}

/// Waits until a robot that should send scans up to this number has ended.
void finish(test::ChildProcess& robot, std::uint64_t scans, Outcome& outcome) {
    const auto summary = robot.read_line();
    const int code = robot.wait();
    const auto acknowledged =
        summary ? boost::json::parse(*summary).at("acknowledged").to_number<std::uint64_t>() : std::uint64_t{0};
    if (code == 0 && acknowledged == scans) return;
    outcome.failures.push_back(
        fmt::format("the robot ended with {} and {} of {} scans acknowledged", code, acknowledged, scans));
}

/// Returns a digest of all layers. Excludes the revision, as the log also contains visitors.
std::string digest(const ServerProcess& server) {
    const auto answer = test::http_request(server.http_port(), "GET", "/api/v1/sessions/s/digest");
    return boost::json::serialize(boost::json::parse(answer.body).at("layers"));
}

std::string digest_without_jumps(std::uint64_t seed, std::uint64_t scans) {
    const TemporaryDirectory place;
    ServerProcess server({}, place.path());
    server.start_and_wait();
    Outcome outcome;
    auto robot = start_robot({}, robot_words(server.robot_port(), seed, scans), place.path() / "robot");
    finish(robot, scans, outcome);
    if (!outcome.passed()) throw std::runtime_error("without any jump, " + outcome.failures.front());
    return digest(server);
}

/// A client that has connected and sends nothing while the clock jumps must not exceed its deadline.
void say_hello_after(const JumpingClock& clock, const std::string& days, const ServerProcess& server,
                     Outcome& outcome) {
    testing_support::RobotSocket visitor(server.robot_port());
    clock.jump_to(days);
    visitor.send(wire::Hello{.robot = "visitor", .session = "s"});
    try {
        (void)visitor.receive_kind<wire::Welcome>();
    } catch (const std::exception& failure) {
        outcome.failures.push_back(
            fmt::format("a hello after a jump by {} days was refused: {}", days, failure.what()));
    }
}

Outcome jump_clock(const Run& run, const fs::path& library, std::uint64_t seed, std::uint64_t jumps) {
    const TemporaryDirectory place;
    std::mt19937_64 random(seed);
    const JumpingClock clock(library, place.path() / "clock");
    const JumpingClock robot_clock(library, place.path() / "robot_clock");
    Command command{"/usr/bin/env", clock.words()};
    command.words.push_back(run.server.program.empty() ? test::program("scanloom-server").string()
                                                       : run.server.program.string());
    command.words.insert(command.words.end(), run.server.words.begin(), run.server.words.end());
    ServerProcess server(command, place.path());
    server.start_and_wait();
    Outcome outcome;
    std::uint64_t sent = 0;
    for (std::uint64_t jump = 1; jump <= jumps && outcome.passed(); ++jump) {
        const std::uint64_t scans = jump * kScansPerJump;
        const auto one_of_the_years = [&] { return std::string(random() % 2 == 0 ? "+365d" : "-365d"); };
        auto robot =
            start_robot(robot_clock.words(), robot_words(server.robot_port(), seed, scans), place.path() / "robot");
        server.let_be(std::chrono::microseconds(random() % kMicrosUntilJump));
        clock.jump_to(one_of_the_years());
        server.let_be(std::chrono::microseconds(random() % kMicrosUntilJump));
        robot_clock.jump_to(one_of_the_years()); // takes effect at the robot's next start
        finish(robot, scans, outcome);
        say_hello_after(clock, "+0d", server, outcome);
        sent = scans;
    }
    outcome.add(verify_numbers(ask_for(server.http_port(), "s").log, "r", sent));
    outcome.digest_equal = digest(server) == digest_without_jumps(seed, sent);
    if (const int code = server.stop(); code != 0)
        outcome.failures.push_back(fmt::format("the server exited with {}", code));
    return outcome;
}

} // namespace

Outcome run_clock_row(const Run& run) {
    const auto library = faketime_library();
    if (!library) return {.skipped = "faketime is not installed: apt-get install faketime"};
    return run_cases(run,
                     {.row = "clock", .of_count = kJumpsPerStore, .run = [&](std::uint64_t seed, std::uint64_t jumps) {
                          return jump_clock(run, *library, seed, jumps);
                      }});
}

} // namespace scanloom::fault
