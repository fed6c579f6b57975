#include "common/wire/log_codec.hpp"
#include "tests/fuzz/check.hpp"

namespace {

template <class Value>
void check_round_trip(std::string_view bytes, scanloom::Result<Value> (*decode)(std::string_view),
                      std::string (*encode)(const Value&)) {
    using scanloom::fuzz::check;
    const auto value = decode(bytes);
    if (!value) {
        check(!value.error().message.empty(), "every error has a message");
        return;
    }
    const std::string once = encode(*value);
    const auto again = decode(once);
    check(again.has_value(), "an encoded value can be decoded");
    check(encode(*again) == once, "encoding and decoding change nothing");
}

} // namespace

/// Input: the bytes of a stored record, decoded both as a log entry and as a session.
SCANLOOM_FUZZER(log_codec)(const std::uint8_t* data, std::size_t size) {
    namespace wire = scanloom::wire;
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    check_round_trip(bytes, wire::decode_entry, wire::encode_entry);
    check_round_trip(bytes, wire::decode_session, wire::encode_session);
    return 0;
}
