#include "server/store/record.hpp"
#include "tests/fuzz/check.hpp"

#include <algorithm>
#include <cstdint>

/// Input: the length of a key, the key, and the value that lies there with its checksum, as a damaged table might have
/// them.
SCANLOOM_FUZZER(store_key)(const std::uint8_t* data, std::size_t size) {
    namespace store = scanloom::store;
    using scanloom::fuzz::check;
    if (size == 0) return 0;
    const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
    const auto key = bytes.substr(0, std::min<std::size_t>(data[0], bytes.size()));
    const auto value = bytes.substr(key.size());

    if (const auto session = store::session_of(key)) {
        check(store::session_key(*session) == key, "a session's key says which it is, and nothing else");
        check(store::owner_of(key) == session, "a session owns its record");
    }
    if (const auto revision = store::revision_of(key)) {
        check(store::entry_key(store::owner_of(key).value(), *revision) == key, "an entry's key likewise");
    }
    if (const auto part = store::part_of(key)) {
        check(store::part_key(store::owner_of(key).value(), *part) == key, "a part's key likewise");
    }
    if (const auto number = store::number_of(value)) {
        check(store::number_bytes(*number) == value, "a number is as it was written");
    }
    if (const auto inside = store::unsealed(key, value)) {
        check(store::sealed(key, std::string(*inside)) == value, "there is one checksum of a value");
    }
    const auto sealed = store::sealed(key, std::string(value));
    check(store::unsealed(key, sealed) == value, "what was sealed comes back");
    return 0;
}
