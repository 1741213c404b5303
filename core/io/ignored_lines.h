// Lines of a text file that are legal, but mean nothing here. Internal to core.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

namespace umbra {

/// One warning per kind of line, with the first line of that kind.
class IgnoredLines {
public:
    void add(std::string_view what, std::size_t line) {
        auto it = kinds_.find(what);
        if (it == kinds_.end() && kinds_.size() >= 20) it = kinds_.try_emplace("others").first;
        if (it == kinds_.end()) it = kinds_.try_emplace(std::string(what)).first;
        if (it->second.count++ == 0) it->second.first_line = line;
    }
    void warn(const std::string& file, std::vector<std::string>& warnings) const {
        for (const auto& [what, kind] : kinds_)
            warnings.push_back(fmt::format("{}:{}: {} ignored{}.", file, kind.first_line, what,
                                           kind.count > 1 ? fmt::format(", {} times", kind.count) : ""));
    }

private:
    struct Kind {
        std::size_t first_line = 0;
        std::size_t count      = 0;
    };
    std::map<std::string, Kind, std::less<>> kinds_;
};

}  // namespace umbra
