// Tables of pages, read from their text: cells by the headings that a person sees.
#pragma once

#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace umbra::other_readers {

/// Text without tags; &shy; and the like are left out, white space at both ends is cut off.
inline std::string plain(const std::string& html) {
    std::string text;
    for (std::size_t i = 0; i < html.size(); ++i) {
        if (html[i] == '<') {
            i = html.find('>', i);
            if (i == std::string::npos) break;
        } else if (html.compare(i, 5, "&shy;") == 0) {
            i += 4;
        } else {
            text += html[i];
        }
    }
    text.erase(0, text.find_first_not_of(" \n"));
    text.erase(text.find_last_not_of(" \n") + 1);
    return text;
}

/// The value of an attribute of a tag, as a number; `otherwise` where it is not there.
inline std::size_t number_in(const std::string& tag, const std::string& attribute, std::size_t otherwise) {
    const std::size_t at = tag.find(attribute + "=\"");
    return at == std::string::npos ? otherwise : std::stoul(tag.substr(at + attribute.size() + 2));
}

/// A table of a page. Cells are found by the row group ("" where there is none), the row's heading and the column's
/// headings from top to bottom: "Phase, ms / Aim". Several rows of one heading: "planted", "planted #2".
class HtmlTable {
public:
    /// The table whose caption has this id.
    HtmlTable(const std::string& page, const std::string& caption_id) {
        const std::size_t caption = page.find("<caption id=\"" + caption_id + "\"");
        if (caption == std::string::npos) throw std::runtime_error("no table " + caption_id);
        const std::string table = page.substr(caption, page.find("</table>", caption) - caption);
        read_headings(table.substr(0, table.find("</thead>")));
        std::string group;
        std::map<std::string, int> seen;
        for (const std::string& row : parts(table.substr(table.find("</thead>")), "<tr", "</tr>")) {
            const auto cells = cells_of(row);
            if (row.find("scope=\"rowgroup\"") != std::string::npos) {
                group = cells.at(0).second;
                seen.clear();
                continue;
            }
            std::string name = group.empty() ? cells.at(0).second : group + " / " + cells.at(0).second;
            if (const int n = ++seen[name]; n > 1) name += " #" + std::to_string(n);
            for (std::size_t c = 0; c < cells.size(); ++c) cells_[name][headings_.at(c)] = cells[c].second;
        }
    }
    [[nodiscard]] std::string at(const std::string& row, const std::string& column) const {
        const auto r = cells_.find(row);
        if (r == cells_.end()) return "no row " + row;
        const auto c = r->second.find(column);
        return c == r->second.end() ? "no column " + column : c->second;
    }

private:
    using Cell = std::pair<std::string, std::string>;  ///< tag, text

    static std::vector<std::string> parts(const std::string& html, const std::string& begin, const std::string& end) {
        std::vector<std::string> all;
        for (std::size_t at = html.find(begin); at != std::string::npos; at = html.find(begin, at + 1))
            all.push_back(html.substr(at, html.find(end, at) - at));
        return all;
    }
    static std::vector<Cell> cells_of(const std::string& row) {
        std::vector<Cell> cells;
        std::size_t at = 0;
        while ((at = row.find("<t", at)) != std::string::npos) {
            const std::string kind = row.substr(at + 1, 2);
            if (kind == "td" || kind == "th") {
                const std::size_t end = row.find("</" + kind, at);
                const std::string tag = row.substr(at, row.find('>', at) - at);
                cells.emplace_back(tag, plain(row.substr(at, end - at)));
            }
            at += 2;
        }
        return cells;
    }
    /// Spans over columns and rows are taken apart, so that each column has all of its headings.
    void read_headings(const std::string& head) {
        std::map<std::pair<std::size_t, std::size_t>, std::string> grid;  // row, column
        std::size_t r = 0;
        for (const std::string& row : parts(head, "<tr", "</tr>")) {
            std::size_t c = 0;
            for (const auto& [tag, text] : cells_of(row)) {
                while (grid.contains({r, c})) ++c;
                const std::size_t across = number_in(tag, "colspan", 1), down = number_in(tag, "rowspan", 1);
                for (std::size_t dc = 0; dc < across; ++dc)
                    for (std::size_t dr = 0; dr < down; ++dr) grid[{r + dr, c + dc}] = dr == 0 ? text : "";
                c += across;
            }
            ++r;
        }
        for (const auto& [place, text] : grid) {
            if (headings_.size() <= place.second) headings_.resize(place.second + 1);
            std::string& heading = headings_[place.second];
            if (!text.empty()) heading += (heading.empty() ? "" : " / ") + text;
        }
    }

    std::vector<std::string> headings_;
    std::map<std::string, std::map<std::string, std::string>> cells_;
};

}  // namespace umbra::other_readers
