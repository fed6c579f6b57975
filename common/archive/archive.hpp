#pragma once

#include <boost/pfr.hpp>

#include <bit>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <unordered_map>
#include <utility>
#include <vector>

/// Values as bytes: written and read bit by bit, little-endian. One list of members serves both directions: of an
/// aggregate its declaration, of a class its function list():
///     template <class Self, class Archive>
///     static void list(Self& self, Archive& archive) { archive(self.a_, self.b_); }
namespace scanloom::archive {

static_assert(std::endian::native == std::endian::little, "archives are written in the machine's own order");

namespace detail {

template <class T>
concept Plain = std::is_arithmetic_v<T> || std::is_enum_v<T>;

/// What stands for an archive in Listed.
struct AnyArchive {
    static constexpr bool kReads = false;
    template <class... Values>
    void operator()(Values&&...) {}
    void fail() {}
};

template <class T>
concept Listed = requires(T& value, AnyArchive& archive) {
    T::list(value, archive);
};

template <class T>
concept Optional = std::same_as<T, std::optional<typename T::value_type>>;

template <class T>
concept Shared = std::same_as<T, std::shared_ptr<typename T::element_type>>;

template <class T>
concept Map = requires {
    typename T::mapped_type;
};

/// A list that is read through a snapshot: mapping::GrowingList.
template <class T>
concept Growing = requires(T& list) {
    list.append(list.snapshot()[0]);
};

template <class T>
concept Sequence = requires(T& items) {
    items.emplace_back();
};

template <class T>
inline constexpr char kTypeTag = 0;

} // namespace detail

/// Writes values.
/// Threads: one at a time.
class Writer {
public:
    static constexpr bool kReads = false; ///< for functions list()

    /// Prepares for a number of bytes.
    void reserve(std::size_t bytes) { bytes_.reserve(bytes); }

    /// States that the reader has these objects: pointers to them become numbers.
    template <class T>
    void share(const std::vector<std::shared_ptr<const T>>& objects) {
        for (const auto& object : objects) numbers_.emplace(object.get(), numbers_.size());
    }

    /// Appends values. Pointers must not be null; an object that several point to is written once.
    template <class... Values>
    void operator()(const Values&... values) {
        (write(values), ...);
    }

    /// Returns the bytes.
    [[nodiscard]] std::string take() && { return std::move(bytes_); }

private:
    template <class T>
    void write(const T& value) {
        using namespace detail;
        if constexpr (Plain<T>) {
            bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
        } else if constexpr (Listed<T>) {
            T::list(value, *this);
        } else if constexpr (Optional<T>) {
            write(value.has_value());
            if (value) write(*value);
        } else if constexpr (Shared<T>) {
            const auto [number, is_new] = numbers_.emplace(value.get(), numbers_.size());
            write(std::uint64_t{number->second});
            if (is_new) write(*value);
        } else if constexpr (Map<T>) {
            write(std::uint64_t{value.size()});
            for (const auto& [key, mapped] : value) (*this)(key, mapped);
        } else if constexpr (Growing<T>) {
            const auto view = value.snapshot();
            write(std::uint64_t{view.size()});
            for (std::size_t n = 0; n < view.size(); ++n) write(view[n]);
        } else if constexpr (Sequence<T>) {
            write(std::uint64_t{value.size()});
            for (const auto& item : value) write(static_cast<const typename T::value_type&>(item));
        } else {
            boost::pfr::for_each_field(value, [this](const auto& field) { write(field); });
        }
    }

    std::string bytes_;
    std::unordered_map<const void*, std::size_t> numbers_; // of shared objects
};

/// Reads values that a Writer wrote. The bytes may be damaged: numbers that cannot be are refused, and no more memory
/// is used than the bytes justify. After the first value that does not fit, failed() stays true and values are
/// undefined. Whether values are consistent with each other is for the caller to check.
/// Threads: one at a time.
class Reader {
public:
    static constexpr bool kReads = true; ///< for functions list()

