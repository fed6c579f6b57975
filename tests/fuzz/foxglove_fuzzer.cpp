#include "robot_client/foxglove/core/bridge_session.hpp"
#include "robot_client/ros/live_scans.hpp"
#include "tests/fuzz/server_check.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace scanloom::robot::foxglove {
namespace {

/// A robot behind a bridge, as the program reads it.
class FuzzedRobot {
public:
    FuzzedRobot() : session_([this](const RecordedTopic& topic) { return scans_.needs(topic); }) {
        publication_ = session_.add_publication("/tf", "tf2_msgs/TFMessage");
        session_.begin();
    }

    /// Takes a frame: of a new connection, or of the present one.
    void take(unsigned kind, const std::string& frame) {
        if (kind == 0) {
            session_.begin();
            scans_.interrupt();
        }
        const auto event = kind % 2 == 0 ? session_.take_text(frame) : session_.take_binary(frame);
        if (const auto* message = std::get_if<Delivered>(&event)) deliver(*message, frame);
        if (std::holds_alternative<Connected>(event)) scans_.resume(now_);
        if (kind >= 6) choose();
        take_scans();
        check_outgoing();
    }

    void check_counts() const {
        constexpr std::size_t kReasonsMax = 40;
        for (const auto* counts : {&session_.refused(), &scans_.skipped()}) {
            fuzz::check(counts->size() <= kReasonsMax, "reasons are not made of the input");
            for (const auto& [reason, count] : *counts)
                fuzz::check(!reason.empty() && count > 0, "reasons are counted");
        }
    }

private:
    void deliver(const Delivered& message, const std::string& frame) {
        const auto payload = message.payload;
        fuzz::check(payload.data() >= frame.data() && payload.data() + payload.size() <= frame.data() + frame.size(),
                    "a payload is a part of its frame");
        fuzz::check(message.log_time >= 0, "times do not overflow");
        fuzz::check(scans_.needs(message.topic), "only needed topics are delivered");
        const std::string own(payload); // so that reading behind it is noticed
        static_cast<void>(scans_.add(message.topic, message.log_time, own, now_));
    }

    void choose() {
        if (is_surveyed_ || !scans_.survey_end()) return;
        const auto chosen = scans_.choose(now_);
        is_surveyed_ = !chosen || *chosen;
        if (chosen && *chosen) session_.update_subscriptions();
    }

    void take_scans() {
        now_ += std::chrono::milliseconds(300);
        while (const auto one = scans_.take(now_)) {
            fuzz::check_accepted(*one->sensor);
            Scan scan = one->scan;
            scan.seq = 1;
            fuzz::check_accepted(wire::ScanBatch{{scan}});
        }
    }

    void check_outgoing() {
        constexpr std::size_t kFramesAtOnce = 4; // unsubscribe, subscribe, advertise, a message
        session_.publish(publication_, "payload");
        std::size_t frames = 0;
        while (session_.next_frame()) ++frames;
        fuzz::check(frames <= kFramesAtOnce, "a frame of the bridge causes few frames");
    }

    LiveScans scans_{LiveScanOptions{}};
    BridgeSession session_;
    std::uint32_t publication_ = 0;
    LiveScans::Time now_{};
    bool is_surveyed_ = false;
};

} // namespace
} // namespace scanloom::robot::foxglove

/// Input: frames of a bridge, each after a byte for its kind (0: text of a new connection; else text if even, binary if
/// odd; from 6 on the robot is surveyed after it) and two for its length.
SCANLOOM_FUZZER(foxglove)(const std::uint8_t* data, std::size_t size) {
    constexpr std::size_t kFramesMax = 64;
    constexpr std::size_t kHeadBytes = 3;
    std::string_view input(reinterpret_cast<const char*>(data), size);
    scanloom::robot::foxglove::FuzzedRobot robot;
    for (std::size_t n = 0; n < kFramesMax && input.size() >= kHeadBytes; ++n) {
        const unsigned kind = static_cast<unsigned char>(input[0]) % 8;
        const std::size_t length = static_cast<unsigned char>(input[1]) + 256U * static_cast<unsigned char>(input[2]);
        input.remove_prefix(kHeadBytes);
        const std::string frame(input.substr(0, length));
        input.remove_prefix(frame.size());
        robot.take(kind, frame);
    }
    robot.check_counts();
    return 0;
}
