#include "robot_client/app/localization_notes.hpp"

#include "common/scan/mount_message.hpp"

#include <string_view>
#include <utility>

namespace scanloom::robot {
namespace {

std::string_view sentence_of(LocalizationState state) {
    switch (state) {
    case LocalizationState::kTracking: return "the server has found the robot in the map";
    case LocalizationState::kLost:
        return "the server has lost the robot: its scans fit no place in the map; they are stored, but not in the map "
               "until the robot is found again";
    case LocalizationState::kUnlocated:
        return "the robot's place in the map is not known yet; its scans are stored, but not in the map until it is "
               "found";
    case LocalizationState::kGiven: break;
    }
    return {};
}

} // namespace

std::vector<std::string> LocalizationNotes::add(const wire::Correction& correction) {
    std::vector<std::string> notes;
    const auto before = std::exchange(state_, correction.state).value_or(LocalizationState::kTracking);
    if (before != correction.state) {
        if (const auto sentence = sentence_of(correction.state); !sentence.empty()) notes.emplace_back(sentence);
    }
    const auto& error = correction.mount_yaw_error;
    if (!std::exchange(has_wrong_mount_, error.has_value()) && error) {
        notes.push_back(mount_message(*error));
    }
    return notes;
}

} // namespace scanloom::robot
