// The rooms: every file includes only what docs/rooms.md lets it, and every permission there is used.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

struct Room {
    int floor = 1;
    std::set<std::string> exceptions;  ///< rooms that this one may include besides
};

/// The two tables of docs/rooms.md.
struct House {
    std::map<std::string, std::set<std::string>> wings;  ///< wing, and what it sees of others: rooms, or WING/*
    std::map<std::string, Room> rooms;
};

std::string trimmed(std::string s) {
    s.erase(0, s.find_first_not_of(" `"));
    s.erase(s.find_last_not_of(" `") + 1);
    return s;
}

std::vector<std::string> split(const std::string& line, char separator) {
    std::vector<std::string> parts;
    std::istringstream in(line);
    for (std::string part; std::getline(in, part, separator);) parts.push_back(trimmed(part));
    return parts;
}

std::set<std::string> names_of(const std::string& cell) {
    std::set<std::string> names;
    for (const std::string& name : split(cell, ','))
        if (!name.empty()) names.insert(name);
    return names;
}

/// Rows wing | rooms, and room | floor | subject | rooms. A row FOLDER/* is that of each sub-folder that has none of
/// its own.
House read_house(const fs::path& top) {
    House house;
    std::ifstream in(top / "docs/rooms.md");
    for (std::string line; std::getline(in, line);) {
        const auto cells = split(line, '|');  // the first is empty: the text before the first bar
        if (cells.size() < 3 || cells[1] == "room" || cells[1] == "wing" || cells[1].starts_with("-")) continue;
        if (cells.size() < 5)
            house.wings[cells[1]] = names_of(cells[2]);
        else
            house.rooms[cells[1]] = {std::stoi(cells[2]), names_of(cells[4])};
    }
    for (const auto& [name, room] : std::map(house.rooms)) {
        if (!name.ends_with("/*")) continue;
        house.rooms.erase(name);
        const std::string folder = name.substr(0, name.size() - 2);
        for (const auto& entry : fs::directory_iterator(top / folder))
            if (entry.is_directory()) house.rooms.emplace(folder + "/" + entry.path().filename().string(), room);
    }
    return house;
}

std::string wing_of(const std::string& room) { return room.substr(0, room.find('/')); }

/// Whether a name of the table, a room or WING/*, means this room.
bool means(const std::string& name, const std::string& room) {
    return name == room || (name.ends_with("/*") && room.starts_with(name.substr(0, name.size() - 1)));
}

bool may_include(const House& house, const std::string& from, const std::string& to) {
    if (from == to || house.rooms.at(from).exceptions.contains(to)) return true;
    if (wing_of(from) == wing_of(to)) return house.rooms.at(to).floor < house.rooms.at(from).floor;
    const auto wing = house.wings.find(wing_of(from));
    return wing != house.wings.end() &&
           std::ranges::any_of(wing->second, [&](const std::string& name) { return means(name, to); });
}

/// The room of a file, a path from the project's folder: the longest row that it lies below.
std::string room_of(const House& house, std::string path) {
    while (true) {
        const std::size_t slash = path.rfind('/');
        if (slash == std::string::npos) return "";
        path.resize(slash);
        if (house.rooms.contains(path)) return path;
    }
}

/// What breaks the tables below `top`, one line each.
std::vector<std::string> violations(const fs::path& top, const House& house) {
    std::vector<std::string> found;
    std::map<std::string, std::set<std::string>> included;  // by each room that has a file
    for (const char* folder : {"core", "shadows", "bench"}) {
        if (!fs::exists(top / folder)) continue;
        for (const auto& entry : fs::recursive_directory_iterator(top / folder)) {
            const std::string ending = entry.path().extension().string();
            if (ending != ".h" && ending != ".cpp") continue;
            const std::string path = fs::relative(entry.path(), top).generic_string(), room = room_of(house, path);
            if (room.empty()) {
                found.push_back(path + " lies in no room");
                continue;
            }
            std::set<std::string>& others = included[room];
            std::ifstream in(entry.path());
            int number = 0;
            for (std::string line; std::getline(in, line);) {
                ++number;
                constexpr std::string_view kStart = "#include \"umbra/";
                if (!line.starts_with(kStart)) continue;
                const std::string target = line.substr(kStart.size(), line.rfind('"') - kStart.size());
                if (target == "contender.h") continue;  // the interface in C, which has nothing of ours
                const std::string other = room_of(house, target);
                if (!other.empty() && other != room) others.insert(other);
                if (other.empty() || !may_include(house, room, other))
                    found.push_back(fmt::format("{}:{} includes {}", path, number, target));
            }
        }
    }
    // A permission that nobody uses.
    std::map<std::string, std::map<int, bool>>
        floors;  // wing, floor: whether a room of it includes one of the floor below
    for (const auto& [name, room] : house.rooms) {
        if (!included.contains(name)) found.push_back(name + " has a row and no file");
        bool& used = floors[wing_of(name)][room.floor];
        for (const std::string& other : included[name])
            used |= wing_of(other) == wing_of(name) && house.rooms.at(other).floor == room.floor - 1;
        for (const std::string& other : room.exceptions)
            if (!included[name].contains(other)) found.push_back(name + " has an exception unused: " + other);
    }
    for (const auto& [wing, numbers] : floors)
        for (const auto& [floor, used] : numbers)
            if (floor > 1 && !used)
                found.push_back(fmt::format("{}: floor {} uses nothing of the one below", wing, floor));
    for (const auto& [wing, seen] : house.wings)
        for (const std::string& name : seen) {
            const bool used = std::ranges::any_of(included, [&, &its_wing = wing](const auto& entry) {
                return wing_of(entry.first) == its_wing &&
                       std::ranges::any_of(entry.second, [&](const std::string& other) { return means(name, other); });
            });
            if (!used) found.push_back(wing + " sees what none of its rooms includes: " + name);
        }
    std::ranges::sort(found);
    return found;
}

