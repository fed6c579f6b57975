#include "common/archive/archive.hpp"

#include "common/geometry/pose2.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <deque>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace scanloom::archive {
namespace {

enum class Color : std::uint8_t { kRed, kGreen };

class Counter {
public:
    Counter() = default;
    explicit Counter(int count) : count_(count), twice_(2 * count) {}

    [[nodiscard]] int twice() const { return twice_; }

    template <class Self, class Archive>
    static void list(Self& self, Archive& archive) {
        archive(self.count_);
        if constexpr (Archive::kReads) self.twice_ = 2 * self.count_;
    }

private:
    int count_ = 0;
    int twice_ = 0; // follows from it
};

struct Everything {
    bool is_on = false;
    Color color = Color::kRed;
    float narrow = 0.0F;
    std::size_t number = 0;
    std::optional<double> known;
    std::optional<double> unknown = 1.0;
    std::vector<bool> flags;
    std::deque<Pose2> poses;
    std::map<std::uint32_t, std::vector<Color>> colors;
    std::vector<Counter> counters;
    std::shared_ptr<const Pose2> shared;
    std::shared_ptr<const Pose2> same;
    std::shared_ptr<const Pose2> other;
};

Everything everything() {
    const auto shared = std::make_shared<const Pose2>(Pose2{1.0, 2.0, 3.0});
    return {true,
            Color::kGreen,
            -0.0F,
            std::numeric_limits<std::size_t>::max(),
            0.1,
            std::nullopt,
            {true, false},
            {{0.5, 0.25, -1.0}, {}},
            {{7, {Color::kGreen}}, {9, {}}},
            {Counter(3)},
            shared,
            shared,
            std::make_shared<const Pose2>()};
}

std::string bytes_of(const auto& value) {
    Writer writer;
    writer(value);
    return std::move(writer).take();
}

TEST(Archive, ReadsWhatItWrote) {
    const std::string bytes = bytes_of(everything());
    Reader reader(bytes);
    Everything read;
    reader(read);
    ASSERT_TRUE(reader.complete());
    EXPECT_EQ(bytes_of(read), bytes) << "bit by bit";
    EXPECT_EQ(read.known, 0.1);
    EXPECT_FALSE(read.unknown);
    EXPECT_EQ(read.poses.front(), (Pose2{0.5, 0.25, -1.0}));
    EXPECT_EQ(read.colors.at(7), std::vector{Color::kGreen});
    EXPECT_EQ(read.counters.at(0).twice(), 6);
    EXPECT_EQ(read.shared, read.same) << "one object, as before";
    EXPECT_NE(read.shared, read.other);
    EXPECT_EQ(*read.shared, (Pose2{1.0, 2.0, 3.0}));
}

TEST(Archive, IntegersAreLittleEndian) { EXPECT_EQ(bytes_of(std::uint32_t{0x01020304}), std::string("\4\3\2\1")); }

TEST(Archive, ObjectsThatTheReaderHasAreNotWritten) {
    const std::vector<std::shared_ptr<const Pose2>> known{std::make_shared<const Pose2>(),
                                                          std::make_shared<const Pose2>(Pose2{1.0, 2.0, 3.0})};
    Writer writer;
    writer.share(known);
    writer(known[1]);
    const std::string bytes = std::move(writer).take();
    EXPECT_EQ(bytes.size(), 8U);
    Reader reader(bytes);
    reader.share(known);
    std::shared_ptr<const Pose2> read;
    reader(read);
    EXPECT_TRUE(reader.complete());
    EXPECT_EQ(read, known[1]);
}

template <class Value>
bool is_read(const std::string& bytes) {
    Reader reader(bytes);
    Value value{};
    reader(value);
    return reader.complete();
}

TEST(Archive, TruncatedBytesAreRefused) {
    const std::string bytes = bytes_of(everything());
    ASSERT_TRUE(is_read<Everything>(bytes));
    for (std::size_t kept = 0; kept < bytes.size(); ++kept) {
        EXPECT_FALSE(is_read<Everything>(bytes.substr(0, kept))) << kept << " bytes";
    }
    EXPECT_FALSE(is_read<Everything>(bytes + '\0'));
}

TEST(Archive, ImpossibleValuesAreRefused) {
    EXPECT_TRUE(is_read<bool>("\1"));
    EXPECT_FALSE(is_read<bool>("\2"));
    EXPECT_FALSE(is_read<double>(bytes_of(std::numeric_limits<double>::quiet_NaN())));
    EXPECT_TRUE(is_read<double>(bytes_of(std::numeric_limits<double>::infinity())));
    EXPECT_FALSE(is_read<Pose2>(bytes_of(Pose2{std::numeric_limits<double>::infinity(), 0.0, 0.0}))) << "not finite";
    EXPECT_FALSE(is_read<std::vector<double>>(bytes_of(std::uint64_t{1} << 60))) << "more items than bytes";
    EXPECT_FALSE(is_read<std::shared_ptr<const Pose2>>(bytes_of(std::uint64_t{1})))
        << "the second object, without a first";
}

TEST(Archive, ObjectsOfAnotherTypeAreRefused) {
    const std::vector<std::shared_ptr<const Color>> known{std::make_shared<const Color>()};
    const std::string bytes = bytes_of(std::uint64_t{0});
    Reader reader(bytes);
    reader.share(known);
    std::shared_ptr<const Pose2> read;
    reader(read);
    EXPECT_TRUE(reader.failed());
}

} // namespace
} // namespace scanloom::archive
