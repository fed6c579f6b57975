#pragma once

#include "tests/unit/core/slam/drive.hpp"
#include "tests/unit/server/http/api_fixture.hpp"

#include <boost/json/array.hpp>

#include <cstddef>
#include <cstdint>
#include <future>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace scanloom::http {

/// A lap of a corridor and a quarter, with odometry that drifts by metres.
inline const slam::Drive& lap() {
    static const slam::Drive drive =
        slam::drive_along(slam::ring_building(), slam::kLapAndAQuarter, {.scale = 1.03, .turn = 0.004}, 1);
    return drive;
}

/// A session whose robot drives the lap.
class ApiPosesTest : public ApiTest {
protected:
    void SetUp() override { create("a"); }

    /// Joins a robot with any poses.
    std::shared_ptr<Link> join_as(Poses poses, std::uint64_t awaited_seq, const std::string& session = "a") {
        const auto link = std::make_shared<Link>(awaited_seq);
        std::promise<void> joined;
        registry_.find(session)->join({.robot = "r1", .poses = poses}, link,
                                      [&joined](const Result<sessions::Joined>&) { joined.set_value(); });
        joined.get_future().wait();
        links_.push_back(link);
        return link;
    }

    /// Sends scans that fit nothing, after those of the lap.
    void carry_away() {
        constexpr std::size_t kScans = 25;
        const auto before = registry_.find("a")->snapshot()->robots.at(0).last_seq;
        std::mt19937 random(1);
        std::vector<Scan> scans;
        for (std::size_t n = before; n < before + kScans; ++n) {
            Scan scan{.seq = n + 1, .stamp = stamp_of(n), .ranges = lap().scans[0].ranges};
            for (auto& range : scan.ranges) range = 500 + static_cast<std::uint32_t>(random() % 10'000);
            scan.odometry = lap().odometry[before];
            scans.push_back(std::move(scan));
        }
        send(std::move(scans), Poses::kOdometry, "a");
    }

    /// Sends the scans of the lap that the session does not have, and waits until none of them is moving.
    void drive_lap(std::size_t end = lap().scans.size(), Poses poses = Poses::kOdometry,
                   const std::string& name = "a") {
        const auto session = registry_.find(name);
        const auto& robots = session->snapshot()->robots;
        std::vector<Scan> scans;
        for (std::size_t n = robots.empty() ? 0 : robots[0].last_seq; n < end; ++n) {
            Scan scan = lap().scans[n];
            scan.seq = n + 1;
            scan.stamp = stamp_of(n);
            scan.pose.reset();
            (poses == Poses::kMap ? scan.pose : scan.odometry) = lap().odometry[n];
            scans.push_back(std::move(scan));
        }
        send(std::move(scans), poses, name);
    }

    /// Sends scans of the robot, and waits until none of them is moving.
    void send(std::vector<Scan> scans, Poses poses, const std::string& name) {
        const auto session = registry_.find(name);
        const auto link = join_as(poses, scans.back().seq, name);
        session->submit(link, lap().laser, 0);
        session->submit(link, std::move(scans), 1);
        link->wait();
        EXPECT_EQ(get(fmt::format("/api/v1/sessions/{}/digest", name)).status, Status::ok);
    }

    static double stamp_of(std::size_t scan) { return 100.0 + static_cast<double>(scan) / 10.0; }

    boost::json::value localization() {
        return get_json("/api/v1/sessions/a").at("robots").as_array().at(0).at("localization");
    }
};

} // namespace scanloom::http
