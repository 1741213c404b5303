#include "umbra/tests/fuzz/json_mutator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

namespace umbra {
namespace {

using json = nlohmann::ordered_json;

bool is_vector(const json& j) {
    return j.is_array() && j.size() == 3 && std::ranges::all_of(j, [](const json& x) { return x.is_number(); });
}

/// Places of a file by what may be done with them. Pointers stay good while no array or object changes its size.
struct Places {
    std::vector<json*> numbers, vectors, texts, arrays, objects, lights;
    std::vector<json*> lengths;  ///< numbers that scale with the scene
    std::vector<json*> points;   ///< vectors that move with it
};

void collect(json& at, std::string_view key, bool length, Places& places) {
    static const std::set<std::string, std::less<>> lengths{"eye",    "target", "position", "positions", "size",
                                                            "radius", "height", "edge_u",   "edge_v",    "translate",
                                                            "major",  "minor",  "range"};
    static const std::set<std::string, std::less<>> points{"eye", "target", "position", "translate"};
    length |= lengths.contains(key);
    if (at.is_number()) places.numbers.push_back(&at);
    if (at.is_number() && length) places.lengths.push_back(&at);
    if (at.is_string()) places.texts.push_back(&at);
    if (is_vector(at)) places.vectors.push_back(&at);
    if (is_vector(at) && (points.contains(key) || (key == "positions" && length))) places.points.push_back(&at);
    if (at.is_array()) {
        if (!at.empty()) places.arrays.push_back(&at);
        for (json& element : at) {
            if (key == "lights" && element.is_object()) places.lights.push_back(&element);
            collect(element, key == "positions" ? key : "", length, places);
        }
    }
    if (at.is_object()) {
        if (!at.empty()) places.objects.push_back(&at);
        for (auto& [name, member] : at.items()) collect(member, name, false, places);
    }
}

class Mutator {
public:
    Mutator(json& root, std::mt19937& random) : root_(root), random_(random) {}

    void change() {
        Places places;
        collect(root_, "", false, places);
        // The size of the picture is no length of the scene.
        if (root_.is_object() && root_.contains("size"))
            std::erase_if(places.lengths, [&](const json* number) {
                return std::ranges::any_of(root_["size"], [&](const json& side) { return &side == number; });
            });
        switch (below(12)) {
            case 0:
            case 1: return number(pick(places.numbers));
            case 2: return number(pick(places.lengths));
            case 3:
            case 4: return vector(places);
            case 5: return scale(places);
            case 6: return move(places);
            case 7: return light(pick(places.lights));
            case 8: return double_one(pick(places.arrays));
            case 9: return drop_one(places);
            case 10: return swap_two(pick(places.arrays));
            default: return text(places);
        }
    }

private:
    std::size_t below(std::size_t n) { return n == 0 ? 0 : random_() % n; }

    json* pick(const std::vector<json*>& from) { return from.empty() ? nullptr : from[below(from.size())]; }

    double extreme() {
        static constexpr std::array values{0.0,   -0.0,  1.0,    -1.0,   0.5,    2.0,    1e-18, 1e-17,  1e-9,
                                           1e-6,  1e-3,  1e3,    1e6,    1e9,    1e12,   1e15,  1e17,   1e18,
                                           -1e18, -1e9,  -1e-18, 1e-38,  1e-45,  1e-300, 1e19,  1e300,  16777217.0,
                                           90.0,  179.9, 180.0,  360.0,  1e-30,  0.1,    3.0,   255.0,  65536.0,
                                           4e9,   1e-7,  1e-12,  -0.001, 0.9999, 1.0001, 1e-14, -1e-12, 1e7};
        return values[below(values.size())];
    }

    double power_of_ten() { return std::pow(10.0, static_cast<double>(below(37)) - 18); }

    void number(json* at) {
        if (at == nullptr) return;
        const double x = at->get<double>();
        switch (below(6)) {
            case 0: *at = -x; return;
            case 1: *at = x * power_of_ten(); return;
            case 2:
                *at = static_cast<double>(std::nextafter(static_cast<float>(x), below(2) == 0 ? 1e30f : -1e30f));
                return;
            case 3: *at = static_cast<std::int64_t>(below(9)); return;
            default: *at = extreme();
        }
    }

