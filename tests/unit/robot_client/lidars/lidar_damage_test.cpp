#include "robot_client/lidars/lidar_models.hpp"
#include "tests/support/lidar_dialogue.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace scanloom::robot {
namespace {

using Bytes = std::vector<std::uint8_t>;

class LidarDamage : public testing::TestWithParam<LidarModel> {
protected:
    LidarDamage()
        : driver_(make_lidar_driver(GetParam(), scan_options(GetParam(), {}).value())),
          emulator_(testing_support::make_lidar_emulator(GetParam().name)), dialogue_(*driver_, *emulator_) {}

    /// Passes whole turns until the newest scan is complete.
    Scan newest_scan() {
        Scan newest;
        for (int i = 0; i < 4; ++i) {
            dialogue_.turn(now_ += 0.1);
            while (auto taken = driver_->next()) newest = std::move(taken->scan);
        }
        return newest;
    }

    void drop_scans() {
        while (driver_->next()) {
        }
    }

    std::mt19937 random_{7};
    double now_ = 1000.0;
    std::unique_ptr<LidarDriver> driver_;
    std::unique_ptr<testing_support::LidarEmulator> emulator_;
    testing_support::LidarDialogue dialogue_;
};

TEST_P(LidarDamage, ScansAreRightAgainAfterDamagedBytes) {
    dialogue_.open();
    const Scan good = newest_scan();
    ASSERT_GT(good.ranges.size(), 300U);
    for (int round = 0; round < 200; ++round) {
        Bytes bytes = emulator_->next_turn();
        for (unsigned i = 0; i <= round % 4U; ++i) {
            const auto at = static_cast<std::ptrdiff_t>(random_() % bytes.size());
            switch (random_() % 3) {
            case 0: bytes[static_cast<std::size_t>(at)] ^= static_cast<std::uint8_t>(1U << random_() % 8); break;
            case 1: bytes.erase(bytes.begin() + at, bytes.begin() + std::min(at + 30, std::ssize(bytes))); break;
            default: bytes.insert(bytes.begin() + at, static_cast<std::uint8_t>(random_())); break;
            }
            if (bytes.empty()) bytes.push_back(0);
        }
        dialogue_.send(bytes, now_ += 0.1);
        ASSERT_FALSE(dialogue_.failure()) << dialogue_.failure()->message;
        drop_scans();
        const Scan scan = newest_scan();
        ASSERT_EQ(scan.ranges.size(), good.ranges.size()) << "round " << round;
        if (GetParam().family != LidarFamily::kLd06) { // its turns begin at another point each time
            ASSERT_EQ(scan.ranges, good.ranges) << "round " << round;
            ASSERT_EQ(scan.angles, good.angles) << "round " << round;
        }
    }
    EXPECT_GT(driver_->counts().damaged, 0U);
}

TEST_P(LidarDamage, RandomBytesGiveNoScan) {
    dialogue_.open();
    drop_scans();
    (void)driver_->on_open();
    for (int i = 0; i < 100; ++i) {
        Bytes bytes(500);
        for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random_());
        (void)driver_->on_bytes(bytes, now_ += 0.1);
        EXPECT_FALSE(driver_->next());
    }
}

INSTANTIATE_TEST_SUITE_P(Each, LidarDamage, testing::ValuesIn(lidar_models().begin(), lidar_models().end()),
                         [](const auto& each) {
                             std::string name(each.param.name);
                             std::ranges::replace(name, '-', '_');
                             return name;
                         });

} // namespace
} // namespace scanloom::robot
