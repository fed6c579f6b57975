#include "server/http/content_coding.hpp"

#include "tests/support/temporary_directory.hpp"
#include "tests/unit/server/http/api_fixture.hpp"

#include <zlib.h>

#include <fstream>
#include <random>

namespace scanloom::http {
namespace {

/// Decompresses with zlib's gzip reader, which checks checksum and length.
std::string gunzipped(std::string_view bytes) {
    z_stream stream{};
    EXPECT_EQ(inflateInit2(&stream, 15 + 16), Z_OK);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(bytes.size());
    std::string text;
    int state = Z_OK;
    while (state == Z_OK) {
        std::array<char, 4096> piece{};
        stream.next_out = reinterpret_cast<Bytef*>(piece.data());
        stream.avail_out = piece.size();
        state = inflate(&stream, Z_NO_FLUSH);
        text.append(piece.data(), piece.size() - stream.avail_out);
    }
    EXPECT_EQ(state, Z_STREAM_END);
    EXPECT_EQ(stream.avail_in, 0U) << "no data follows";
    inflateEnd(&stream);
    return text;
}

TEST(AcceptsGzip, IfListedWithAWeight) {
    for (const auto* field : {"gzip", "GZip", "x-gzip", "deflate, gzip;q=1.0, *;q=0.5", "br,gzip", "*", "gzip;q=0.001",
                              "gzip ; q=0.5", ", gzip", "identity;q=0, *;q=0.1"}) {
        EXPECT_TRUE(accepts_gzip(field)) << field;
    }
}

TEST(AcceptsGzip, NotIfExcludedOrNotListed) {
    for (const auto* field : {"", "br", "deflate", "gzip;q=0", "gzip;q=0.000", "*;q=0", "*, gzip;q=0", "gzipped",
                              "gzip;q=2", "gzip;q=-1", "gzip;q=x", "gzip;level=1", "identity"}) {
        EXPECT_FALSE(accepts_gzip(field)) << field;
    }
}

TEST(GzipOf, DecompressesToTheInput) {
    std::mt19937 random(3);
    for (const std::size_t size : {1'400U, 100'000U, 3'000'000U}) {
        std::string text(size, ' ');
        for (char& c : text) c = static_cast<char>(random() % 200);
        const auto gzip = gzip_of("text/plain", text);
        ASSERT_TRUE(gzip);
        EXPECT_EQ(gunzipped(*gzip), text);
    }
}

TEST(EncodedFor, CompressesOnlyLargeTextsThatShrink) {
    std::mt19937 random(4);
    const auto coding = [](std::string_view type, std::string text) {
        return std::string(encoded_for("gzip", ok(type, Body(std::move(text)))).get("Content-Encoding"));
    };
    std::string noise(10'000, ' ');
    for (char& c : noise) c = static_cast<char>(random());
    EXPECT_EQ(coding("text/csv", std::string(10'000, '1')), "gzip");
    EXPECT_EQ(coding("application/json; charset=utf-8", std::string(10'000, '1')), "gzip");
    EXPECT_EQ(coding("text/csv", std::string(1'000, '1')), "");
    EXPECT_EQ(coding("image/png", std::string(10'000, '1')), "");
    EXPECT_EQ(coding("application/octet-stream", std::string(10'000, '1')), "");
    EXPECT_EQ(coding("text/csv", noise), "");
}

class ContentCodingTest : public ApiTest {
protected:
    Response ask_for(const std::string& target, const std::string& accept_encoding,
                     const std::string& if_none_match = "", const std::string& method = "GET") {
        Request request;
        request.method = method;
        request.target = target;
        request.accept_encoding = accept_encoding;
        request.if_none_match = if_none_match;
        return api_.answer(request);
    }
};

TEST_F(ContentCodingTest, MapTableIsCompressedIfAccepted) {
    create("a");
    stream("a", 3);
    const std::string table = "/api/v1/sessions/a/map.csv";
    const auto plain = ask_for(table, "");
    const auto compressed = ask_for(table, "gzip, br");
    EXPECT_EQ(plain.get("Content-Encoding"), "");
    EXPECT_EQ(plain.get("Vary"), "Accept-Encoding");
    EXPECT_EQ(compressed.get("Content-Encoding"), "gzip");
    EXPECT_EQ(compressed.get("Vary"), "Accept-Encoding");
    EXPECT_LT(compressed.body.bytes().size(), plain.body.bytes().size() / 4);
    EXPECT_EQ(gunzipped(compressed.body.bytes()), plain.body.bytes());
    EXPECT_EQ(compressed.get("ETag"), "W/" + std::string(plain.get("ETag")));
    EXPECT_EQ(ask_for(table, "gzip", std::string(compressed.get("ETag"))).status, Status::not_modified);
    EXPECT_EQ(ask_for(table, "gzip", "", "HEAD").body.bytes(), compressed.body.bytes()) << "HEAD has the fields of GET";
    EXPECT_EQ(ask_for("/api/v1/sessions/a/map.npy", "gzip").get("Content-Encoding"), "");
}

TEST_F(ContentCodingTest, ViewerFilesAreCompressedOnce) {
    TemporaryDirectory folder;
    std::filesystem::create_directory(folder.path() / "assets");
    const std::string script(10'000, '1');
    std::ofstream(folder.path() / "assets" / "a.js") << script;
    TestApi api(registry_, weaves_, goals_, log_, metrics_, {authenticator_, audit_, logins_},
                load_web_files(folder.path()).value());
    Request request;
    request.method = "GET";
    request.target = "/assets/a.js";
    const auto plain = answer(api, request);
    EXPECT_EQ(plain.body.bytes(), script);
    request.accept_encoding = "gzip";
    const auto first = api.answer(request);
    EXPECT_EQ(first.get("Content-Encoding"), "gzip");
    EXPECT_EQ(gunzipped(first.body.bytes()), script);
    EXPECT_EQ(api.answer(request).body.bytes().data(), first.body.bytes().data()) << "the same bytes each time";
    request.if_none_match = first.get("ETag");
    EXPECT_EQ(api.answer(request).status, Status::not_modified);
}

} // namespace
} // namespace scanloom::http
