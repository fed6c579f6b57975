#include "server/store/table_carving.hpp"

#include "server/store/record.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace scanloom::store {
namespace {

constexpr std::size_t kTailBytes = 8; // type and sequence, behind a key
constexpr std::size_t kRecordKeyBytes = 9;
constexpr std::size_t kEntryKeyBytes = 17;
constexpr char kRemoval = 0;
constexpr char kValue = 1;

/// Takes a number off the front of bytes.
std::optional<std::uint32_t> varint32(std::string_view& bytes) {
    std::uint32_t number = 0;
    for (unsigned shift = 0; shift < 32 && !bytes.empty(); shift += 7) {
        const auto byte = static_cast<unsigned char>(bytes.front());
        bytes.remove_prefix(1);
        number |= std::uint32_t{byte & 0x7Fu} << shift;
        if ((byte & 0x80) == 0) return number;
    }
    return std::nullopt;
}

/// What may be an entry of a table.
struct Found {
    std::size_t shared = 0;    // bytes of the key that the one before has, too
    std::string_view key_rest; // with its tail
    std::string_view value;
};

std::optional<Found> read_one(std::string_view bytes) {
    const auto shared = varint32(bytes);
    const auto rest = shared ? varint32(bytes) : std::nullopt;
    const auto length = rest ? varint32(bytes) : std::nullopt;
    if (!length || *rest < kTailBytes || *rest > bytes.size() || *length > bytes.size() - *rest) return std::nullopt;
    return Found{*shared, bytes.substr(0, *rest), bytes.substr(*rest, *length)};
}

/// The whole key, if it is one of the two kinds; without its tail.
std::optional<std::string> key_of(const Found& found, std::string_view before) {
    const auto key_bytes = found.shared + found.key_rest.size() - kTailBytes;
    if (found.shared > before.size() || (key_bytes != kRecordKeyBytes && key_bytes != kEntryKeyBytes)) {
        return std::nullopt; // before anything is copied: noise may say that a key is the rest of the table
    }
    std::string key(before.substr(0, found.shared));
    key.append(found.key_rest.substr(0, found.key_rest.size() - kTailBytes));
    if (!session_of(key) && !revision_of(key)) return std::nullopt;
    return key;
}

/// Keys that the next one may be told from.
class KeysBefore {
public:
    void is_intact(const std::string& key) {
        keys_[kIntact] = key;
        const auto revision = revision_of(key);
        keys_[kNext] = revision ? entry_key(*owner_of(key), *revision + 1) : std::string();
    }

    /// It has the shape of a key, and no checksum says that it was one: that of a removal, or of a damaged value.
    void may_be(const std::string& key) { keys_[kUncertain] = key; }

    [[nodiscard]] const std::array<std::string, 3>& all() const { return keys_; }

private:
    enum : std::size_t { kIntact, kNext, kUncertain };
    std::array<std::string, 3> keys_; // next: of an entry that is damaged
};

} // namespace

void carve_table(std::string_view table, const VisitCarved& visit) {
    KeysBefore before;
    const auto take = [&](const Found& found) {
        std::optional<std::string> shaped; // a key whose value is damaged, if it is one
        const char type = found.key_rest[found.key_rest.size() - kTailBytes];
        for (const auto& key_before : before.all()) {
            const auto key = key_of(found, key_before);
            if (key && type == kRemoval && found.value.empty()) {
                before.may_be(*key);
                return false;
            }
            if (!key || type != kValue) continue;
            if (!unsealed(*key, found.value)) {
                shaped = key;
                continue;
            }
            visit(*key, found.value);
            before.is_intact(*key);
            return true;
        }
        if (shaped) before.may_be(*shaped);
        return false;
    };
    while (!table.empty()) {
        const auto found = read_one(table);
        const bool taken = found && take(*found);
        table.remove_prefix(taken ? static_cast<std::size_t>(found->value.end() - table.begin()) : 1);
    }
}

} // namespace scanloom::store