    /// @param bytes  must outlive this object
    explicit Reader(std::string_view bytes) : rest_(bytes) {}

    /// Gives it the objects that the writer shared.
    template <class T>
    void share(const std::vector<std::shared_ptr<const T>>& objects) {
        for (const auto& object : objects) objects_.push_back({&detail::kTypeTag<T>, object});
    }

    /// Reads values. A pointer is never null.
    template <class... Values>
    void operator()(Values&... values) {
        (read(values), ...);
    }

    /// States that a value that was read is not possible.
    void fail() noexcept { failed_ = true; }

    /// Returns whether a value did not fit.
    [[nodiscard]] bool failed() const noexcept { return failed_; }

    /// Returns whether all bytes were read and fitted.
    [[nodiscard]] bool complete() const noexcept { return !failed_ && rest_.empty(); }

private:
    struct Object {
        const char* type;
        std::shared_ptr<const void> value;
    };

    template <class T>
    void read(T& value) {
        using namespace detail;
        if (failed_) return;
        if constexpr (Plain<T>) {
            read_plain(value);
        } else if constexpr (Listed<T>) {
            T::list(value, *this);
        } else if constexpr (Optional<T>) {
            bool has_value = false;
            read(has_value);
            value.reset();
            if (!has_value) return;
            typename T::value_type item{}; // clang does not find emplace() for structs of classes that are not complete
            read(item);
            value.emplace(std::move(item));
        } else if constexpr (Shared<T>) {
            read_shared(value);
        } else if constexpr (Map<T>) {
            value.clear();
            for (auto count = read_count(); count > 0 && !failed_; --count) {
                typename T::key_type key{};
                read(key);
                read(value[key]);
            }
        } else if constexpr (Growing<T>) {
            value = T();
            for (auto count = read_count(); count > 0 && !failed_; --count) {
                std::decay_t<decltype(value.snapshot()[0])> item{};
                read(item);
                value.append(item);
            }
        } else if constexpr (std::same_as<T, std::vector<bool>>) {
            value.clear();
            for (auto count = read_count(); count > 0 && !failed_; --count) {
                bool item = false;
                read(item);
                value.push_back(item);
            }
        } else if constexpr (Sequence<T>) {
            value.clear();
            for (auto count = read_count(); count > 0 && !failed_; --count) read(value.emplace_back());
        } else {
            boost::pfr::for_each_field(value, [this](auto& field) { read(field); });
            if constexpr (requires { is_finite(value); }) {
                if (!is_finite(value)) fail();
            }
        }
    }

    template <class T>
    void read_plain(T& value) {
        if constexpr (std::same_as<T, bool>) {
            std::uint8_t byte = 0;
            read_plain(byte);
            if (byte > 1) fail();
            value = byte == 1;
        } else {
            if (rest_.size() < sizeof value) return fail();
            std::memcpy(&value, rest_.data(), sizeof value);
            rest_.remove_prefix(sizeof value);
        }
        if constexpr (std::floating_point<T>) {
            if (std::isnan(value)) fail();
        }
    }

    /// Reads a number of items. Each takes a byte at least.
    [[nodiscard]] std::uint64_t read_count() {
        std::uint64_t count = 0;
        read(count);
        if (count > rest_.size()) fail();
        return count;
    }

    template <class T>
    void read_shared(std::shared_ptr<T>& value) {
        const char* type = &detail::kTypeTag<std::remove_const_t<T>>;
        std::uint64_t number = 0;
        read(number);
        if (failed_ || number > objects_.size()) return fail();
        if (number == objects_.size()) {
            auto object = std::make_shared<std::remove_const_t<T>>();
            objects_.push_back({type, object});
            read(*object);
        }
        const Object& found = objects_[number];
        if (found.type != type) return fail();
        value = std::const_pointer_cast<T>(std::static_pointer_cast<const T>(found.value));
    }

    std::string_view rest_;
    bool failed_ = false;
    std::vector<Object> objects_;
};

} // namespace scanloom::archive
