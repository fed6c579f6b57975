#include "server/store/rocksdb_store.hpp"
#include "server/store/scan_log.hpp"
#include "tests/support/log_reading.hpp"
#include "tests/support/temporary_directory.hpp"

#include <benchmark/benchmark.h>

#include <random>
#include <semaphore>

/// The scan log with entries of 2 KB, about a scan of 700 beams, in the system's temporary directory:
/// set TMPDIR to measure another disk.
namespace scanloom::store {
namespace {

constexpr std::size_t kEntryBytes = 2048;

/// Returns bytes that compress about as poorly as ranges do.
std::string noisy_entry() {
    std::mt19937 random(3);
    std::string entry(kEntryBytes, '\0');
    for (char& byte : entry) byte = static_cast<char>(random() % 64);
    return entry;
}

/// Sessions with one append in progress each. The next append follows the acknowledgement, as with a robot that has
/// little credit. Arguments: number of sessions, entries per append.
void append(benchmark::State& state) {
    const auto sessions = static_cast<std::size_t>(state.range(0));
    const auto entries = static_cast<std::size_t>(state.range(1));
    TemporaryDirectory directory;
    const auto log = open_rocksdb(directory.path()).value();
    const std::vector<std::string> batch(entries, noisy_entry());
    std::vector<SessionId> ids;
    for (std::size_t i = 0; i < sessions; ++i) ids.push_back(log->create_session("bench").value());
    Revision next = 1;
    for (auto _ : state) {
        std::counting_semaphore<> acknowledged(0);
        for (const SessionId id : ids) log->append(id, next, batch, [&](Result<>) { acknowledged.release(); });
        for (std::size_t i = 0; i < sessions; ++i) acknowledged.acquire();
        next += entries;
    }
    state.SetItemsProcessed(state.iterations() * state.range(0) * state.range(1));
    state.SetBytesProcessed(state.items_processed() * static_cast<std::int64_t>(kEntryBytes));
    state.counters["fsyncs"] =
        benchmark::Counter(static_cast<double>(log->stats().synced_writes), benchmark::Counter::kIsRate);
}
BENCHMARK(append)->Args({1, 1})->Args({1, 100})->Args({64, 1})->Args({64, 10})->UseRealTime();

/// Opens the store and reads a session from its first entry, as a start without a checkpoint does.
void recover(benchmark::State& state) {
    constexpr Revision kEntries = 50'000;
    TemporaryDirectory directory;
    SessionId session = 0;
    {
        const auto log = open_rocksdb(directory.path()).value();
        session = log->create_session("bench").value();
        const std::vector<std::string> batch(500, noisy_entry());
        for (Revision first = 1; first < kEntries; first += 500) append_and_wait(*log, session, first, batch).value();
    }
    for (auto _ : state) {
        const auto log = open_rocksdb(directory.path()).value();
        std::size_t bytes = 0;
        log->read(session, 0,
                  [&](Revision, std::string_view entry) -> Result<> {
                      bytes += entry.size();
                      return {};
                  })
            .value();
        benchmark::DoNotOptimize(bytes);
    }
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kEntries));
    state.SetBytesProcessed(state.items_processed() * static_cast<std::int64_t>(kEntryBytes));
}
BENCHMARK(recover)->Unit(benchmark::kMillisecond)->UseRealTime();

} // namespace
} // namespace scanloom::store
