#include "tests/support/temporary_directory.hpp"
#include "tests/unit/server/http/api_fixture.hpp"

/// Backups over HTTP, of a store on a disk.
namespace scanloom::http {
namespace {

class ApiBackupsTest : public ApiTest {
protected:
    TemporaryDirectory directory_;
    std::unique_ptr<store::ScanLog> disk_ = store::open_rocksdb(directory_.path() / "store").value();
    std::unique_ptr<store::Backups> backups_ = store::Backups::open(directory_.path() / "backups", 2, *disk_).value();
    TestApi over_disk_{registry_, weaves_, goals_, *disk_, metrics_, {authenticator_, audit_, logins_}, {}};

    Response ask_disk(std::string method, std::string target = "/api/v1/backups") {
        return answer(over_disk_,
                      {.method = std::move(method), .target = std::move(target), .content_type = "application/json"});
    }
};

TEST_F(ApiBackupsTest, AreCreatedAndListedBeforeRecoveryEnds) {
    over_disk_.services().backups = backups_.get();
    const auto made = ask_disk("POST");
    EXPECT_EQ(made.status, Status::created);
    const auto listed = boost::json::parse(ask_disk("GET").body.bytes());
    EXPECT_EQ(listed.at("kept"), 2);
    ASSERT_EQ(listed.at("backups").as_array().size(), 1U);
    EXPECT_EQ(listed.at("backups").at(0), boost::json::parse(made.body.bytes()));
    EXPECT_EQ(listed.at("backups").at(0).at("sessions"), 0);
    EXPECT_EQ(ask_disk("GET", "/api/v1/backups?odd=1").status, Status::bad_request);
}

} // namespace
} // namespace scanloom::http
