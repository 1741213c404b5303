#include "umbra/bench/base/record.h"

#include <fmt/ranges.h>

#include <algorithm>

#include "umbra/core/base/suggest.h"

namespace umbra {

std::string text_of(const Scalar& value) {
    const Json written = record_parts::write(value);
    return written.is_string() ? written.get<std::string>() : written.dump();
}

namespace record_parts {

void refuse_unless(const Allowed& allowed, const Field& field) {
    if (!field.present()) return;
    if (!allowed.words.empty() && std::ranges::find(allowed.words, field.text()) == allowed.words.end())
        field.refuse(fmt::format("\"{}\"", fmt::join(allowed.words, "\" or \"")));
    if (allowed.least && *field.number() < *allowed.least) field.refuse(fmt::format("at least {}", *allowed.least));
    if (allowed.most && *field.number() > *allowed.most) field.refuse(fmt::format("at most {}", *allowed.most));
    if (allowed.only && field.flag() != *allowed.only) field.refuse(*allowed.only ? "true" : "false");
    if (allowed.items && field.items().size() != *allowed.items) field.refuse(fmt::format("{} items", *allowed.items));
}

void require_members_among(const Field& field, const std::vector<std::string>& known) {
    for (const auto& [key, member] : field.members())
        if (std::find(known.begin(), known.end(), key) == known.end())
            member.refuse(
                fmt::format("no member of this name but {}{}", fmt::join(known, ", "), did_you_mean(key, known)));
}

Json or_null(Json schema) {
    if (!schema.contains("type")) return schema.empty() ? schema : Json{{"anyOf", {{{"type", "null"}}, schema}}};
    Json& type = schema["type"];
    if (type.is_string()) type = Json::array({type});
    if (std::ranges::find(type, Json("null")) == type.end()) type.push_back("null");
    return schema;
}

Json rooted(std::string_view title, Json root, Definitions definitions) {
    // A root with a name stands among the definitions, like any part.
    if (root.contains("$ref")) {
        const std::string name = root["$ref"].get<std::string>().substr(std::string_view("#/definitions/").size());
        root                   = definitions.named[name];
        definitions.named.erase(name);
    }
    Json schema = {{"$schema", "http://json-schema.org/draft-04/schema#"}, {"title", title}};
    for (auto& [key, value] : root.items()) schema[key] = value;
    if (!definitions.named.empty()) schema["definitions"] = std::move(definitions.named);
    return schema;
}

}  // namespace record_parts
}  // namespace umbra
