#include "server/store/record.hpp"
#include "server/store/table_carving.hpp"
#include "tests/fuzz/check.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

namespace {

/// Where in the table the values lie that are found.
std::vector<const char*> places_of_values(std::string_view table) {
    namespace store = scanloom::store;
    using scanloom::fuzz::check;
    std::vector<const char*> places;
    store::carve_table(table, [&](std::string_view key, std::string_view value) {
        check(store::unsealed(key, value).has_value(), "what is found is intact");
        check(store::session_of(key) || store::revision_of(key), "and a record or an entry");
        check(value.data() >= table.data() && value.data() + value.size() <= table.data() + table.size(),
              "and lies in the table");
        check(places.empty() || places.back() < value.data(), "each once, in their order");
        places.push_back(value.data());
    });
    return places;
}

} // namespace

/// Input: a damaged table file.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view table(reinterpret_cast<const char*>(data), size);
    const auto places = places_of_values(table);
    if (places.empty()) return 0;
    const auto up_to_last = static_cast<std::size_t>(places.back() - table.data());
    const auto before_last = places_of_values(table.substr(0, up_to_last));
    scanloom::fuzz::check(std::equal(before_last.begin(), before_last.end(), places.begin(), places.end() - 1),
                          "what comes behind takes nothing from what is before");
    return 0;
}
