#include "robot_client/foxglove/core/protocol.hpp"

#include <boost/json/array.hpp>
#include <boost/json/object.hpp>
#include <boost/json/parse.hpp>
#include <boost/json/serialize.hpp>

#include <array>
#include <concepts>
#include <cstddef>
#include <limits>

namespace scanloom::robot::foxglove {

namespace json = boost::json;

namespace {

constexpr std::uint64_t kIdMax = std::uint64_t{1} << 53; // what a JSON number holds exactly
constexpr std::size_t kNestingMax = 16;

/// Opcodes of binary frames; those of a message are the same in both directions.
enum class Opcode : std::uint8_t {
    kMessage = 0x01,
    kTime = 0x02,
    kServiceResponse = 0x03,
    kAsset = 0x04,
    kPlaybackState = 0x05,
};

Error malformed(const char* what) { return {Errc::kMalformed, what}; }

/// Returns a text of an object; nullopt if it has none.
std::optional<std::string> text_of(const json::object& object, std::string_view key) {
    const auto* value = object.if_contains(key);
    if (value == nullptr || !value->is_string()) return std::nullopt;
    const auto& text = value->get_string();
    return std::string(text.data(), text.size());
}

/// Returns the texts of a list; nullopt if it is another value. A list that is missing is empty.
std::optional<std::vector<std::string>> texts_of(const json::object& object, std::string_view key) {
    std::vector<std::string> texts;
    const auto* value = object.if_contains(key);
    if (value == nullptr || value->is_null()) return texts;
    if (!value->is_array()) return std::nullopt;
    for (const auto& each : value->get_array()) {
        if (!each.is_string()) return std::nullopt;
        texts.emplace_back(each.get_string().data(), each.get_string().size());
    }
    return texts;
}

/// Returns a number that is an id; nullopt if it is none.
std::optional<std::uint64_t> id_of(const json::value* value) {
    if (value == nullptr || !value->is_number()) return std::nullopt;
    json::error_code failed;
    const auto id = value->to_number<std::uint64_t>(failed);
    if (failed || id > kIdMax) return std::nullopt;
    return id;
}

const json::array* list_of(const json::object& object, std::string_view key) {
    const auto* value = object.if_contains(key);
    return value == nullptr ? nullptr : value->if_array();
}

Result<Frame> decode_server_info(const json::object& object) {
    auto name = text_of(object, "name");
    auto capabilities = texts_of(object, "capabilities");
    auto encodings = texts_of(object, "supportedEncodings");
    if (!name || !capabilities || !encodings) return malformed("a serverInfo without name, capabilities or encodings");
    return ServerInfo{std::move(*name), std::move(*capabilities), std::move(*encodings)};
}

std::optional<Channel> channel_of(const json::value& value) {
    const auto* object = value.if_object();
    if (object == nullptr) return std::nullopt;
    const auto id = id_of(object->if_contains("id"));
    auto topic = text_of(*object, "topic");
    auto encoding = text_of(*object, "encoding");
    auto schema_name = text_of(*object, "schemaName");
    if (!id || !topic || topic->empty() || !encoding || !schema_name) return std::nullopt;
    return Channel{*id, std::move(*topic), std::move(*encoding), std::move(*schema_name)};
}

Result<Frame> decode_advertise(const json::object& object) {
    const auto* channels = list_of(object, "channels");
    if (channels == nullptr) return malformed("an advertise without channels");
    Advertise advertise;
    for (const auto& each : *channels) {
        if (auto channel = channel_of(each)) {
            advertise.channels.push_back(std::move(*channel));
        } else {
            ++advertise.refused;
        }
    }
    return advertise;
}

Result<Frame> decode_unadvertise(const json::object& object) {
    const auto* ids = list_of(object, "channelIds");
    if (ids == nullptr) return malformed("an unadvertise without channelIds");
    Unadvertise unadvertise;
    for (const auto& each : *ids) {
        const auto id = id_of(&each);
        if (!id) return malformed("an unadvertise with an id that is none");
        unadvertise.ids.push_back(*id);
    }
    return unadvertise;
}

Result<Frame> decode_status(const json::object& object) {
    auto message = text_of(object, "message");
    const auto level = id_of(object.if_contains("level"));
    if (!message || !level || *level > 2) return malformed("a status without level or message");
    return Status{static_cast<Status::Level>(*level), std::move(*message)};
}

/// A kind of text frame.
struct Operation {
    std::string_view name;
    Result<Frame> (*decode)(const json::object& object);
};

Result<Frame> decode_unneeded(const json::object&) { return Frame(Unneeded{}); }

constexpr std::array kOperations{
    Operation{"serverInfo", decode_server_info},         Operation{"advertise", decode_advertise},
    Operation{"unadvertise", decode_unadvertise},        Operation{"status", decode_status},
    Operation{"removeStatus", decode_unneeded},          Operation{"parameterValues", decode_unneeded},
    Operation{"advertiseServices", decode_unneeded},     Operation{"unadvertiseServices", decode_unneeded},
    Operation{"connectionGraphUpdate", decode_unneeded}, Operation{"serviceCallFailure", decode_unneeded},
};

/// Takes a little-endian number from the front of bytes that are long enough.
template <std::unsigned_integral T>
T take_little(std::string_view& bytes) {
    T value = 0;
    for (std::size_t n = sizeof(T); n-- > 0;) value = static_cast<T>(value << 8 | static_cast<unsigned char>(bytes[n]));
    bytes.remove_prefix(sizeof(T));
    return value;
}

} // namespace

Result<Frame> decode_text(std::string_view text) {
    if (text.size() > kTextBytesMax) return Error{Errc::kTooLarge, "a text frame of more than 8 MiB"};
    json::parse_options options;
    options.max_depth = kNestingMax;
    json::error_code failed;
    const auto value = json::parse(json::string_view(text.data(), text.size()), failed, {}, options);
    const auto* object = failed ? nullptr : value.if_object();
    if (object == nullptr) return malformed("a text frame that is no JSON object");
    const auto name = text_of(*object, "op");
    if (!name) return malformed("a text frame without op");
    for (const auto& operation : kOperations) {
        if (operation.name == *name) return operation.decode(*object);
    }
    return malformed("a text frame with an op that is not known");
}

Result<Frame> decode_binary(std::string_view bytes) {
    if (bytes.empty()) return malformed("an empty binary frame");
    const auto opcode = static_cast<Opcode>(bytes.front());
    bytes.remove_prefix(1);
    switch (opcode) {
    case Opcode::kMessage: {
        if (bytes.size() < sizeof(std::uint32_t) + sizeof(std::uint64_t)) return malformed("a short message");
        MessageData message;
        message.subscription = take_little<std::uint32_t>(bytes);
        message.log_time = take_little<std::uint64_t>(bytes);
        message.payload = bytes;
        return message;
    }
    case Opcode::kTime:
        if (bytes.size() < sizeof(std::uint64_t)) return malformed("a short time");
        return ServerTime{take_little<std::uint64_t>(bytes)};
    case Opcode::kServiceResponse:
    case Opcode::kAsset:
    case Opcode::kPlaybackState: return Unneeded{};
    }
    return malformed("a binary frame with an opcode that is not known");
}

std::string encode_subscribe(const std::vector<Subscription>& subscriptions) {
    json::array list;
    for (const auto& each : subscriptions) list.push_back(json::object{{"id", each.id}, {"channelId", each.channel}});
    return json::serialize(json::object{{"op", "subscribe"}, {"subscriptions", std::move(list)}});
}

std::string encode_unsubscribe(const std::vector<std::uint32_t>& ids) {
    return json::serialize(
        json::object{{"op", "unsubscribe"}, {"subscriptionIds", json::array(ids.begin(), ids.end())}});
}

std::string encode_advertise(const Channel& channel) {
    json::object described{{"id", channel.id},
                           {"topic", channel.topic},
                           {"encoding", channel.encoding},
                           {"schemaName", channel.schema_name}};
    return json::serialize(json::object{{"op", "advertise"}, {"channels", json::array{std::move(described)}}});
}

std::string encode_message(std::uint32_t channel, std::string_view payload) {
    std::string bytes(1, static_cast<char>(Opcode::kMessage));
    for (std::size_t n = 0; n < sizeof channel; ++n) bytes += static_cast<char>(channel >> (8 * n));
    bytes += payload;
    return bytes;
}

} // namespace scanloom::robot::foxglove
