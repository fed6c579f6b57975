// Writes to a store until it is killed, and prints each acknowledgement to standard output, one line each:
//   "a SESSION REVISION"  the session's log is durable up to this revision
//   "c SESSION REVISION"  a checkpoint that covers this revision was written
//   "n SESSION"           a session was created
//   "r SESSION"           a session was removed
// Usage: crashing_writer DIRECTORY SEED
#include "server/store/rocksdb_store.hpp"
#include "server/store/scan_log.hpp"
#include "tests/support/log_reading.hpp"

#include <cstdio>
#include <cstdlib>
#include <random>
#include <semaphore>
#include <string>

#include <unistd.h>

namespace {

using namespace scanloom;
using namespace scanloom::store;

constexpr std::size_t kSessions = 3;

/// Uses one write(2), so that a line is in the pipe as a whole or not at all.
void say(const std::string& line) {
    if (::write(STDOUT_FILENO, line.data(), line.size()) < 0) std::exit(0); // the reader has ended
}

void say(char what, SessionId session, Revision revision) {
    say(std::string(1, what) + " " + std::to_string(session) + " " + std::to_string(revision) + "\n");
}

/// Removes a session while its own appends are in progress.
void come_and_go(ScanLog& log) {
    const auto session = log.create_session("short-lived").value();
    say("n " + std::to_string(session) + "\n");
    log.append(session, 1, distinct_entries(session, 1, 5), [](Result<>) {});
    log.remove_session(session).value();
    say("r " + std::to_string(session) + "\n");
}

void write_forever(ScanLog& log, std::mt19937& random) {
    std::counting_semaphore<> credit(64); // for unacknowledged appends
    std::map<SessionId, Revision> ends;
    for (const auto& stored : log.sessions().value()) {
        if (stored.record != "lasting") continue;
        ends[stored.id] = entries_after(log, stored.id, 0).value().size();
    }
    while (ends.size() < kSessions) {
        const auto created = log.create_session("lasting").value();
        say("n " + std::to_string(created) + "\n");
        ends[created] = 0;
    }
    for (int step = 1;; ++step) {
        for (auto& [session, end] : ends) {
            const Revision first = end + 1;
            end += 1 + random() % 8;
            credit.acquire();
            log.append(session, first, distinct_entries(session, first, end - first + 1),
                       [&credit, session = session, last = end](Result<> result) {
                           if (result) say('a', session, last);
                           credit.release();
                       });
            if (random() % 20 != 0) continue;
            log.write_checkpoint(session,
                                 {{"revision", std::to_string(end)}, {"map", std::string(random() % 9999, 'm')}})
                .value();
            say('c', session, end);
        }
        if (step % 40 == 0) come_and_go(log);
    }
}

} // namespace

int main(int argc, char** argv) {
    if (argc != 3) return 2;
    std::mt19937 random(static_cast<unsigned>(std::atoi(argv[2])));
    StoreOptions options;
    options.memory_bytes = 1 << 20; // causes frequent table writes and compactions
    const auto log = open_rocksdb(argv[1], options);
    if (!log) {
        std::fprintf(stderr, "%s\n", log.error().message.c_str());
        return 1;
    }
    write_forever(**log, random);
}
