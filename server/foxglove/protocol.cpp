#include "server/foxglove/protocol.hpp"

#include "common/json/json_text.hpp"
#include "server/foxglove/little_endian.hpp"

#include <boost/json/array.hpp>
#include <boost/json/object.hpp>
#include <boost/json/parse.hpp>
#include <fmt/format.h>
#include <openssl/evp.h>

#include <optional>

namespace scanloom::foxglove {

namespace json = boost::json;

namespace {

constexpr std::size_t kShownBytes = 40; // of a text that was not understood

Error malformed(std::string_view what) { return Error{Errc::kMalformed, std::string(what)}; }

/// Returns a member that is a number from 0 to 2^32 - 1.
std::optional<std::uint32_t> id_of(const json::object& object, std::string_view name) {
    const json::value* member = object.if_contains(name);
    if (member == nullptr) return std::nullopt;
    boost::system::error_code failed;
    const auto id = member->to_number<std::uint32_t>(failed);
    return failed ? std::nullopt : std::optional(id);
}

/// Returns a member that is an array; null if there is none.
const json::array* list_of(const json::object& object, std::string_view name) {
    const json::value* member = object.if_contains(name);
    return member == nullptr ? nullptr : member->if_array();
}

Result<Subscribe> decode_subscribe(const json::object& object) {
    const json::array* list = list_of(object, "subscriptions");
    if (list == nullptr) return malformed("subscribe has no list of subscriptions");
    Subscribe subscribe;
    for (const json::value& each : *list) {
        const json::object* subscription = each.if_object();
        const auto id = subscription != nullptr ? id_of(*subscription, "id") : std::nullopt;
        const auto channel = subscription != nullptr ? id_of(*subscription, "channelId") : std::nullopt;
        if (!id || !channel) return malformed("a subscription has no id or no channelId below 2^32");
        subscribe.subscriptions.push_back({*id, *channel});
    }
    return subscribe;
}

Result<Unsubscribe> decode_unsubscribe(const json::object& object) {
    const json::array* list = list_of(object, "subscriptionIds");
    if (list == nullptr) return malformed("unsubscribe has no list of subscriptionIds");
    Unsubscribe unsubscribe;
    for (const json::value& each : *list) {
        boost::system::error_code failed;
        unsubscribe.ids.push_back(each.to_number<std::uint32_t>(failed));
        if (failed) return malformed("an id in subscriptionIds is not a number below 2^32");
    }
    return unsubscribe;
}

std::string base64(std::string_view bytes) {
    constexpr std::size_t kIn = 3;
    constexpr std::size_t kOut = 4;
    std::string text((bytes.size() + kIn - 1) / kIn * kOut + 1, '\0'); // with a final NUL
    const int size =
        ::EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                          reinterpret_cast<const unsigned char*>(bytes.data()), static_cast<int>(bytes.size()));
    text.resize(static_cast<std::size_t>(size));
    return text;
}

} // namespace

Result<std::variant<Subscribe, Unsubscribe>> decode_request(std::string_view text) {
    using Request = std::variant<Subscribe, Unsubscribe>;
    boost::system::error_code failed;
    const json::value parsed = json::parse(text, failed);
    const json::object* object = failed ? nullptr : parsed.if_object();
    const json::value* op = object == nullptr ? nullptr : object->if_contains("op");
    if (op == nullptr || !op->is_string()) {
        return malformed("a text message is not a JSON object with an op");
    }
    const std::string_view name = op->get_string();
    if (name == "subscribe") {
        auto subscribe = decode_subscribe(*object);
        if (!subscribe) return subscribe.error();
        return Request(std::move(*subscribe));
    }
    if (name == "unsubscribe") {
        auto unsubscribe = decode_unsubscribe(*object);
        if (!unsubscribe) return unsubscribe.error();
        return Request(std::move(*unsubscribe));
    }
    return Error{Errc::kUnsupportedVersion, fmt::format("{} is not possible here; this server only shows data",
                                                        name.size() <= kShownBytes ? name : "an op with a long name")};
}

std::string server_info_text(std::string_view name, std::string_view session_id) {
    return json_text(json::object{{"op", "serverInfo"},
                                  {"name", name},
                                  {"capabilities", json::array()},
                                  {"metadata", json::object()},
                                  {"sessionId", session_id}});
}

std::string advertise_text(std::span<const Advertised> channels) {
    json::array list;
    for (const auto& [id, topic, message] : channels) {
        const Schema& schema = schema_of(message);
        const bool is_binary = schema.encoding == "protobuf";
        list.push_back(json::object{{"id", id},
                                    {"topic", topic},
                                    {"encoding", schema.message_encoding},
                                    {"schemaName", schema.name},
                                    {"schemaEncoding", schema.encoding},
                                    {"schema", is_binary ? base64(schema.data) : schema.data}});
    }
    return json_text(json::object{{"op", "advertise"}, {"channels", std::move(list)}});
}

std::string warning_text(std::string_view message) {
    constexpr int kWarning = 1;
    return json_text(json::object{{"op", "status"}, {"level", kWarning}, {"message", message}});
}

std::string data_head(std::uint32_t subscription, std::int64_t log_time) {
    constexpr char kMessageData = 0x01;
    std::string bytes(1, kMessageData);
    append_raw(bytes, subscription);
    append_raw(bytes, log_time);
    return bytes;
}

} // namespace scanloom::foxglove
