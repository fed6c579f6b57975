#include "server/http/handlers/handlers.hpp"

#include "common/wire/log_codec.hpp"
#include "server/exchange/carmen_text.hpp"
#include "server/http/handlers/lookup.hpp"
#include "server/http/response.hpp"
#include "server/http/text.hpp"

#include <boost/endian/conversion.hpp>
#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

namespace scanloom::http {
namespace {

constexpr std::size_t kPieceBytes = std::size_t{64} << 10;

/// Writes entries in one of the formats.
class Format {
public:
    Format() = default;
    Format(const Format&) = delete;
    Format& operator=(const Format&) = delete;
    virtual ~Format() = default;

    [[nodiscard]] virtual std::string head() const = 0;
    [[nodiscard]] virtual Result<> append(std::string& text, std::string_view entry) = 0;
};

class ProtobufFormat final : public Format {
public:
    [[nodiscard]] std::string head() const override { return {}; }
    [[nodiscard]] Result<> append(std::string& text, std::string_view bytes) override {
        const auto entry = wire::plain_entry(bytes);
        if (!entry) return entry.error();
        std::array<unsigned char, 4> length{};
        boost::endian::store_big_u32(length.data(), static_cast<std::uint32_t>(entry->size()));
        text.append(reinterpret_cast<const char*>(length.data()), length.size()).append(*entry);
        return {};
    }
};

class CarmenFormat final : public Format {
public:
    explicit CarmenFormat(const session::SessionInfo& session)
        : session_(session.name), carmen_(session::scan_filter_of(session)) {}

    [[nodiscard]] std::string head() const override { return exchange::CarmenText::head(session_); }
    [[nodiscard]] Result<> append(std::string& text, std::string_view bytes) override {
        const auto entry = wire::decode_entry(bytes);
        if (!entry) return Error{Errc::kDataLoss, entry.error().message};
        const auto lines = carmen_.lines(*entry);
        if (!lines) return lines.error();
        text += *lines;
        return {};
    }

private:
    std::string session_;
    exchange::CarmenText carmen_;
};

/// Reads a log piece by piece. Between two pieces it keeps only the position at which to continue.
class LogStream final : public BodyStream {
public:
    LogStream(std::shared_ptr<session::Session> session, store::ScanLog& log, std::unique_ptr<Format> format)
        : session_(std::move(session)), log_(log), format_(std::move(format)), newest_(session_->snapshot()->revision),
          piece_(format_->head()) {}

    /// Reads the first piece, so that a log that cannot be written is reported before anything is sent.
    [[nodiscard]] Result<> begin() { return read(); }

    [[nodiscard]] Result<std::string> next() override {
        if (piece_.empty()) {
            if (auto done = read(); !done) return done.error();
        }
        return std::exchange(piece_, {});
    }

private:
    [[nodiscard]] Result<> read() {
        if (read_ == newest_) return {};
        return log_.read(session_->info().id, read_, [&](Revision revision, std::string_view bytes) -> store::Visited {
            if (revision > newest_ || piece_.size() >= kPieceBytes) return store::Visit::kStop;
            if (auto appended = format_->append(piece_, bytes); !appended) return appended;
            read_ = revision;
            return {};
        });
    }

    std::shared_ptr<session::Session> session_;
    store::ScanLog& log_;
    std::unique_ptr<Format> format_;
    const Revision newest_;
    Revision read_ = 0;
    std::string piece_; // read and not yet returned
};

} // namespace

Result<Response> get_log(Context& context) {
    if (auto known = context.query.check_only({"format"}); !known) return known.error();
    const auto format = context.query.find("format").value_or("protobuf");
    const bool is_carmen = format == "clf";
    if (!is_carmen && format != "protobuf") {
        return Error{Errc::kInvalidField,
                     fmt::format("format is {}; possible are clf and protobuf", in_quotes(format))};
    }
    const auto& session = context.session;
    if (!session) return session.error();
    const auto& info = (*session)->info();

    std::unique_ptr<Format> written_as = std::make_unique<ProtobufFormat>();
    if (is_carmen) written_as = std::make_unique<CarmenFormat>(info);
    auto stream = std::make_shared<LogStream>(*session, context.services.log, std::move(written_as));
    if (auto begun = stream->begin(); !begun) return begun.error();

    Response response;
    response.set("Content-Type", is_carmen ? "text/plain; charset=utf-8" : "application/octet-stream")
        .set("Content-Disposition",
             fmt::format("attachment; filename=\"{}.{}\"", info.name, is_carmen ? "clf" : "scanlog"))
        .set("Cache-Control", kNotKept);
    response.stream = std::move(stream);
    return response;
}

} // namespace scanloom::http
