#include "server/http/handlers/handlers.hpp"

#include "common/wire/log_codec.hpp"
#include "server/exchange/carmen_text.hpp"
#include "server/foxglove/log_recording.hpp"
#include "server/http/handlers/lookup.hpp"
#include "server/http/response.hpp"
#include "server/http/text.hpp"
#include "server/tiles/map_image.hpp"

#include <boost/endian/conversion.hpp>
#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

namespace scanloom::http {
namespace {

constexpr std::size_t kPieceBytes = std::size_t{64} << 10;

/// A format of a log.
struct LogFormat {
    std::string_view content_type;
    std::string_view ending; ///< of the file's name
    std::string head;        ///< before the first entry
    std::function<Result<>(std::string& text, std::string_view entry)> append;
    std::function<std::string()> tail = [] { return std::string(); }; ///< returns what follows the last entry
};

LogFormat protobuf_format() {
    return {"application/octet-stream", "scanlog", {}, [](std::string& text, std::string_view bytes) -> Result<> {
                const auto entry = wire::plain_entry(bytes);
                if (!entry) return entry.error();
                std::array<unsigned char, 4> length{};
                boost::endian::store_big_u32(length.data(), static_cast<std::uint32_t>(entry->size()));
                text.append(reinterpret_cast<const char*>(length.data()), length.size()).append(*entry);
                return {};
            }};
}

/// @param poses  of the scans that robots sent without
LogFormat carmen_format(const sessions::SessionInfo& session, const mapping::ScanPoses& poses) {
    return {"text/plain; charset=utf-8", "clf", exchange::CarmenText::head(session.name),
            [carmen = exchange::CarmenText(sessions::scan_filter_of(session)),
             poses](std::string& text, std::string_view bytes) mutable -> Result<> {
                auto entry = wire::decode_entry(bytes);
                if (!entry) return Error{Errc::kDataLoss, entry.error().message};
                poses.place(*entry);
                const auto lines = carmen.lines(*entry);
                if (!lines) return lines.error();
                text += *lines;
                return {};
            }};
}

/// @param permit  for the map at the end
LogFormat mcap_format(const sessions::SessionInfo& session, std::shared_ptr<const mapping::Snapshot> maps,
                      limits::Semaphore::Permit permit) {
    struct Writing {
        foxglove::LogRecording recording;
        std::shared_ptr<const mapping::Snapshot> maps;
        limits::Semaphore::Permit permit;
    };
    const auto writing = std::make_shared<Writing>(
        Writing{foxglove::LogRecording(sessions::scan_filter_of(session)), std::move(maps), std::move(permit)});
    return {"application/octet-stream",
            "mcap",
            {},
            [writing](std::string& bytes, std::string_view entry) -> Result<> {
                auto decoded = wire::decode_entry(entry);
                if (!decoded) return Error{Errc::kDataLoss, decoded.error().message};
                writing->maps->scan_poses.place(*decoded);
                if (auto added = writing->recording.add(*decoded); !added) return added.error();
                bytes += writing->recording.take();
                return {};
            },
            [writing] {
                writing->recording.finish(*writing->maps);
                return writing->recording.take();
            }};
}

/// Reads a log piece by piece. Between two pieces it keeps only the position at which to continue.
class LogStream final : public BodyStream {
public:
    LogStream(std::shared_ptr<sessions::Session> session, store::ScanLog& log, LogFormat format, Revision newest)
        : session_(std::move(session)), log_(log), format_(std::move(format)), newest_(newest), piece_(format_.head) {}

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
        if (is_complete_) return {};
        auto read =
            log_.read(session_->info().id, read_, [&](Revision revision, std::string_view bytes) -> store::Visited {
                if (revision > newest_ || piece_.size() >= kPieceBytes) return store::Visit::kStop;
                if (auto appended = format_.append(piece_, bytes); !appended) return appended;
                read_ = revision;
                return {};
            });
        is_complete_ = read && read_ == newest_;
        if (is_complete_) piece_ += format_.tail();
        return read;
    }

    std::shared_ptr<sessions::Session> session_;
    store::ScanLog& log_;
    LogFormat format_;
    const Revision newest_;
    Revision read_ = 0;
    bool is_complete_ = false;
    std::string piece_; // read and not yet returned
};

/// Returns a permit for an image of the whole map, if one can be made.
Result<limits::Semaphore::Permit> permit_for_map(const Context& context, const mapping::Snapshot& maps) {
    constexpr std::size_t kCopies = 3; // codes, cells, message
    const auto frame = tiles::map_frame(maps, mapping::Layer::kOccupancy, std::nullopt);
    return context.services.responses.take(frame ? kCopies * frame->pixels() : 0);
}

} // namespace

Result<Response> get_log(Context& context) {
    const auto format = context.query.find("format").value_or("protobuf");
    const bool is_carmen = format == "clf";
    const bool is_mcap = format == "mcap";
    if (!is_carmen && !is_mcap && format != "protobuf") {
        return Error{Errc::kInvalidField,
                     fmt::format("format is {}; possible are clf, mcap and protobuf", in_quotes(format))};
    }
    const auto& session = context.session;
    const auto& info = session->info();

    const auto maps = session->snapshot();
    if (is_carmen && !maps->bounds.sonar.empty()) { // or it would break off at the first of them
        return Error{Errc::kConflict, "the session has scans of sonars, which a CARMEN log cannot represent; request "
                                      "the log without format=clf"};
    }
    auto permit = is_mcap ? permit_for_map(context, *maps) : limits::Semaphore::Permit();
    if (!permit) return permit.error();
    const LogFormat written_as = is_mcap     ? mcap_format(info, maps, std::move(*permit))
                                 : is_carmen ? carmen_format(info, maps->scan_poses)
                                             : protobuf_format();
    auto stream = std::make_shared<LogStream>(session, context.services.log, written_as, maps->revision);
    if (auto begun = stream->begin(); !begun) return begun.error();

    Response response;
    response.set("Content-Type", written_as.content_type)
        .set("Content-Disposition", fmt::format("attachment; filename=\"{}.{}\"", info.name, written_as.ending))
        .set("Cache-Control", kNotKept);
    response.stream = std::move(stream);
    return response;
}

} // namespace scanloom::http
