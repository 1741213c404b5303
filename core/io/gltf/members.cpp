#include "umbra/core/io/gltf/members.h"

#include <cmath>

#include <fmt/format.h>

namespace umbra {

const JsonValue* find_member(const JsonValue& object, std::string_view key) {
    const auto* members = std::get_if<JsonObject>(&object.data);
    if (!members) return nullptr;
    for (const JsonMember& m : *members)
        if (m.key == key) return &m.value;
    return nullptr;
}

const JsonArray& list_of(const JsonText& json, const JsonValue& object, std::string_view key) {
    static const JsonArray kEmpty;
    const JsonValue* v = find_member(object, key);
    return v ? json.array(*v, key, "a list [...]") : kEmpty;
}

std::uint64_t whole(const JsonText& json, const JsonValue& v, std::string_view what, double min, double max) {
    const std::string words = fmt::format("a whole number from {:.0f} to {:.0f}", min, max);
    const double d          = json.number(v, what, {min, max, words});
    if (d != std::floor(d)) json.fail(v, fmt::format("{} is {:g}, expected {}", what, d, words));
    return static_cast<std::uint64_t>(d);
}

std::size_t index_into(const JsonText& json, const JsonValue& v, std::string_view what, std::size_t size) {
    const auto i = whole(json, v, what, 0, kMaxWhole);
    if (i >= size) json.fail(v, fmt::format("{} {} does not exist (the file has {}, counted from 0)", what, i, size));
    return std::size_t(i);
}

const JsonValue* shown_scene(const JsonText& json) {
    const JsonArray& scenes = list_of(json, json.root(), "scenes");
    const JsonValue* chosen = find_member(json.root(), "scene");
    const std::size_t which = chosen ? index_into(json, *chosen, "scene", scenes.size()) : 0;
    return scenes.empty() ? nullptr : &scenes[which];
}

double number_or(const JsonText& json, const JsonValue* object, std::string_view key, const Range& range,
                 double fallback) {
    const JsonValue* v = object ? find_member(*object, key) : nullptr;
    return v ? json.number(*v, key, range) : fallback;
}

std::vector<double> numbers(const JsonText& json, const JsonValue& v, std::string_view what, std::size_t n,
                            const Range& range) {
    const std::string right = fmt::format("{} numbers [...]", n);
    const JsonArray& list   = json.array(v, what, right);
    if (list.size() != n) json.wrong_type(v, what, right);
    std::vector<double> out;
    for (const JsonValue& x : list) out.push_back(json.number(x, what, range));
    return out;
}

dvec3 vector_or(const JsonText& json, const JsonValue* object, std::string_view key, const Range& range,
                dvec3 fallback) {
    const JsonValue* v = object ? find_member(*object, key) : nullptr;
    return v ? json.vector(*v, key, range) : fallback;
}

const JsonValue* extension(const JsonText& json, const JsonValue& object, std::string_view name) {
    const JsonValue* all = find_member(object, "extensions");
    if (!all) return nullptr;
    (void)json.object(*all, "extensions");
    const JsonValue* v = find_member(*all, name);
    if (v) (void)json.object(*v, name);
    return v;
}

std::string name_or(const JsonText& json, const JsonValue& object, std::string_view fallback) {
    const JsonValue* v = find_member(object, "name");
    if (!v) return std::string(fallback);
    const std::string& name = json.string(*v, "name");
    return name.empty() ? std::string(fallback) : name.substr(0, 200);
}

}  // namespace umbra
