#include "load/core/figure_text.hpp"
#include "load/core/live_view.hpp"
#include "load/core/report.hpp"

#include <boost/json/parse.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

namespace scanloom::load {
namespace {

using testing::Each;
using testing::HasSubstr;
using testing::Not;

TEST(FigureText, FormatsNumbersForReaders) {
    EXPECT_EQ(grouped(0), "0");
    EXPECT_EQ(grouped(999), "999");
    EXPECT_EQ(grouped(1'000), "1,000");
    EXPECT_EQ(grouped(1'234'567), "1,234,567");
    EXPECT_EQ(whole(999.6), "1,000");
    EXPECT_EQ(whole(-0.1), "0");
    EXPECT_EQ(as_milliseconds(420), "0.42");
    EXPECT_EQ(as_milliseconds(9'994), "9.99");
    EXPECT_EQ(as_milliseconds(9'996), "10.0");
    EXPECT_EQ(as_milliseconds(99'949), "99.9");
    EXPECT_EQ(as_milliseconds(99'960), "100");
    EXPECT_EQ(as_milliseconds(4'567'000), "4,567");
    EXPECT_EQ(as_bytes(512), "512 B");
    EXPECT_EQ(as_bytes(1'023), "1023 B");
    EXPECT_EQ(as_bytes(1'536), "1.5 KiB");
    EXPECT_EQ(as_bytes(831.2 * (1 << 20)), "831 MiB");
    EXPECT_EQ(as_bytes(2.5e3 * (1ULL << 40)), "2,500 TiB");
}

std::unique_ptr<RunReport> report() {
    auto made = std::make_unique<RunReport>();
    made->settings = {.robots = 20,
                      .sessions = 20,
                      .rate = 10.0,
                      .duration = 30.0,
                      .world = "office",
                      .laser = "reference",
                      .noise = "none",
                      .beams = 684,
                      .seed = 1};
    made->seconds = made->watched_seconds = 30.0;
    made->fleet.scans_due = made->fleet.scans_sent = made->fleet.scans_acknowledged = 6000;
    made->fleet.greeted = 20;
    made->fleet.links = 20;
    made->fleet.from_intended.record(4'200, 6000);
    made->fleet.from_sending.record(4'000, 6000);
    made->fleet.own_delay.record(300, 6000);
    made->own = {3.0, 20.0 * (1 << 20)};
    made->server = ServerUsed{6.0, 120.0 * (1 << 20)};
    made->verdict = {true, "nothing lost"};
    return made;
}

TEST(Report, ContainsTheUseOfEachPartyAndTheVerdict) {
    const auto text = to_text(*report());
    EXPECT_THAT(text, HasSubstr("20 robots at 10 scans/s for 30 s into 20 sessions"));
    EXPECT_THAT(text, HasSubstr("6,000 sent, 6,000 acknowledged: 200/s of 200/s intended"));
    EXPECT_THAT(text, HasSubstr("generator  0.10 cores"));
    EXPECT_THAT(text, HasSubstr("on schedule"));
    EXPECT_THAT(text, HasSubstr("server     0.20 cores, 1000 us of CPU per acknowledged scan, memory 120 MiB"));
    EXPECT_THAT(text, Not(HasSubstr("viewers")));
    EXPECT_THAT(text, Not(HasSubstr("faults")));
    EXPECT_THAT(text, testing::EndsWith("\nnothing lost\n"));
}

TEST(Report, DistinguishesASlowGeneratorFromASlowServer) {
    auto late = report();
    late->fleet.own_delay.record(kOwnDelayFine * 3, 1000);
    EXPECT_THAT(to_text(*late), HasSubstr("IT FELL BEHIND"));
    auto slow_server = report();
    slow_server->fleet.from_intended.record(5 * kSecond, 6000);
    EXPECT_THAT(to_text(*slow_server), HasSubstr("on schedule"));
}

TEST(Report, ContainsFaultsViewersAndTilesIfUsed) {
    auto made = report();
    made->settings.viewers = 3;
    made->settings.tile_readers = 1;
    made->audience.viewers_let_in = 3;
    made->audience.events = 900;
    made->audience.tile_requests = 600;
    made->audience.tiles_unchanged = 150;
    made->fleet.faults = {5, 0, 2};
    made->fleet.links = 26;
    made->fleet.scans_resent = 17;
    const auto text = to_text(*made);
    EXPECT_THAT(text, HasSubstr("3 watched: 900 events, 10.0/s each"));
    EXPECT_THAT(text, HasSubstr("1 reader requested: 600 tiles, 20/s, 25 % of them unchanged (304)"));
    EXPECT_THAT(text, HasSubstr("faults on demand: 5 cut, 2 stall; 6 reconnects, 17 scans sent again"));
}

TEST(Report, AveragesExcludeRefusedViewers) {
    auto made = report();
    made->settings.viewers = 600;
    made->audience.viewers_let_in = 512;
    made->audience.viewers_refused = 86;
    made->audience.events = 512 * 300;
    made->audience.trouble = "a viewer of session load-1-0: there are 512 viewers";
    const auto text = to_text(*made);
    EXPECT_THAT(text, HasSubstr("512 of 600 watched: 153,600 events, 10.0/s each"));
    EXPECT_THAT(text, HasSubstr("; 86 REFUSED; 2 HAD NO CONNECTION"));
    EXPECT_THAT(text, HasSubstr("trouble    a viewer of session load-1-0: there are 512 viewers\n"));
    const auto json = boost::json::parse(to_json(*made));
    EXPECT_EQ(json.at("audience").at("viewers_let_in").to_number<int>(), 512);
    EXPECT_EQ(json.at("audience").at("viewers_refused").to_number<int>(), 86);
    made->audience = {};
    EXPECT_THAT(to_text(*made), HasSubstr("0 of 600 watched: 0 events, 0.0/s each"));
}

TEST(Report, OmitsTheCpuOfARestartedServer) {
    auto made = report();
    made->server->cpu_seconds.reset();
    EXPECT_THAT(to_text(*made),
                HasSubstr("server     was restarted during the run, so its CPU time is unknown; memory 120 MiB"));
    const auto server = boost::json::parse(to_json(*made)).at("server").as_object();
    EXPECT_EQ(server.size(), 1U);
    EXPECT_TRUE(server.contains("resident_bytes"));
}

TEST(Report, OmitsLatenciesWithoutIntendedTimes) {
    auto made = report();
    EXPECT_TRUE(boost::json::parse(to_json(*made)).as_object().contains("own_delay"));
    made->settings.rate = 0.0;
    const auto json = boost::json::parse(to_json(*made)).as_object();
    for (const auto* name : {"ack_from_intended", "sending_from_intended", "own_delay"}) {
        EXPECT_FALSE(json.contains(name)) << name;
    }
    EXPECT_TRUE(json.contains("ack_from_sending"));
    EXPECT_THAT(to_text(*made), Not(HasSubstr("intended")));
}

TEST(Report, JsonContainsShortDecimalNumbers) {
    auto made = report();
    made->own.cpu_seconds = 0.0015; // 0.00005 cores
    const auto json = to_json(*made);
    EXPECT_THAT(json, HasSubstr("\"rate\":10,"));
    EXPECT_THAT(json, HasSubstr("\"resident_bytes\":20971520}"));
    EXPECT_THAT(json, HasSubstr("\"cores\":0.00005,"));
    EXPECT_THAT(json, HasSubstr("\"p50_ms\":4.2,"));
}

TEST(Report, JsonContainsTheSameFigures) {
    auto made = report();
    made->evidence.contradictions = {"a \"quoted\" one"};
    const auto json = boost::json::parse(to_json(*made));
    EXPECT_EQ(json.at("scans").at("acknowledged").to_number<int>(), 6000);
    EXPECT_EQ(json.at("scans").at("acknowledged_per_second").to_number<double>(), 200.0);
    EXPECT_EQ(json.at("ack_from_intended").at("p99_ms").to_number<double>(), 4.2);
    EXPECT_EQ(json.at("server").at("cpu_us_per_scan").to_number<double>(), 1000.0);
    EXPECT_EQ(json.at("generator").at("cores").to_number<double>(), 0.1);
    EXPECT_TRUE(json.at("verdict").at("nothing_lost").as_bool());
    EXPECT_EQ(json.at("verdict").at("against").at(0).as_string(), "a \"quoted\" one");
    EXPECT_TRUE(json.at("settings").at("cell_size").is_null());
    made->seconds = made->watched_seconds = 0.0; // nothing was streamed
    EXPECT_EQ(boost::json::parse(to_json(*made)).at("generator").at("cores").to_number<double>(), 0.0);
    EXPECT_THAT(to_text(*made), Not(HasSubstr("inf")));
    made->server.reset();
    EXPECT_TRUE(boost::json::parse(to_json(*made)).at("server").as_object().empty());
}

TEST(Report, CoresAreAveragedOverTheObservedTime) {
    auto made = report();
    made->seconds = 0.5; // the last acknowledgement came early, and then none for a long time
    const auto json = boost::json::parse(to_json(*made));
    EXPECT_EQ(json.at("generator").at("cores").to_number<double>(), 0.1);
    EXPECT_EQ(json.at("server").at("cores").to_number<double>(), 0.2);
    EXPECT_THAT(to_text(*made), HasSubstr("0.10 cores"));
    EXPECT_THAT(to_text(*made), HasSubstr("0.20 cores"));
}

TEST(FigureText, HarmlessRemovesControlCharacters) {
    EXPECT_EQ(harmless("a\x1b[31mred\r\nline\x7f, caf\u00e9"), "a?[31mred??line?, caf\u00e9");
}

TEST(LiveView, ShowsTheLastSecond) {
    auto before = std::make_unique<Moment>();
    auto now = std::make_unique<Moment>();
    before->at = 10 * kSecond;
    now->at = 11 * kSecond;
    before->fleet.linked = 17;
    before->fleet.finished = 1;
    before->fleet.scans_sent = 900;
    before->fleet.scans_acknowledged = 890;
    before->fleet.from_intended.record(900 * kMillisecond, 890);
    now->fleet = before->fleet;
    now->fleet.scans_sent = 1'100;
    now->fleet.scans_acknowledged = 1'050;
    now->fleet.from_intended.record(2 * kMillisecond, 160);
    now->own.cpu_seconds = 0.25;
    before->server = ServerUse{{1.0, 1e6}, 1234.5};
    now->server = ServerUse{{1.5, 2.0 * (1 << 20)}, 1234.5};
    const auto asked = report()->settings;
    const auto line = live_line(asked, kSecond, *before, *now);
    EXPECT_THAT(line, HasSubstr("10 of 30 s: 200/s sent, 160/s acknowledged, 50 in flight; ack p50 2.00  p99 2.00"));
    EXPECT_THAT(line, HasSubstr("generator 0.25 cores, server 0.50 cores, 2.0 MiB; 2 of 20 robots have no link"));
    now->at = 45 * kSecond;
    EXPECT_THAT(live_line(asked, kSecond, *before, *now), testing::StartsWith("14 s after the last scan: "));
    const auto rows = live_table(asked, kSecond, *before, *now);
    EXPECT_EQ(rows.size(), 8U);
    EXPECT_THAT(rows, Each(testing::SizeIs(testing::Lt(80U))));
    EXPECT_THAT(rows, testing::Contains(HasSubstr("ack           p50 2.00")));
    now->server = ServerUse{{1.5, 2.0 * (1 << 20)}, 1244.5};
    EXPECT_THAT(live_line(asked, kSecond, *before, *now), HasSubstr("server restarted, 2.0 MiB"));
    before->server.reset();
    EXPECT_THAT(live_line(asked, kSecond, *before, *now), HasSubstr("server does not report its use"));
}

} // namespace
} // namespace scanloom::load
