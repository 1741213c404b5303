// JSON as records hold it; and a JSON file, read with care: what is there must have the right type, what is not there is
// absent.
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace umbra {

using Json = nlohmann::ordered_json;

/// As files hold it: indented, with a newline at the end; bytes that are not UTF-8 are replaced.
[[nodiscard]] std::string json_text(const Json& record);
[[nodiscard]] Json number(double value);  ///< null where it is not finite: JSON has no infinity

using Scalar = std::variant<bool, std::int64_t, double, std::string>;

/// One value of a results.json, which may be absent (not there, or null). Asking for a type that it has not throws
/// InputError with the file and the position as a JSON pointer. Copies share the file's contents.
class Field {
public:
    Field() = default;                                           ///< absent
    [[nodiscard]] Field operator[](std::string_view key) const;  ///< absent where this is absent
    [[nodiscard]] bool present() const { return value_ != nullptr; }
    [[nodiscard]] bool has(std::string_view key) const;  ///< it has a member of that name, which may be null
    [[nodiscard]] bool is_array() const;
    [[nodiscard]] bool is_object() const;

    [[nodiscard]] std::string text() const;           ///< empty where absent
    [[nodiscard]] std::string required_text() const;  ///< neither absent nor empty
    [[nodiscard]] Scalar scalar_value() const;        ///< "" where absent
    [[nodiscard]] Json json() const;                  ///< whatever it is; null where absent
    [[nodiscard]] std::optional<double> number() const;
    [[nodiscard]] bool flag() const;                 ///< false where absent
    [[nodiscard]] std::vector<Field> items() const;  ///< empty where absent; null items are absent, too
    [[nodiscard]] std::vector<std::pair<std::string, Field>> members() const;

    /// "FILE:/POINTER: found WHAT, expected EXPECTED".
    [[noreturn]] void refuse(std::string_view expected) const;

private:
    friend Field parse_json(const std::string& bytes, const std::string& name);
    struct Document;
    Field(std::shared_ptr<const Document> document, const Json* value, std::string pointer)
        : document_(std::move(document)), value_(value), pointer_(std::move(pointer)) {}

    std::shared_ptr<const Document> document_;
    const Json* value_ = nullptr;
    std::string pointer_;
};

/// The root of a JSON text; `name` names it in errors. Throws InputError.
[[nodiscard]] Field parse_json(const std::string& bytes, const std::string& name);

/// The root of a results.json of the schema that this version writes. Throws InputError.
[[nodiscard]] Field read_results(const std::filesystem::path& file);

/// The version of the schema, as in the member `schema`.
inline constexpr int kResultsSchema = 2;

}  // namespace umbra
