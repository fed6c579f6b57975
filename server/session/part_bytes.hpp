#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

/// Encodes and decodes plain values in the parts of a checkpoint.
namespace scanloom::session {

static_assert(std::endian::native == std::endian::little, "checkpoints are written in the machine's own order");

/// Appends the bytes of `value`.
template <class Value>
void put(std::string& out, const Value& value) {
    static_assert(std::is_trivially_copyable_v<Value>);
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Reads values from the front of a part. After the first value that does not fit, failed() stays true.
class PartReader {
public:
    explicit PartReader(std::string_view bytes) : rest_(bytes) {}

    /// Removes and returns the next value; a zero value if too few bytes are left.
    template <class Value>
    Value take() {
        static_assert(std::is_trivially_copyable_v<Value>);
        Value value{};
        if (rest_.size() < sizeof value) {
            failed_ = true;
            return value;
        }
        std::memcpy(&value, rest_.data(), sizeof value);
        rest_.remove_prefix(sizeof value);
        return value;
    }

    /// Removes `bytes` bytes, or all that are left.
    void skip(std::size_t bytes) { rest_.remove_prefix(std::min(bytes, rest_.size())); }

    [[nodiscard]] std::string_view rest() const noexcept { return rest_; }

    /// Returns whether all bytes were read and no value was missing.
    [[nodiscard]] bool complete() const noexcept { return !failed_ && rest_.empty(); }
    [[nodiscard]] bool failed() const noexcept { return failed_; }

private:
    std::string_view rest_;
    bool failed_ = false;
};

} // namespace scanloom::session
