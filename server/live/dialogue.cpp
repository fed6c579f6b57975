#include "server/live/dialogue.hpp"

#include "server/live/event_dialogue.hpp"
#include "server/live/foxglove_dialogue.hpp"

namespace scanloom::live {

boost::beast::websocket::close_reason close_with(boost::beast::websocket::close_code code, std::string_view reason) {
    constexpr std::size_t kReasonBytesMax = 123; // limit of a control frame
    const auto cut = reason.substr(0, kReasonBytesMax);
    return {code, boost::beast::string_view(cut.data(), cut.size())};
}

std::unique_ptr<Dialogue> make_dialogue(const ViewedSession& viewed, const DialogueServices& services) {
    if (viewed.protocol == Protocol::kFoxglove) return std::make_unique<FoxgloveDialogue>(viewed, services);
    return std::make_unique<EventDialogue>(viewed, services);
}

} // namespace scanloom::live
