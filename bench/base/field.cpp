#include "umbra/bench/base/field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

#include "umbra/core/base/error.h"

namespace umbra {

std::string json_text(const Json& record) { return record.dump(1, ' ', false, Json::error_handler_t::replace) + "\n"; }

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

struct Field::Document {
    std::string file;
    Json root;
};

void Field::refuse(std::string_view expected) const {
    std::string found = "nothing";
    if (value_) found = value_->is_structured() ? fmt::format("an {}", value_->type_name()) : value_->dump();
    if (found.size() > 60) found = found.substr(0, 57) + "...";
    throw InputError(fmt::format("{}:{}: found {}, expected {}", document_->file, pointer_.empty() ? "/" : pointer_,
                                 found, expected));
}

Field Field::operator[](std::string_view key) const {
    if (value_ && !value_->is_object()) refuse("an object");
    const Json* member = nullptr;
    if (value_) {
        const auto it = value_->find(key);
        if (it != value_->end() && !it->is_null()) member = &*it;
    }
    return {document_, member, pointer_ + (nlohmann::json::json_pointer() / std::string(key)).to_string()};
}

bool Field::has(std::string_view key) const {
    return value_ && value_->is_object() && value_->contains(std::string(key));
}

bool Field::is_array() const { return value_ != nullptr && value_->is_array(); }
bool Field::is_object() const { return value_ != nullptr && value_->is_object(); }

Json Field::json() const { return value_ ? *value_ : Json(); }

std::string Field::text() const {
    if (!value_) return {};
    if (!value_->is_string()) refuse("a string");
    return value_->get<std::string>();
}

std::string Field::required_text() const {
    std::string s = text();
    if (s.empty()) refuse("a non-empty string");
    return s;
}

Scalar Field::scalar_value() const {
    if (!value_) return std::string();
    if (value_->is_string()) return value_->get<std::string>();
    if (value_->is_boolean()) return value_->get<bool>();
    if (value_->is_number_integer()) return value_->get<std::int64_t>();
    if (value_->is_number()) return value_->get<double>();
    refuse("a string, a number, true or false");
}

std::optional<double> Field::number() const {
    if (!value_) return std::nullopt;
    if (!value_->is_number()) refuse("a number");
    return value_->get<double>();
}

bool Field::flag() const {
    if (value_ && !value_->is_boolean()) refuse("true or false");
    return value_ && value_->get<bool>();
}

std::vector<Field> Field::items() const {
    std::vector<Field> all;
    if (!value_) return all;
    if (!value_->is_array()) refuse("an array");
    for (std::size_t i = 0; i < value_->size(); ++i)
        all.push_back({document_, (*value_)[i].is_null() ? nullptr : &(*value_)[i], fmt::format("{}/{}", pointer_, i)});
    return all;
}

std::vector<std::pair<std::string, Field>> Field::members() const {
    std::vector<std::pair<std::string, Field>> all;
    if (!value_) return all;
    if (!value_->is_object()) refuse("an object");
    for (const auto& entry : value_->items()) all.emplace_back(entry.key(), (*this)[entry.key()]);
    return all;
}

Field parse_json(const std::string& bytes, const std::string& name) {
    auto document  = std::make_shared<Field::Document>();
    document->file = name;
    try {
        document->root = Json::parse(bytes);
    } catch (const nlohmann::json::parse_error& error) {
        const auto end  = bytes.begin() + std::ptrdiff_t(std::clamp<std::size_t>(error.byte, 1, bytes.size() + 1) - 1);
        const auto line = 1 + std::count(bytes.begin(), end, '\n');
        const auto newline = std::find(std::make_reverse_iterator(end), bytes.rend(), '\n').base();
        throw InputError(fmt::format("{}:{}:{}: not JSON, or cut off here; expected a complete JSON text", name, line,
                                     1 + (end - newline)));
    } catch (const nlohmann::json::exception&) {  // a number beyond double
        throw InputError(fmt::format("{}: a number is out of range, expected numbers that a double can hold", name));
    }
    return {document, &document->root, ""};
}

Field read_results(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw InputError(fmt::format("{}: cannot be opened, expected a results.json", file.string()));
    Field root = parse_json({std::istreambuf_iterator<char>(stream), {}}, file.string());
    if (root["schema"].number() != kResultsSchema)
        root["schema"].refuse(fmt::format("{}, the version that this program reads", kResultsSchema));
    return root;
}

}  // namespace umbra
