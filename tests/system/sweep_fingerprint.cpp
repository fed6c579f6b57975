#include "core/mapping/chunk_kernels.hpp"
#include "core/mapping/sweep/sweep.hpp"

#include <cstdint>
#include <cstdio>
#include <map>
#include <numbers>
#include <random>
#include <vector>

// Prints a checksum of the kernels' results for random scans, equal on every machine. other_processors.sh compares it.

namespace scanloom::mapping {
namespace {

/// FNV-1a, 64 bits.
struct Fingerprint {
    template <class Value>
    void add(const Value& value) {
        const auto* bytes = reinterpret_cast<const unsigned char*>(&value);
        for (std::size_t n = 0; n < sizeof(Value); ++n) hash = (hash ^ bytes[n]) * 0x100000001b3;
    }
    std::uint64_t hash = 0xcbf29ce484222325;
};

LaserChunk blank() {
    LaserChunk chunk{};
    chunk.occupancy.fill(kUnknownLogOdds);
    chunk.himm.fill(kUnseenHimm);
    return chunk;
}

/// Whole numbers only: standard libraries generate different random doubles.
class Draw {
public:
    double milli(int low, int high) {
        return 0.001 * (low + static_cast<int>(random_() % static_cast<unsigned>(high - low)));
    }

private:
    std::mt19937 random_{1};
};

Fingerprint fingerprint() {
    Fingerprint all;
    Draw draw;
    const classify::Hysteresis<LogOdds> hysteresis{1268, -1268, -1268, kUnknownLogOdds};
    for (const double cell_size : {0.01, 0.05, 0.5}) {
        std::map<grid::ChunkKey, LaserChunk> chunks;
        const FanRing ring = make_fan_ring(make_beam_fan(UniformAngles{-2.0, 0.00625, 640}, 0.01));
        for (int scan = 0; scan < 20; ++scan) {
            std::vector<RangeMm> ranges(640);
            for (auto& range : ranges) range = to_range_mm(draw.milli(0, 6500));
            const Sweep::Band bands[]{{&ring, 0.1}, {&ring, 0.2}};
            const Pose2 pose{draw.milli(-2000, 2000), draw.milli(-2000, 2000), draw.milli(-3000, 3000)};
            Sweep sweep({ranges, pose, {0.1, 6.0, false}, cell_size}, bands);
            for (std::size_t strip = 0; strip < sweep.strips(); ++strip) {
                sweep.visit(strip, [&](grid::ChunkKey key, std::span<const ChunkVerdicts> verdicts) {
                    LaserChunk& chunk = chunks.try_emplace(key, blank()).first->second;
                    simd::add_evidence(chunk, verdicts[0], OccupancyRule({}));
                    simd::count_hits(chunk, verdicts[1], HimmRule({}));
                    simd::update_types(chunk, verdicts[0].free, hysteresis);
                });
            }
        }
        for (const auto& [key, chunk] : chunks) {
            all.add(key.ci);
            all.add(key.cj);
            all.add(chunk.occupancy);
            all.add(chunk.himm);
            all.add(chunk.occ_types.free);
            all.add(chunk.occ_types.occupied);
        }
    }
    return all;
}

} // namespace
} // namespace scanloom::mapping

int main() { std::printf("%016llx\n", static_cast<unsigned long long>(scanloom::mapping::fingerprint().hash)); }
