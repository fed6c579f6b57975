#include "common/wire/live.hpp"
#include "server/live/core/event_encoder.hpp"
#include "tests/fuzz/check.hpp"

#include <string_view>

/// Input: a message of a viewer.
SCANLOOM_FUZZER(live_request)(const std::uint8_t* data, std::size_t size) {
    using namespace scanloom;
    const auto request = wire::decode_live_request({reinterpret_cast<const char*>(data), size});
    if (!request) {
        const auto& message = request.error().message;
        fuzz::check(!message.empty() && message.size() <= 123, "every error is a sentence that fits a close frame");
        return 0;
    }
    fuzz::check(request->layers.size() <= 16, "the number of layers is bounded");
    const auto subscription = live::subscription_of(*request);
    for (const auto layer : request->layers) {
        fuzz::check(layer >= wire::LiveLayer::kOccupancy && layer <= wire::LiveLayer::kClassification,
                    "each layer exists");
    }
    fuzz::check(subscription.layers.any() || request->layers.empty(), "each requested part is subscribed to");
    return 0;
}
