#include "tests/support/postgres_server.hpp"

#include <fmt/format.h>

#include <poll.h>
#include <pwd.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <utility>
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

std::string address_of(const std::string& socket, const std::string& database) {
    return fmt::format("postgresql://scanloom@/{}?host={}", database, socket);
}

/// Returns the processes that a process has started, and that still run.
std::vector<pid_t> children_of(pid_t parent) {
    std::vector<pid_t> children;
    std::ifstream list(fmt::format("/proc/{0}/task/{0}/children", parent));
    for (pid_t child = 0; list >> child;) children.push_back(child);
    return children;
}

/// Lets the user `postgres` write to a directory or a file, if this process is root.
void give_away(const fs::path& directory) {
    if (::geteuid() != 0) return;
    const auto* owner = ::getpwnam("postgres");
    if (owner == nullptr || ::chown(directory.c_str(), owner->pw_uid, owner->pw_gid) != 0) {
        throw std::runtime_error("there is no user postgres; run ./scanloom install test");
    }
}

/// Kills a process that this one has not started itself. @param process  need not run any more
void kill_and_wait(pid_t process) {
    const int handle = static_cast<int>(::syscall(SYS_pidfd_open, process, 0));
    if (handle < 0) return;
    ::kill(process, SIGKILL);
    pollfd ended{handle, POLLIN, 0};
    ::poll(&ended, 1, -1);
    ::close(handle);
}

/// Returns where the directory of an empty server is kept for other tests: initdb takes half a second.
fs::path made_before() {
    const auto version = programs().parent_path().filename();
    return fs::read_symlink("/proc/self/exe").parent_path() / ("postgres-" + version.string());
}

/// Keeps a copy of a directory, unless another program was faster.
void keep(const fs::path& directory, const fs::path& copy) {
    const fs::path unfinished = fmt::format("{}-{}", copy.string(), ::getpid());
    fs::copy(directory, unfinished, fs::copy_options::recursive);
    std::error_code exists;
    fs::rename(unfinished, copy, exists);
    if (exists) fs::remove_all(unfinished);
}

/// Creates a directory that only PostgreSQL's user may read.
void make_directory(const fs::path& directory) {
    fs::create_directory(directory);
    fs::permissions(directory, fs::perms::owner_all);
    give_away(directory);
}

/// Connects to the database that each server has.
store::postgres::Connection connect_to(const PostgresServer& server) {
    return connect(address_of(server.socket(), "postgres"));
}

} // namespace

store::postgres::Connection connect(const std::string& address) {
    constexpr int kTries = 10;
    const auto place = store::postgres::parse_place(address).value();
    auto connection = store::postgres::Connection::open(place);
    for (int tries = 1; !connection && tries < kTries; ++tries) connection = store::postgres::Connection::open(place);
    return std::move(connection).value();
}

/// Returns where directories are made: in memory, if there is room, because PostgreSQL creates a thousand files.
fs::path PostgresServer::place() {
    constexpr std::uintmax_t kRoom = std::uintmax_t{4} << 30;
    const fs::path memory = "/dev/shm";
    std::error_code none;
    const auto space = fs::space(memory, none);
    return !none && space.available > kRoom ? memory : fs::temp_directory_path();
}

PostgresServer::PostgresServer() : data_(directory_.path() / "data") { create(); }

PostgresServer::PostgresServer(const fs::path& data) : data_(data), is_synced_(true) { create(); }

PostgresServer::PostgresServer(const PostgresServer& primary, const fs::path& data)
    : data_(data.empty() ? directory_.path() / "data" : data), is_synced_(!data.empty()) {
    give_away(directory_.path());
    stand_by(primary);
}

void PostgresServer::create() {
    give_away(directory_.path());
    make_directory(data_);
    if (const auto made = made_before(); fs::exists(made)) {
        fs::copy(made, data_, fs::copy_options::recursive);
        for (const auto& entry : fs::recursive_directory_iterator(data_)) give_away(entry);
    } else {
        run(directory_.path(), "initdb",
            {"-D", data_, "-U", "scanloom", "-A", "trust", "-E", "UTF8", "--locale", "C", "--no-sync",
             "--no-instructions"});
        const auto rules = data_ / "pg_hba.conf"; // the first that fits decides
        std::ifstream file(rules);
        const std::string others{std::istreambuf_iterator<char>(file), {}};
        std::ofstream(rules) << "local all locked scram-sha-256\n" << others;
        keep(data_, made);
    }
    start();
    // Only start() reads the log. The server would wait when the pipe is full.
    connect_to(*this).run("ALTER ROLE scanloom SET log_min_messages = panic").value();
}

void PostgresServer::stand_by(const PostgresServer& primary) {
    fs::remove_all(data_);
    make_directory(data_);
    std::vector<std::string> how{"-D", data_, "-h", primary.socket(), "-U", "scanloom", "-R", "-c", "fast"};
    if (!is_synced_) how.emplace_back("--no-sync");
    run(directory_.path(), "pg_basebackup", how);
    start();
    auto connection = connect_to(primary);
    connection.run("ALTER SYSTEM SET synchronous_standby_names = 'standby'").value();
    connection.run("SELECT pg_reload_conf()").value();
    while (connection.run("SELECT FROM pg_stat_replication WHERE sync_state = 'sync'").value().size() == 0) {
    }
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
    process_.emplace("/bin/sh",
                     arguments_of("postgres", {"-D", data_,
                                               "-k", place,
                                               "-h", "",
                                               "-c", is_synced_ ? "fsync=on" : "fsync=off",
                                               "-c", "shared_buffers=16MB",
                                               "-c", "dynamic_shared_memory_type=mmap",
                                               "-c", "wal_retrieve_retry_interval=100ms",
                                               "-c", "log_min_messages=log",
                                               "-c", "log_checkpoints=off",
                                               "-c", "cluster_name=standby"}), // which a standby calls itself
                     place / "log");
    std::string said;
    while (const auto line = process_->read_line()) {
        said += *line + '\n';
        if (line->find("ready to accept") != std::string::npos) return {};
    }
    return said;
}

void PostgresServer::promote() { run(directory_.path(), "pg_ctl", {"promote", "-w", "-D", data_}); }

void PostgresServer::pause() {
    process_->signal(SIGSTOP); // it starts no others then
    for (const pid_t child : children_of(process_->id())) ::kill(child, SIGSTOP);
}

void PostgresServer::resume() {
    for (const pid_t child : children_of(process_->id())) ::kill(child, SIGCONT);
    process_->signal(SIGCONT);
}

void PostgresServer::kill() {
    const auto children = children_of(process_->id());
    process_->signal(SIGKILL);
    process_->wait();
    for (const pid_t child : children) kill_and_wait(child);
}

std::string PostgresServer::new_database() {
    const auto name = fmt::format("db{}", ++databases_);
    auto connection = connect_to(*this);
    connection.run(fmt::format("CREATE DATABASE {}", name).c_str(), {}, store::postgres::Connection::kLongTimeout)
        .value();
    return address_of(socket(), name);
}

} // namespace scanloom::test
