#include "common/wire/log_codec.hpp"
#include "server/sessions/session_registry.hpp"
#include "tests/support/digests.hpp"
#include "tests/unit/server/sessions/session_fixture.hpp"

#include <boost/asio/thread_pool.hpp>

#include <fstream>
#include <future>

/// Sessions that begin with an imported map.
namespace scanloom::sessions {
namespace {

/// Returns the peak resident memory of this process.
std::size_t peak_bytes() {
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;) {
        std::size_t kibibytes = 0;
        if (word == "VmHWM:" && status >> kibibytes) return kibibytes * 1024;
    }
    return 0;
}

TEST(ImportedMap, SurvivesARestart) {
    store::MemoryScanLog log;
    boost::asio::thread_pool pool(2);
    const MapPatch bottom{0.1, -1.0, 2.0, 3, {MapCell::kFree, MapCell::kFree, MapCell::kUnknown}};
    const MapPatch top{0.1, -1.0, 2.1, 3, {MapCell::kOccupied, MapCell::kFree, MapCell::kFree}};
    std::string digests;
    {
        SessionRegistry registry(log, {pool.get_executor(), [] { return 1.0; }});
        const auto session = registry.import_map("depot", {.cell_size = 0.1}, {bottom, top});
        ASSERT_TRUE(session) << session.error().message;
        EXPECT_EQ((*session)->snapshot()->revision, 2U);
        digests = testing_support::digests_of(*(*session)->snapshot());
        registry.drain();
    }
    SessionRegistry registry(log, {pool.get_executor(), [] { return 1.0; }});
    ASSERT_TRUE(registry.recover());
    EXPECT_EQ(testing_support::digests_of(*registry.load("depot").value()->snapshot()), digests);
    registry.drain();
}

/// Returns a square map of whole chunks with a resolution of 0.1 m, in strips.
std::vector<MapPatch> square_map(std::uint32_t chunks_wide, MapCell of) {
    const std::uint32_t side = chunks_wide * 64;
    std::vector<MapPatch> patches;
    for (std::uint32_t row = 0; row < chunks_wide; ++row) {
        patches.push_back({0.1, 0.0, 6.4 * row, side, std::vector<MapCell>(std::size_t{side} * 64, of)});
    }
    return patches;
}

TEST(ImportedMap, TooLargeMapIsRefusedBeforeAllocation) {
    store::MemoryScanLog log;
    boost::asio::thread_pool pool(2);
    RegistryConfig config{pool.get_executor(), [] { return 1.0; }};
    config.pages_max = 100;
    SessionRegistry registry(log, config);
    const auto patches = square_map(64, MapCell::kFree); // 4096 chunks, 80 MiB
    std::ofstream("/proc/self/clear_refs") << 5;         // resets the peak
    const std::size_t before = peak_bytes();
    const auto refused = registry.import_map("large", {.cell_size = 0.1}, patches);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::kFull);
    EXPECT_THAT(refused.error().message, testing::HasSubstr("up to 82 MiB, and the memory for maps has 1 MiB in all"));
    EXPECT_LT(peak_bytes(), before + (std::size_t{16} << 20));
    EXPECT_TRUE(log.sessions()->empty());
    EXPECT_TRUE(registry.import_map("unknown", {.cell_size = 0.1}, square_map(64, MapCell::kUnknown)));
    EXPECT_TRUE(registry.import_map("small", {.cell_size = 0.1}, square_map(9, MapCell::kFree)));
    EXPECT_EQ(registry.import_map("other", {.cell_size = 0.1}, square_map(9, MapCell::kFree)).error().code,
              Errc::kOverloaded);
    registry.drain();
    pool.join(); // the registry evicts sessions on this pool
}

TEST(ImportedMap, IncompleteImportIsRemovedAtTheNextStart) {
    store::MemoryScanLog log;
    boost::asio::thread_pool pool(2);
    const auto id = log.create_session(wire::encode_session({"depot", 1.0, {}, 2})).value();
    std::promise<void> appended;
    log.append(id, 1, {wire::encode_entry(MapPatch{0.1, 0.0, 0.0, 1, {MapCell::kFree}})},
               [&](const Result<>&) { appended.set_value(); });
    appended.get_future().wait();
    SessionRegistry registry(log, {pool.get_executor(), [] { return 1.0; }});
    ASSERT_TRUE(registry.recover());
    EXPECT_EQ(registry.find("depot"), nullptr);
    EXPECT_TRUE(registry.damaged().empty());
    EXPECT_TRUE(log.sessions()->empty());
    EXPECT_TRUE(registry.import_map("depot", {}, {MapPatch{0.1, 0.0, 0.0, 1, {MapCell::kFree}}}));
    registry.drain();
}

TEST(ImportedMap, InvalidMapIsRefusedWithoutCreatingASession) {
    store::MemoryScanLog log;
    boost::asio::thread_pool pool(2);
    SessionRegistry registry(log, {pool.get_executor(), [] { return 1.0; }});
    EXPECT_EQ(registry.import_map("depot", {}, {}).error().code, Errc::kInvalidField);
    const MapPatch coarse{100.0, 0.0, 0.0, 100, std::vector<MapCell>(10'000, MapCell::kFree)};
    EXPECT_EQ(registry.import_map("depot", {.cell_size = 0.01}, {coarse}).error().code, Errc::kInvalidField);
    const MapPatch here{0.1, 0.0, 0.0, 1, {MapCell::kFree}};
    const MapPatch far{0.1, 100'000.0, 100'000.0, 1, {MapCell::kFree}};
    EXPECT_EQ(registry.import_map("depot", {}, {here, far}).error().code, Errc::kFull);
    EXPECT_TRUE(log.sessions()->empty());
    registry.drain();
}

} // namespace
} // namespace scanloom::sessions
