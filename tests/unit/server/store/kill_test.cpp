#include "server/store/rocksdb_store.hpp"
#include "server/store/scan_log.hpp"

#include "tests/support/log_reading.hpp"
#include "tests/support/temporary_directory.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <map>
#include <random>
#include <set>
#include <sstream>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

/// Kills (-9) writers of the same store at random points.
namespace scanloom::store {
namespace {

/// Everything the killed writers reported, over all rounds.
struct Reported {
    std::map<SessionId, Revision> acknowledged;
    std::map<SessionId, Revision> checkpointed;
    std::set<SessionId> created;
    std::set<SessionId> removed;

    void add(const std::string& line) {
        std::istringstream words(line);
        char what = 0;
        SessionId session = 0;
        Revision revision = 0;
        words >> what >> session >> revision;
        if (what == 'a') acknowledged[session] = revision;
        if (what == 'c') checkpointed[session] = revision;
        if (what == 'r') removed.insert(session);
        if (what == 'n') {
            EXPECT_TRUE(created.empty() || session > *created.rbegin())
                << "session " << session << " was created twice";
            created.insert(session);
        }
    }
};

/// Starts a writer, kills it after `lines` lines of output, and adds all its output to `reported`.
void write_and_kill(const std::filesystem::path& directory, unsigned seed, std::size_t lines, Reported& reported) {
    int pipe[2];
    ASSERT_EQ(::pipe2(pipe, O_CLOEXEC), 0);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, pipe[1], STDOUT_FILENO);
    std::string arguments[] = {SCANLOOM_CRASHING_WRITER, directory.native(), std::to_string(seed)};
    char* argv[] = {arguments[0].data(), arguments[1].data(), arguments[2].data(), nullptr};
    pid_t child = 0;
    const int spawned = ::posix_spawn(&child, argv[0], &actions, nullptr, argv, environ);
    posix_spawn_file_actions_destroy(&actions);
    ::close(pipe[1]);
    std::FILE* output = ::fdopen(pipe[0], "r");
    ASSERT_EQ(spawned, 0);

    char line[100];
    for (std::size_t count = 0; std::fgets(line, sizeof line, output) != nullptr; ++count) {
        reported.add(line);
        if (count == lines) ::kill(child, SIGKILL);
    }
    std::fclose(output);
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFSIGNALED(status)) << "the writer ended by itself";
}

void expect_recovered(ScanLog& log, const Reported& reported) {
    std::map<SessionId, Revision> lasting;
    for (const auto& stored : log.sessions().value()) {
        EXPECT_FALSE(reported.removed.contains(stored.id)) << "session " << stored.id << " was removed";
        const auto entries = entries_after(log, stored.id, 0).value();
        EXPECT_EQ(entries, distinct_entries(stored.id, 1, entries.size())) << "session " << stored.id;
        lasting[stored.id] = entries.size();
        const auto checkpoint = checkpoint_of(log, stored.id).value();
        if (checkpoint.empty()) continue;
        EXPECT_LE(std::stoull(checkpoint.at("revision")), entries.size()) << "a checkpoint ahead of its log";
        const auto written = reported.checkpointed.find(stored.id);
        if (written == reported.checkpointed.end()) continue;
        EXPECT_GE(std::stoull(checkpoint.at("revision")), written->second);
    }
    for (const auto& [session, revision] : reported.acknowledged) {
        ASSERT_TRUE(lasting.contains(session)) << "session " << session << " was lost";
        EXPECT_GE(lasting[session], revision) << "acknowledged entries of session " << session << " were lost";
    }
}

TEST(Kill, NothingAcknowledgedIsLostWhereverTheWriterIsKilled) {
    constexpr unsigned kRounds = 20;
    TemporaryDirectory temporary;
    std::mt19937 random(12);
    Reported reported;
    for (unsigned round = 0; round < kRounds; ++round) {
        SCOPED_TRACE("round " + std::to_string(round));
        write_and_kill(temporary.path(), round, random() % 300, reported);
        if (testing::Test::HasFailure()) return;
        const auto log = open_rocksdb(temporary.path());
        ASSERT_TRUE(log) << log.error().message;
        expect_recovered(**log, reported);
        if (testing::Test::HasFailure()) return;
    }
    EXPECT_FALSE(reported.acknowledged.empty() || reported.checkpointed.empty() || reported.removed.empty());
}

} // namespace
} // namespace scanloom::store
