#include "tests/unit/server/store/races.hpp"

#include "tests/unit/server/store/postgres_database.hpp"

namespace scanloom::store {
namespace {

TEST(Races, TwoServersThatRaceForAThousandSessionsWriteOneLogOfEach) {
    const PostgresDatabase database;
    const auto open = [&](const std::string& node) {
        return open_postgres(database.address, {.allow_unreplicated = true, .node = node}).value();
    };
    race_for_sessions(*open("a"), *open("b"), 1000);
}

} // namespace
} // namespace scanloom::store
