// Sends one scan to a Scanloom server: ./send_scan 127.0.0.1:7447
#include <scanloom/client.hpp>

#include <iostream>
#include <numbers>

int main(int argc, char** argv) try {
    scanloom::robot::ClientOptions options;
    options.server = argc > 1 ? argv[1] : "127.0.0.1:7447";
    options.session = "example";
    options.robot = "cpp";
    options.on_message = [](const std::string& news) { std::cerr << news << '\n'; };
    const auto robot = scanloom::robot::Client::start(options).value();

    const auto laser = std::make_shared<scanloom::Sensor>();
    laser->name = "laser";
    laser->mount = {.x = 0.1, .y = 0.0, .yaw = 0.0}; // 10 cm ahead of the robot's centre
    laser->angles =
        scanloom::UniformAngles{.first = -std::numbers::pi, .increment = std::numbers::pi / 180, .count = 360};
    laser->range_min = 0.05;
    laser->range_max = 12.0;

    const std::vector<float> metres(360, 2.0F); // from the laser's driver; here as in a round room

    scanloom::Scan scan;
    scan.stamp = 0.0;                               // seconds
    scan.pose = {.x = 1.0, .y = 0.5, .yaw = 0.785}; // of the robot in the map: metres, radians
    scan.ranges = scanloom::to_ranges_mm(metres);
    robot->send(laser, scan).value();               // returns at once; the client's thread sends
    robot->flush(std::chrono::seconds(10)).value(); // until all is stored
    std::cout << robot->status().acknowledged << " scans are stored\n";
    robot->close(std::chrono::seconds(10)).value();
} catch (const scanloom::ErrorException& failure) {
    std::cerr << "send_scan: " << failure.what() << '\n';
    return 1;
}
