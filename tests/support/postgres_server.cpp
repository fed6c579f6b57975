#include "tests/support/postgres_server.hpp"

#include "server/store/postgres_connection.hpp"

#include <fmt/format.h>

#include <pwd.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
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

/// Runs a program of PostgreSQL to its end.
void run(const fs::path& directory, const std::string& program, std::vector<std::string> arguments) {
    ChildProcess process("/bin/sh", arguments_of(program, std::move(arguments)), directory / "log");
    std::string said;
    while (const auto line = process.read_line()) said += *line + '\n';
    if (process.wait() != 0) throw std::runtime_error(program + ": " + said);
}

/// Lets the user `postgres` write to a directory, if this process is root.
void give_away(const fs::path& directory) {
    if (::geteuid() != 0) return;
    const auto* owner = ::getpwnam("postgres");
    if (owner == nullptr || ::chown(directory.c_str(), owner->pw_uid, owner->pw_gid) != 0) {
        throw std::runtime_error("there is no user postgres; run ./scanloom install test");
    }
}

} // namespace

PostgresServer::PostgresServer() {
    give_away(directory_.path());
    run(directory_.path(), "initdb",
        {"-D", directory_.path() / "data", "-U", "scanloom", "-A", "trust", "-E", "UTF8", "--locale", "C", "--no-sync",
         "--no-instructions"});
    start();
}

PostgresServer::PostgresServer(const PostgresServer& primary) {
    give_away(directory_.path());
    run(directory_.path(), "pg_basebackup",
        {"-D", directory_.path() / "data", "-h", primary.socket(), "-U", "scanloom", "-R", "-c", "fast", "--no-sync"});
    start();
}

void PostgresServer::start() {
    for (std::string said = try_to_start(); !said.empty(); said = try_to_start()) {
        const bool still_ends = said.find("pre-existing shared memory block") != std::string::npos; // after kill()
        if (!still_ends) throw std::runtime_error("postgres: " + said);
    }
}

/// @return what it said if it has ended instead
std::string PostgresServer::try_to_start() {
    const auto& place = directory_.path();
    process_.emplace(
        "/bin/sh",
        arguments_of("postgres", {"-D", place / "data", "-k", place, "-h", "", "-c", "fsync=off", "-c",
                                  "shared_buffers=16MB", "-c", "log_min_messages=log", "-c", "log_checkpoints=off",
                                  "-c", "cluster_name=standby"}), // which a standby calls itself
        place / "log");
    std::string said;
    while (const auto line = process_->read_line()) {
        said += *line + '\n';
        if (line->find("ready to accept") != std::string::npos) return {};
    }
    return said;
}

void PostgresServer::promote() {
    run(directory_.path(), "pg_ctl", {"promote", "-w", "-D", directory_.path() / "data"});
}

void PostgresServer::kill() {
    process_->signal(SIGKILL);
    process_->wait();
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
