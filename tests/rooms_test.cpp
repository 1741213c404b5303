// The rooms: every file includes only what docs/rooms.md lets it.
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
#include <vector>

#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

using Rooms = std::map<std::string, std::set<std::string>>;  ///< room, and what it may include

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

/// The table's rows: room | subject | rooms. A row FOLDER/* is that of each sub-folder that has none of its own.
Rooms read_rooms(const fs::path& top) {
    Rooms rooms;
    std::ifstream in(top / "docs/rooms.md");
    for (std::string line; std::getline(in, line);) {
        const auto cells = split(line, '|');  // before the first bar there is nothing
        if (cells.size() < 4 || cells[1] == "room" || cells[1].starts_with("-")) continue;
        auto& allowed = rooms[cells[1]];
        for (const std::string& room : split(cells[3], ','))
            if (!room.empty()) allowed.insert(room);
    }
    for (const auto& [room, allowed] : Rooms(rooms)) {
        if (!room.ends_with("/*")) continue;
        rooms.erase(room);
        const std::string folder = room.substr(0, room.size() - 2);
        for (const auto& entry : fs::directory_iterator(top / folder))
            if (entry.is_directory()) rooms.emplace(folder + "/" + entry.path().filename().string(), allowed);
    }
    return rooms;
}

/// The room of a file, a path from the project's folder: the longest row that it lies below.
std::string room_of(const Rooms& rooms, std::string path) {
    while (true) {
        const std::size_t slash = path.rfind('/');
        if (slash == std::string::npos) return "";
        path.resize(slash);
        if (rooms.contains(path)) return path;
    }
}

/// What breaks the table below `top`, one line each.
std::vector<std::string> violations(const fs::path& top, const Rooms& rooms) {
    std::vector<std::string> found;
    for (const char* folder : {"core", "shadows", "bench"}) {
        if (!fs::exists(top / folder)) continue;
        for (const auto& entry : fs::recursive_directory_iterator(top / folder)) {
            const std::string ending = entry.path().extension().string();
            if (ending != ".h" && ending != ".cpp") continue;
            const std::string path = fs::relative(entry.path(), top).generic_string(), room = room_of(rooms, path);
            if (room.empty()) found.push_back(path + " lies in no room");
            std::ifstream in(entry.path());
            int number = 0;
            for (std::string line; std::getline(in, line);) {
                ++number;
                constexpr std::string_view kStart = "#include \"umbra/";
                if (!line.starts_with(kStart)) continue;
                const std::string target = line.substr(kStart.size(), line.rfind('"') - kStart.size());
                const std::string other  = room_of(rooms, target);
                if (other != room && (other.empty() || !rooms.at(room).contains(other)))
                    found.push_back(fmt::format("{}:{} includes {}", path, number, target));
            }
        }
    }
    std::sort(found.begin(), found.end());
    return found;
}

/// A room that can be reached from itself; empty where there is none.
std::string circle(const Rooms& rooms) {
    for (const auto& [start, direct] : rooms) {
        std::set<std::string> reached;
        std::vector<std::string> open(direct.begin(), direct.end());
        while (!open.empty()) {
            const std::string room = open.back();
            open.pop_back();
            if (room == start) return start;
            if (reached.insert(room).second && rooms.contains(room))
                open.insert(open.end(), rooms.at(room).begin(), rooms.at(room).end());
        }
    }
    return "";
}

TEST(Rooms, EveryFileIncludesOnlyWhatItsRowNames) {
    const Rooms rooms = read_rooms(UMBRA_TOP);
    ASSERT_GT(rooms.size(), 20u);
    EXPECT_EQ(fmt::format("{}", fmt::join(violations(UMBRA_TOP, rooms), "\n")), "");
}

TEST(Rooms, HaveNoCircle) {
    const Rooms rooms = read_rooms(UMBRA_TOP);
    EXPECT_EQ(circle(rooms), "");
    EXPECT_EQ(circle({{"a", {"b"}}, {"b", {"c"}}, {"c", {"a"}}}), "a");
}

TEST(Rooms, CoreKnowsNothingOfShadowsAndNoMethodOfAnother) {
    for (const auto& [room, allowed] : read_rooms(UMBRA_TOP))
        for (const std::string& other : allowed) {
            if (room.starts_with("core/")) {
                EXPECT_TRUE(other.starts_with("core/")) << room << " includes " << other;
            }
            if (room.starts_with("shadows/") && other.starts_with("shadows/")) {
                static const std::set<std::string> several{"shadows/geometry", "shadows/light_rays", "shadows/bins",
                                                           "shadows/maps"};
                EXPECT_TRUE(several.contains(other)) << room << " includes " << other;
            }
        }
}

TEST(Rooms, APlantedIncludeIsFound) {
    const TemporaryFolder top;
    (void)top.write("shadows/rays/ray_traced.cpp",
                    "#include \"umbra/shadows/method.h\"\n#include \"umbra/shadows/zbuffer/depth_map.h\"\n");
    (void)top.write("core/scene/scene.h", "#include \"umbra/core/base/math.h\"\n#include \"umbra/shadows/method.h\"\n");
    (void)top.write("bench/attic/old.h", "");
    const Rooms rooms{{"core/base", {}},
                      {"core/scene", {"core/base"}},
                      {"shadows", {}},
                      {"shadows/zbuffer", {}},
                      {"shadows/rays", {"shadows"}}};
    EXPECT_EQ(
        violations(top.path(), rooms),
        (std::vector<std::string>{"bench/attic/old.h lies in no room", "core/scene/scene.h:2 includes shadows/method.h",
                                  "shadows/rays/ray_traced.cpp:2 includes shadows/zbuffer/depth_map.h"}));
}

}  // namespace
}  // namespace umbra
