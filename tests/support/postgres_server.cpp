#include "tests/support/postgres_server.hpp"

#include "server/store/postgres_connection.hpp"

#include <fmt/format.h>

#include <pwd.h>
#include <unistd.h>

#include <algorithm>
#include <stdexcept>
#include <vector>

namespace scanloom::test {
namespace {

namespace fs = std::filesystem;

/// Returns the directory with the programs of the newest version.
fs::path programs() {
    std::vector<fs::path> found;
    std::error_code none;
    for (const auto& version : fs::directory_iterator("/usr/lib/postgresql", none)) {
        if (fs::exists(version.path() / "bin/postgres")) found.push_back(version.path() / "bin");
    }
    if (found.empty()) throw std::runtime_error("PostgreSQL is not installed; run ./scanloom install test");
    return *std::ranges::max_element(found);
}

/// Returns the arguments of /bin/sh that replace it by a program of PostgreSQL, which ends with this process.
std::vector<std::string> arguments_of(const std::string& program, std::vector<std::string> arguments) {
    std::string command = "exec setpriv --pdeathsig QUIT ";
    if (::geteuid() == 0) command += "--reuid postgres --regid postgres --clear-groups ";
    std::vector<std::string> all{"-c", command + "\"$@\" 2>&1", "sh", (programs() / program).native()};
    all.insert(all.end(), arguments.begin(), arguments.end());
    return all;
}

} // namespace

PostgresServer::PostgresServer() {
    const auto& place = directory_.path();
    if (::geteuid() == 0) {
        const auto* owner = ::getpwnam("postgres");
        if (owner == nullptr || ::chown(place.c_str(), owner->pw_uid, owner->pw_gid) != 0) {
            throw std::runtime_error("there is no user postgres; run ./scanloom install test");
        }
    }
    const auto data = (place / "data").native();
    ChildProcess made("/bin/sh",
                      arguments_of("initdb", {"-D", data, "-U", "scanloom", "-A", "trust", "-E", "UTF8", "--locale",
                                              "C", "--no-sync", "--no-instructions"}),
                      place / "log");
    std::string said;
    while (const auto line = made.read_line()) said += *line + '\n';
    if (made.wait() != 0) throw std::runtime_error("initdb: " + said);
    process_.emplace(
        "/bin/sh",
        arguments_of("postgres", {"-D", data, "-k", place.native(), "-h", "", "-c", "fsync=off", "-c",
                                  "shared_buffers=16MB", "-c", "log_min_messages=log", "-c", "log_checkpoints=off"}),
        place / "log");
    said.clear();
    while (const auto line = process_->read_line()) {
        said += *line + '\n';
        if (line->find("ready to accept connections") != std::string::npos) return;
    }
    throw std::runtime_error("postgres: " + said);
}

std::string PostgresServer::new_database() {
    const auto address = [&](const std::string& name) {
        return fmt::format("postgresql://scanloom@/{}?host={}", name, directory_.path().native());
    };
    const auto name = fmt::format("db{}", ++databases_);
    auto connection =
        store::postgres::Connection::open(store::postgres::parse_place(address("postgres")).value()).value();
    connection.run(fmt::format("CREATE DATABASE {}", name).c_str(), {}, store::postgres::Connection::kLongTimeout)
        .value();
    return address(name);
}

} // namespace scanloom::test
