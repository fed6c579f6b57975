#include "robot_client/lidars/hokuyo_scip.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::robot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<ScipReply> replies_of(const std::string& text, std::size_t piece = 1000) {
    ScipReader reader;
    std::vector<ScipReply> replies;
    for (std::size_t at = 0; at < text.size(); at += piece) {
        const std::string part = text.substr(at, piece);
        const std::vector<std::uint8_t> bytes(part.begin(), part.end());
        reader.feed(bytes);
        while (auto reply = reader.next()) replies.push_back(std::move(*reply));
    }
    return replies;
}

/// A reply to PP with these values.
ScipReply parameters(const std::vector<std::string>& settings) {
    ScipReply reply{"PP", "00", {}, false};
    for (const auto& setting : settings) reply.lines.push_back(setting + ";" + scip_sum(setting));
    return reply;
}

const std::vector<std::string> kUrg{"MODL:URG-04LX(Hokuyo Automatic Co.,Ltd.)",
                                    "DMIN:20",
                                    "DMAX:5600",
                                    "ARES:1024",
                                    "AMIN:44",
                                    "AMAX:725",
                                    "AFRT:384",
                                    "SCAN:600"};

TEST(Scip, CheckCharactersAreThoseOfTheSpecification) {
    EXPECT_EQ(scip_sum("DMIN:20"), '4');
    EXPECT_EQ(scip_sum("AMAX:725"), 'o');
    EXPECT_EQ(scip_sum("SCAN:600"), 'e');
    EXPECT_TRUE(has_scip_sum("00P"));
    EXPECT_TRUE(has_scip_sum("99b"));
    EXPECT_FALSE(has_scip_sum("99c"));
    EXPECT_FALSE(has_scip_sum(""));
}

TEST(Scip, NumbersHaveSixBitsPerCharacter) {
    EXPECT_EQ(decode_scip("1Dh"), 5432U) << "the example of the specification";
    EXPECT_EQ(decode_scip("CB"), 1234U);
    EXPECT_EQ(decode_scip("m2@0"), 16'000'000U);
    EXPECT_EQ(decode_scip("ooo"), 262'143U);
    EXPECT_EQ(decode_scip("0/0"), std::nullopt);
    EXPECT_EQ(decode_scip("0p0"), std::nullopt);
}

TEST(Scip, AnySplitOfTheBytesYieldsTheSameReplies) {
    const std::string text = "noise\n\n\nQT\n00P\n\nMD0000000101000\n99b\n00003\n1Dh1DhI\n\n";
    const auto replies = replies_of(text);
    EXPECT_THAT(replies, ElementsAre(ScipReply{"noise", "", {}, false}, ScipReply{"QT", "00", {}, false},
                                     ScipReply{"MD0000000101000", "99", {"00003", "1Dh1DhI"}, false}));
    for (std::size_t piece = 1; piece < 20; ++piece) EXPECT_EQ(replies_of(text, piece), replies) << piece;
}

TEST(Scip, ADamagedStatusIsMarked) {
    EXPECT_THAT(replies_of("QT\n00Q\n\n"), ElementsAre(ScipReply{"QT", "00", {}, true}));
    EXPECT_THAT(replies_of("SCIP2.0\n0\n\n"), ElementsAre(ScipReply{"SCIP2.0", "0", {}, false})) << "of SCIP 1";
}

TEST(Scip, EndlessLinesAreDropped) {
    EXPECT_THAT(replies_of(std::string(100'000, 'x') + "\n\nQT\n00P\n\n"),
                testing::Contains(ScipReply{"QT", "00", {}, false}));
}

TEST(HokuyoParameters, AreThoseOfTheSpecificationsExample) {
    const auto found = read_hokuyo_parameters(parameters(kUrg)).value();
    EXPECT_EQ(found.model, "URG-04LX(Hokuyo Automatic Co.,Ltd.)");
    EXPECT_EQ(found.range_min, 20);
    EXPECT_EQ(found.range_max, 5600);
    EXPECT_EQ(found.steps_per_turn, 1024);
    EXPECT_EQ(found.first_step, 44);
    EXPECT_EQ(found.last_step, 725);
    EXPECT_EQ(found.front_step, 384);
    EXPECT_EQ(found.rpm, 600);
    EXPECT_EQ(found.beams(), 682U);
}

TEST(HokuyoParameters, ImpossibleOrMissingOnesAreRefusedByName) {
    const std::vector<std::pair<std::string, std::string>> wrong{
        {"DMIN:x", "DMIN is 'x'"},   {"ARES:0", "ARES is '0'"},         {"AMAX:10000", "AMAX is '10000'"},
        {"SCAN:1", "SCAN is '1'"},   {"DMIN:5600", "DMIN is not less"}, {"AMIN:726", "AMIN is more"},
        {"AMAX:1100", "1057 steps"}, {"AMAX:", "AMAX is ''"},           {"DMAX:5600 ", "DMAX is '5600 '"},
    };
    for (const auto& [setting, message] : wrong) {
        auto settings = kUrg;
        for (auto& other : settings) {
            if (other.substr(0, 5) == setting.substr(0, 5)) other = setting;
        }
        const auto found = read_hokuyo_parameters(parameters(settings));
        ASSERT_FALSE(found) << setting;
        EXPECT_THAT(found.error().message, HasSubstr(message));
    }
    auto damaged = parameters(kUrg);
    damaged.lines[2].back() = '?';
    EXPECT_THAT(read_hokuyo_parameters(damaged).error().message, HasSubstr("DMAX is ''"));
}

TEST(HokuyoScan, ReadsTimeAndDistancesAcrossLines) {
    const auto line = [](std::string text) { return text + scip_sum(text); };
    const ScipReply reply{"MD", "99", {line("0011"), line("1Dh00"), line("7")}, false};
    const auto scan = read_hokuyo_scan(reply, 2).value();
    EXPECT_EQ(scan.milliseconds, 65U);
    EXPECT_THAT(scan.distances, ElementsAre(5432U, 7U));
    EXPECT_FALSE(read_hokuyo_scan(reply, 3)) << "another number of distances";
    auto damaged = reply;
    damaged.lines[1][0] = '2';
    EXPECT_THAT(read_hokuyo_scan(damaged, 2).error().message, HasSubstr("a check character is wrong"));
    EXPECT_FALSE(read_hokuyo_scan({"MD", "99", {line("001"), line("11Dh007")}, false}, 2))
        << "the time has its own line";
    EXPECT_FALSE(read_hokuyo_scan({"MD", "99", {line("0011"), line("1Dh00~")}, false}, 2)) << "no number";
    EXPECT_FALSE(read_hokuyo_scan({"MD", "99", {}, false}, 0));
}

} // namespace
} // namespace scanloom::robot
