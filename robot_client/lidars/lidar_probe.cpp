#include "robot_client/lidars/lidar_probe.hpp"

#include "robot_client/lidars/a5_protocol.hpp"
#include "robot_client/lidars/hokuyo_scip.hpp"
#include "robot_client/lidars/ld06_packet.hpp"
#include "robot_client/lidars/ydlidar_packet.hpp"

#include <fmt/format.h>

namespace scanloom::robot {
namespace {

/// So many packets in a row are no coincidence.
constexpr int kPacketsMin = 3;

using Found = std::optional<LidarIdentity>;

/// The rate of the line distinguishes an STL-27L from an LD06 only where the line has a rate, and over TCP or on a
/// pseudo terminal it has none. The samples per second always do.
Found identify_ld06(std::span<const std::uint8_t> bytes) {
    // Data sheets: 4500 samples per second (LD06, LD19) and 21,600 (STL-27L). Packets of LD06 and LD19 that were
    // published have 2270 to 5020.
    constexpr double kStl27lSamplesMin = 10'000.0;
    Ld06Decoder decoder;
    decoder.feed(bytes);
    double speed = 0.0;   // degrees per second, sum over the packets
    double spanned = 0.0; // degrees, likewise
    for (int packets = 0; packets < kPacketsMin; ++packets) {
        const auto packet = decoder.next();
        if (!packet) return std::nullopt;
        speed += packet->speed;
        spanned += static_cast<double>(steps_spanned(*packet)) / kLd06StepsPerDegree;
    }
    constexpr int kGaps = kLd06PacketPoints - 1;
    if (speed * kGaps > kStl27lSamplesMin * spanned) {
        return LidarIdentity{"stl27l", "STL-27L (it states no serial number)", 0};
    }
    return LidarIdentity{"ld06", "LD06 or LD19 (it states no serial number)", 0};
}

Found identify_x2(std::span<const std::uint8_t> bytes) {
    YdlidarDecoder decoder;
    decoder.feed(bytes);
    for (int packets = 0; packets < kPacketsMin; ++packets) {
        if (!decoder.next()) return std::nullopt;
    }
    return LidarIdentity{"ydlidar-x2", "YDLIDAR X2 (it states no serial number)", 0};
}

std::optional<A5Identity> find_a5_identity(std::span<const std::uint8_t> bytes) {
    const auto data = find_a5_descriptor(bytes, kA5Info);
    if (!data || bytes.size() < *data + kA5Info.size) return std::nullopt;
    return read_a5_identity(bytes.subspan(*data, kA5Info.size));
}

Found identify_rplidar(std::span<const std::uint8_t> bytes) {
    const auto identity = find_a5_identity(bytes);
    if (!identity) return std::nullopt;
    const int series = identity->model >> 4; // see RplidarDriver
    const std::string_view model = series <= 1 ? "rplidar-a1" : series <= 3 ? "rplidar-a2" : "rplidar-c1";
    const std::string_view name = series <= 1   ? "RPLIDAR A1"
                                  : series == 2 ? "RPLIDAR A2"
                                  : series == 3 ? "RPLIDAR A3"
                                                : "RPLIDAR of the C or S series";
    return LidarIdentity{std::string(model), fmt::format("{}, {}", name, text_of(*identity)), 0};
}

Found identify_rplidar_at_256000(std::span<const std::uint8_t> bytes) {
    auto found = identify_rplidar(bytes);
    if (found) found->baud = 256'000;
    return found;
}

Found identify_ydlidar(std::span<const std::uint8_t> bytes) {
    const auto identity = find_a5_identity(bytes);
    if (!identity) return std::nullopt;
    return LidarIdentity{"ydlidar-x4", "YDLIDAR X4, " + text_of(*identity), 0};
}

Found identify_hokuyo(std::span<const std::uint8_t> bytes) {
    ScipReader reader;
    reader.feed(bytes);
    while (const auto reply = reader.next()) {
        const auto serial = scip_value(*reply, "SERI");
        if (reply->command != "VV" || serial.empty()) continue;
        return LidarIdentity{"hokuyo",
                             fmt::format("Hokuyo {}, firmware {}, serial {}", scip_value(*reply, "PROD"),
                                         scip_value(*reply, "FIRM"), serial),
                             0};
    }
    return std::nullopt;
}

Found identify_hokuyo_at_19200(std::span<const std::uint8_t> bytes) {
    auto found = identify_hokuyo(bytes);
    if (found) found->baud = 19'200;
    return found;
}

} // namespace

const std::vector<LidarProbe>& lidar_probes() {
    using Requests = std::vector<std::vector<std::uint8_t>>;
    const Requests listen;
    const Requests rplidar{a5_request(0x25), a5_request(0x50)};
    const Requests ydlidar{a5_request(0x65), a5_request(0x90)};
    const Requests hokuyo{{'\n', 'Q', 'T', '\n'}, {'V', 'V', '\n'}};
    static const std::vector<LidarProbe> probes{
        {230'400, listen, identify_ld06},
        {921'600, listen, identify_ld06},
        {115'200, listen, identify_x2},
        {115'200, rplidar, identify_rplidar},
        {460'800, rplidar, identify_rplidar},
        {256'000, rplidar, identify_rplidar_at_256000},
        {128'000, ydlidar, identify_ydlidar},
        {115'200, hokuyo, identify_hokuyo},
        {19'200, hokuyo, identify_hokuyo_at_19200},
    };
    return probes;
}

} // namespace scanloom::robot