    /// Becomes another vector, the sum or the middle of two, or loses all but one component.
    void vector(const Places& places) {
        json* at          = pick(places.vectors);
        const json* other = pick(below(3) == 0 ? places.vectors : places.points);
        if (at == nullptr || other == nullptr) return;
        const std::size_t how = below(5), axis = below(3);
        const double share = how == 1 ? 0.5 : power_of_ten();
        for (std::size_t k = 0; k < 3; ++k) {
            const double a = (*at)[k].get<double>(), b = (*other)[k].get<double>();
            switch (how) {
                case 0: (*at)[k] = b; break;
                case 1:
                case 2: (*at)[k] = a + share * (b - a); break;
                case 3:
                    if (k == axis) (*at)[k] = b;
                    break;
                default:
                    if (k != axis) (*at)[k] = 0;
                    break;
            }
        }
    }

    void scale(const Places& places) {
        const double factor = power_of_ten();
        for (json* at : places.lengths) *at = at->get<double>() * factor;
    }

    void move(const Places& places) {
        const std::size_t axis = below(3);
        const double by        = extreme();
        for (json* at : places.points) (*at)[axis] = (*at)[axis].get<double>() + by;
    }

    /// Another type, with the members that it needs.
    void light(json* at) {
        if (at == nullptr || !at->is_object()) return;
        static constexpr std::array types{"point", "directional", "spot", "rectangle", "disk", "sphere"};
        const std::string type = types[below(types.size())];
        const json position    = at->contains("position") ? (*at)["position"] : json{0, 3, 0};
        json changed           = {{"type", type}};
        if (at->contains("name")) changed["name"] = (*at)["name"];
        if (type == "directional") {
            changed["direction"] = below(2) == 0 ? position : json{0, -1, 0};
        } else {
            changed["position"] = position;
        }
        if (type == "spot") changed["target"] = {0, 0, 0};
        if (type == "spot" && below(2) == 0) changed["cutoff"] = below(2) == 0 ? 90 : 0.001;
        if (type == "rectangle" && below(2) == 0) {
            changed["edge_u"] = {1, 0, 0};
            changed["edge_v"] = {0, 0, 1};
        } else if (type == "rectangle") {
            changed["size"] = {1, 0.5};
        }
        if (type == "disk" && below(2) == 0) changed["direction"] = {1, -1, 0.3};
        if (type == "disk" || type == "sphere") changed["radius"] = std::abs(below(2) == 0 ? extreme() : 0.5);
        *at = std::move(changed);
    }

    void double_one(json* at) {
        if (at == nullptr || at->size() > 40) return;
        const json copy = (*at)[below(at->size())];
        at->push_back(copy);
    }

    void drop_one(const Places& places) {
        if (below(2) == 0) {
            json* at = pick(places.arrays);
            if (at != nullptr) at->erase(below(at->size()));
            return;
        }
        json* at = pick(places.objects);
        if (at == nullptr) return;
        auto it = at->begin();
        std::advance(it, static_cast<std::ptrdiff_t>(below(at->size())));
        at->erase(it);
    }

    void swap_two(json* at) {
        if (at != nullptr) std::swap((*at)[below(at->size())], (*at)[below(at->size())]);
    }

    void text(const Places& places) {
        json* at = pick(places.texts);
        if (at == nullptr) return;
        static constexpr std::array words{"box", "plane", "sphere", "triangles", "disk",   "torus", "cone",  "cylinder",
                                          "",    "/",     "..",     "<b>",       "\u00e9", "a.b",   "clamp", "hue"};
        const json* other = pick(places.texts);
        *at               = below(2) == 0 ? json(words[below(words.size())]) : json(*other);
    }

    json& root_;
    std::mt19937& random_;
};

}  // namespace

std::optional<std::string> mutated_json(std::string_view text, std::mt19937& random) {
    json root = json::parse(text, nullptr, false);
    if (root.is_discarded()) return std::nullopt;
    Mutator mutator(root, random);
    for (std::size_t changes = 1 + random() % 4; changes > 0; --changes) mutator.change();
    return root.dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace umbra