/// A room that the permissions lead back to; empty where there is none.
std::string circle(const House& house) {
    for (const auto& [start, unused] : house.rooms) {
        std::set<std::string> reached;
        std::vector<std::string> open{start};
        while (!open.empty()) {
            const std::string room = open.back();
            open.pop_back();
            for (const auto& [other, ignored] : house.rooms) {
                if (other == room || !may_include(house, room, other)) continue;
                if (other == start) return start;
                if (reached.insert(other).second) open.push_back(other);
            }
        }
    }
    return "";
}

TEST(Rooms, EveryFileIncludesOnlyWhatItsRowLetsItAndEveryPermissionIsUsed) {
    const House house = read_house(UMBRA_TOP);
    ASSERT_GT(house.rooms.size(), 20u);
    ASSERT_EQ(house.wings.size(), 3u);
    EXPECT_EQ(fmt::format("{}", fmt::join(violations(UMBRA_TOP, house), "\n")), "");
}

TEST(Rooms, HaveNoCircle) {
    EXPECT_EQ(circle(read_house(UMBRA_TOP)), "");
    EXPECT_EQ(circle({{}, {{"a/x", {1, {}}}, {"a/y", {2, {}}}, {"a/z", {3, {}}}}}), "");
    EXPECT_EQ(circle({{}, {{"a/x", {1, {"a/z"}}}, {"a/y", {2, {}}}, {"a/z", {3, {}}}}}), "a/x");  // up
    EXPECT_EQ(circle({{}, {{"a/x", {1, {"a/y"}}}, {"a/y", {1, {"a/x"}}}}}), "a/x");               // beside
    EXPECT_EQ(circle({{{"a", {"b/*"}}, {"b", {"a/x"}}}, {{"a/x", {1, {}}}, {"b/y", {1, {}}}}}), "a/x");
}

TEST(Rooms, CoreKnowsNothingOfShadowsAndNoMethodOfAnother) {
    const House house = read_house(UMBRA_TOP);
    static const std::set<std::string> several{"shadows", "shadows/geometry", "shadows/light_rays", "shadows/bins",
                                               "shadows/maps"};
    for (const auto& [from, room] : house.rooms)
        for (const auto& [to, ignored] : house.rooms) {
            if (from == to || !may_include(house, from, to)) continue;
            const std::string wing = wing_of(from);
            EXPECT_FALSE(wing == "core" && wing_of(to) != "core") << from << " may include " << to;
            EXPECT_FALSE(wing == "shadows" && wing_of(to) == "bench") << from << " may include " << to;
            EXPECT_FALSE(wing == "shadows" && wing_of(to) == "shadows" && !several.contains(to))
                << from << " may include " << to;
        }
}

TEST(Rooms, PlantedFaultsAreFound) {
    const TemporaryFolder top;
    (void)top.write("shadows/method.h", "#include \"umbra/core/base/math.h\"\n");
    (void)top.write("shadows/maps/depth_map.h", "#include \"umbra/shadows/method.h\"\n");
    (void)top.write("shadows/zbuffer/bias.h", "");
    (void)top.write("shadows/rays/ray_traced.cpp",
                    "#include \"umbra/shadows/method.h\"\n#include \"umbra/shadows/zbuffer/bias.h\"\n");
    (void)top.write("core/base/math.h", "");
    (void)top.write("core/scene/scene.h", "#include \"umbra/core/base/math.h\"\n#include \"umbra/shadows/method.h\"\n");
    (void)top.write("bench/attic/old.h", "");
    const House house{{{"core", {}}, {"shadows", {"core/base", "core/scene"}}},
                      {{"core/base", {1, {}}},
                       {"core/scene", {2, {}}},
                       {"core/errors", {2, {}}},
                       {"shadows", {1, {}}},
                       {"shadows/maps", {2, {"core/errors"}}},
                       {"shadows/zbuffer", {4, {}}},
                       {"shadows/rays", {4, {}}}}};
    EXPECT_EQ(violations(top.path(), house),
              (std::vector<std::string>{"bench/attic/old.h lies in no room", "core/errors has a row and no file",
                                        "core/scene/scene.h:2 includes shadows/method.h",
                                        "shadows sees what none of its rooms includes: core/scene",
                                        "shadows/maps has an exception unused: core/errors",
                                        "shadows/rays/ray_traced.cpp:2 includes shadows/zbuffer/bias.h",
                                        "shadows: floor 4 uses nothing of the one below"}));
}

}  // namespace
}  // namespace umbra
