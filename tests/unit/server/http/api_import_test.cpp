#include "tests/unit/server/http/api_fixture.hpp"

namespace scanloom::http {
namespace {

constexpr std::string_view kYaml = "image: map.pgm\nresolution: 0.1\norigin: [-0.2, 0, 0]\n";
constexpr std::string_view kImage = "P2\n4 2\n255\n0 254 254 205\n254 254 254 254\n";

class ApiImportTest : public ApiTest {
protected:
    Response import(const std::string& session, const std::vector<std::pair<std::string, std::string>>& fields) {
        Request request;
        request.method = "POST";
        request.target = "/api/v1/sessions/" + session + "/import";
        request.content_type = "multipart/form-data; boundary=b";
        for (const auto& [name, content] : fields) {
            request.body += "--b\r\nContent-Disposition: form-data; name=\"" + name + "\"\r\n\r\n" + content + "\r\n";
        }
        request.body += "--b--\r\n";
        return answer(api_, request);
    }

    static std::pair<std::string, std::string> yaml() { return {"yaml", std::string(kYaml)}; }
    static std::pair<std::string, std::string> image() { return {"image", std::string(kImage)}; }
};

TEST_F(ApiImportTest, CreatesASessionThatAcceptsScans) {
    const auto made = import("depot", {yaml(), image()});
    ASSERT_EQ(made.status, Status::created) << made.body.bytes();
    EXPECT_EQ(made.get("Location"), "/api/v1/sessions/depot");
    EXPECT_EQ(boost::json::parse(made.body.bytes()).at("config").at("cell_size"), 0.1);
    EXPECT_EQ(std::string(get("/api/v1/sessions/depot/map.csv").body.bytes()), "100,0,0,-1\n0,0,0,0\n");
    EXPECT_EQ(std::string(get("/api/v1/sessions/depot/map.csv?layer=himm").body.bytes()), "15,0,0,-1\n0,0,0,0\n");
    EXPECT_THAT(std::string(get("/api/v1/sessions/depot/map.yaml").body.bytes()), HasSubstr("origin: [-0.2, 0, 0]"));
    stream("depot", 2);
    EXPECT_EQ(get_json("/api/v1/sessions/depot").at("scans"), 2);
    EXPECT_THAT(detail(get("/api/v1/sessions/depot/log?format=clf"), Status::conflict), HasSubstr("imported"));
}

TEST_F(ApiImportTest, FormFieldsSetTheSessionSettings) {
    ASSERT_EQ(import("depot", {yaml(), image(), {"cell_size", "0.05"}, {"ray_model", "traversal"}}).status,
              Status::created);
    const auto config = get_json("/api/v1/sessions/depot").at("config");
    EXPECT_EQ(config.at("cell_size"), 0.05);
    EXPECT_EQ(config.at("ray_model"), "traversal");
    EXPECT_EQ(std::string(get("/api/v1/sessions/depot/map.csv").body.bytes()),
              "100,100,0,0,0,0,-1,-1\n100,100,0,0,0,0,-1,-1\n0,0,0,0,0,0,0,0\n0,0,0,0,0,0,0,0\n");
}

TEST_F(ApiImportTest, RobotsAreOnlyLocatedIfTheFormSaysSo) {
    ASSERT_EQ(import("depot", {yaml(), image(), {"localize_only", "true"}}).status, Status::created);
    EXPECT_EQ(get_json("/api/v1/sessions/depot").at("localize_only"), true);
    const auto map = std::string(get("/api/v1/sessions/depot/map.csv").body.bytes());
    stream("depot", 2);
    EXPECT_EQ(get_json("/api/v1/sessions/depot").at("scans"), 2);
    EXPECT_EQ(std::string(get("/api/v1/sessions/depot/map.csv").body.bytes()), map);
    ASSERT_EQ(import("open", {yaml(), image(), {"localize_only", "false"}}).status, Status::created);
    EXPECT_EQ(get_json("/api/v1/sessions/open").at("localize_only"), false);
}

TEST_F(ApiImportTest, InvalidFormsCreateNoSession) {
    const auto refused = [&](const std::vector<std::pair<std::string, std::string>>& fields, Status status) {
        return detail(import("depot", fields), status);
    };
    EXPECT_THAT(refused({yaml()}, Status::bad_request), HasSubstr("image is missing"));
    EXPECT_THAT(refused({image()}, Status::bad_request), HasSubstr("yaml is missing"));
    EXPECT_THAT(refused({yaml(), image(), {"cell_size", "7"}}, Status::bad_request), HasSubstr("cell_size is 7"));
    EXPECT_THAT(refused({{"yaml", "resolution: 2\norigin: [0, 0, 0]\n"}, image()}, Status::bad_request),
                HasSubstr("2 metres per pixel, which is no valid cell size; add the field cell_size"));
    EXPECT_THAT(refused({yaml(), image(), {"colour", "7"}}, Status::bad_request), HasSubstr("colour"));
    EXPECT_THAT(refused({yaml(), image(), {"localize_only", "1"}}, Status::bad_request),
                HasSubstr("localize_only is neither true nor false"));
    EXPECT_THAT(refused({{"yaml", "x"}, image()}, Status::bad_request), HasSubstr("yaml"));
    EXPECT_THAT(refused({yaml(), {"image", "x"}}, Status::bad_request), HasSubstr("image"));
    EXPECT_EQ(get("/api/v1/sessions/depot").status, Status::not_found);
    EXPECT_EQ(detail(ask("POST", "/api/v1/sessions/depot/import", "{}"), Status::unsupported_media_type),
              "the body is \"application/json\"; send Content-Type: multipart/form-data");
    create("depot");
    EXPECT_THAT(refused({yaml(), image()}, Status::conflict), HasSubstr("exists already"));
}

TEST_F(ApiImportTest, FailedStoreLeavesNoPartialSession) {
    log_.fail_from_next_change({Errc::kStoreFailed, "the disk is full"});
    EXPECT_EQ(import("depot", {yaml(), image()}).status, Status::service_unavailable);
    EXPECT_EQ(get("/api/v1/sessions/depot").status, Status::not_found);
}

} // namespace
} // namespace scanloom::http
