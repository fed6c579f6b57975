#include "tests/unit/proto/field_numbers.hpp"

#include "scanloom/v1/frame.pb.h"
#include "scanloom/v1/live.pb.h"
#include "scanloom/v1/log.pb.h"
#include "scanloom/v1/scan.pb.h"
#include "scanloom/v1/session.pb.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <google/protobuf/descriptor.pb.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

namespace scanloom::proto {
namespace {

namespace pb = google::protobuf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kFieldNumbersFile = SCANLOOM_SOURCE_DIR "/tests/unit/proto/field_numbers.txt";

std::string field_numbers_text() {
    std::ifstream file(kFieldNumbersFile);
    return {std::istreambuf_iterator<char>(file), {}};
}

TEST(FieldNumbers, AreNeitherReusedNorChanged) {
    const std::vector<const pb::FileDescriptor*> files = {
        v1::Frame::descriptor()->file(), v1::LogEntry::descriptor()->file(), v1::Scan::descriptor()->file(),
        v1::SessionConfig::descriptor()->file(), v1::LiveEvent::descriptor()->file()};
    for (const auto& complaint : complaints_about(files, field_numbers_text())) {
        ADD_FAILURE() << complaint << "\n(the list is " << kFieldNumbersFile << ")";
    }
}

/// A small file whose fields a test changes, compared with its earlier state.
class FieldNumbersOf : public testing::Test {
protected:
    void SetUp() override {
        file_.set_name("a.proto");
        file_.set_syntax("proto3");
        auto* message = file_.add_message_type();
        message->set_name("M");
        add_field("x", 1, pb::FieldDescriptorProto::TYPE_DOUBLE);
        add_field("y", 2, pb::FieldDescriptorProto::TYPE_UINT32);
        auto* type = file_.add_enum_type();
        type->set_name("E");
        type->add_value()->set_name("E_NONE");
        type->mutable_value(0)->set_number(0);
        list_ = fmt::format("# earlier state\n{}\n", fmt::join(lines_of({build()}), "\n"));
    }

    void add_field(const std::string& name, int number, pb::FieldDescriptorProto::Type type) {
        auto* field = message().add_field();
        field->set_name(name);
        field->set_number(number);
        field->set_type(type);
        field->set_label(pb::FieldDescriptorProto::LABEL_OPTIONAL);
    }

    pb::DescriptorProto& message() { return *file_.mutable_message_type(0); }
    pb::FieldDescriptorProto& field(int index) { return *message().mutable_field(index); }

    void reserve(int number) {
        auto* range = message().add_reserved_range();
        range->set_start(number);
        range->set_end(number + 1);
    }

    const pb::FileDescriptor* build() {
        pool_ = std::make_unique<pb::DescriptorPool>();
        return pool_->BuildFile(file_);
    }

    std::vector<std::string> complaints() { return complaints_about({build()}, list_); }

private:
    pb::FileDescriptorProto file_;
    std::unique_ptr<pb::DescriptorPool> pool_;
    std::string list_;
};

TEST_F(FieldNumbersOf, UnchangedFileHasNoComplaints) { EXPECT_THAT(complaints(), IsEmpty()); }

TEST_F(FieldNumbersOf, ChangedNumberIsRefused) {
    field(1).set_number(3);
    EXPECT_THAT(complaints(), ElementsAre(HasSubstr("M.y = 3 : uint32 was M.y = 2 : uint32")));
}

TEST_F(FieldNumbersOf, ChangedTypeIsRefused) {
    field(1).set_type(pb::FieldDescriptorProto::TYPE_FIXED32);
    EXPECT_THAT(complaints(), ElementsAre(HasSubstr("M.y = 2 : fixed32 was M.y = 2 : uint32")));
}

TEST_F(FieldNumbersOf, FieldThatBecomesRepeatedIsRefused) {
    field(0).set_label(pb::FieldDescriptorProto::LABEL_REPEATED);
    EXPECT_THAT(complaints(), ElementsAre(HasSubstr("repeated")));
}

TEST_F(FieldNumbersOf, RemovedFieldNeedsAReservedNumber) {
    message().mutable_field()->RemoveLast();
    EXPECT_THAT(complaints(), ElementsAre(HasSubstr("M.y is gone; write `reserved 2;`")));
    reserve(2);
    EXPECT_THAT(complaints(), IsEmpty());
}

TEST_F(FieldNumbersOf, ReusedNumberOfARemovedFieldIsRefused) {
    message().mutable_field()->RemoveLast();
    add_field("z", 2, pb::FieldDescriptorProto::TYPE_UINT32);
    EXPECT_THAT(complaints(), ElementsAre(HasSubstr("M.y is gone"), HasSubstr("M.z = 2 : uint32 is not listed")));
}

TEST_F(FieldNumbersOf, NewFieldMustBeListed) {
    add_field("z", 3, pb::FieldDescriptorProto::TYPE_BOOL);
    EXPECT_THAT(complaints(), ElementsAre(HasSubstr("M.z = 3 : bool is not listed; add this line")));
}

} // namespace
} // namespace scanloom::proto
