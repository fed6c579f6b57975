#include "robot_client/lidars/a5_protocol.hpp"

#include <boost/endian/conversion.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace scanloom::robot {
namespace {

constexpr std::uint8_t kRequestMark = 0xA5;

std::array<std::uint8_t, kA5DescriptorBytes> bytes_of(const A5Descriptor& descriptor) {
    constexpr std::uint32_t kRepeated = 1U << 30;
    std::array<std::uint8_t, kA5DescriptorBytes> bytes{0xA5, 0x5A};
    boost::endian::store_little_u32(&bytes[2], descriptor.size | (descriptor.is_repeated ? kRepeated : 0U));
    bytes.back() = descriptor.type;
    return bytes;
}

} // namespace

std::vector<std::uint8_t> a5_request(std::uint8_t command, std::initializer_list<std::uint8_t> payload) {
    std::vector<std::uint8_t> bytes{kRequestMark, command};
    if (payload.size() == 0) return bytes;
    bytes.push_back(static_cast<std::uint8_t>(payload.size()));
    bytes.insert(bytes.end(), payload);
    std::uint8_t check = 0;
    for (const std::uint8_t byte : bytes) check = static_cast<std::uint8_t>(check ^ byte);
    bytes.push_back(check);
    return bytes;
}

std::optional<std::size_t> find_a5_descriptor(std::span<const std::uint8_t> bytes,
                                              const A5Descriptor& wanted) noexcept {
    const auto descriptor = bytes_of(wanted);
    const auto found = std::search(bytes.begin(), bytes.end(), descriptor.begin(), descriptor.end());
    if (found == bytes.end()) return std::nullopt;
    return static_cast<std::size_t>(found - bytes.begin()) + descriptor.size();
}

A5Identity read_a5_identity(std::span<const std::uint8_t> data) {
    A5Identity identity{data[0], data[2], data[1], data[3], {}};
    for (const std::uint8_t byte : data.subspan(4, 16)) identity.serial += fmt::format("{:02X}", byte);
    return identity;
}

std::string text_of(const A5Identity& identity) {
    return fmt::format("model {}, firmware {}.{:02}, serial {}", identity.model, identity.firmware_major,
                       identity.firmware_minor, identity.serial);
}

A5Condition read_a5_condition(std::span<const std::uint8_t> data) noexcept {
    using State = A5Condition::State;
    const auto state = data[0] == 0 ? State::kGood : data[0] == 1 ? State::kWarning : State::kError;
    return {state, boost::endian::load_little_u16(&data[1])};
}

} // namespace scanloom::robot
