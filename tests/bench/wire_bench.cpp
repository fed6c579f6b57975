#include "common/wire/frame_checksum.hpp"
#include "common/wire/frame_decoder.hpp"
#include "common/wire/messages.hpp"

#include <benchmark/benchmark.h>

namespace scanloom::wire {
namespace {

ScanBatch batch_of(std::size_t scans, std::size_t beams) {
    ScanBatch batch;
    batch.scans.resize(scans);
    for (std::size_t i = 0; i < scans; ++i) {
        batch.scans[i].seq = i + 1;
        for (std::size_t beam = 0; beam < beams; ++beam) {
            batch.scans[i].ranges.push_back(static_cast<RangeMm>(1000 + 37 * beam % 20'000));
        }
    }
    return batch;
}

/// From a received frame to validated scans; items are scans.
void DecodeScanBatch(benchmark::State& state) {
    constexpr std::size_t kScans = 64;
    std::string frame;
    encode(batch_of(kScans, static_cast<std::size_t>(state.range(0))), frame);
    const auto body = std::string_view(frame).substr(kLengthPrefixBytes);
    for (auto _ : state) benchmark::DoNotOptimize(decode(body));
    state.SetItemsProcessed(static_cast<std::int64_t>(kScans) * state.iterations());
    state.SetBytesProcessed(static_cast<std::int64_t>(frame.size()) * state.iterations());
}
BENCHMARK(DecodeScanBatch)->Arg(180)->Arg(1080)->Arg(4000);

/// The additional cost of the checksum, for receiving and sending.
void CheckScanBatch(benchmark::State& state) {
    constexpr std::size_t kScans = 64;
    std::string frame;
    encode(batch_of(kScans, static_cast<std::size_t>(state.range(0))), frame);
    const auto body = std::string_view(frame).substr(kLengthPrefixBytes);
    for (auto _ : state) benchmark::DoNotOptimize(checksum_of(body));
    state.SetItemsProcessed(static_cast<std::int64_t>(kScans) * state.iterations());
    state.SetBytesProcessed(static_cast<std::int64_t>(frame.size()) * state.iterations());
}
BENCHMARK(CheckScanBatch)->Arg(180)->Arg(684)->Arg(1080)->Arg(4000);

} // namespace
} // namespace scanloom::wire
