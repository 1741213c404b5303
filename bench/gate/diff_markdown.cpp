#include "umbra/bench/gate/diff_views.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "umbra/bench/gate/diff_record.h"
#include "umbra/bench/pages/report_text.h"

namespace umbra {
namespace {

constexpr std::size_t kLongestCell = 400;  ///< bytes before escaping: one reason is longer, twenty are not read

/// Text for a cell of a table, in which nothing is markup.
std::string cell_text(std::string text) {
    if (text.size() > kLongestCell) {
        std::size_t end = kLongestCell;
        while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) --end;  // whole characters
        text = text.substr(0, end) + "...";
    }
    std::string escaped;
    const std::string markup = xml_text(text);
    const auto is_letter     = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; };
    for (std::size_t i = 0; i < markup.size(); ++i) {
        const bool in_word =
            markup[i] == '_' && i > 0 && i + 1 < markup.size() && is_letter(markup[i - 1]) && is_letter(markup[i + 1]);
        if (!in_word && std::string_view("|\\`*_[]~@$").find(markup[i]) != std::string_view::npos)
            escaped += fmt::format("&#{};", int(markup[i]));
        else
            escaped += markup[i];
    }
    return escaped;
}

std::string table_row(const DiffResult& image) {
    const bool measured = image.comparable();
    const auto figure   = [&](double value) { return measured ? score(value) : kNone; };
    std::string why     = fmt::format("{}", fmt::join(image.reasons, "; "));
    if (const std::string by = needed_concessions(image.rules); !by.empty()) why += (why.empty() ? "" : "; ") + by;
    const bool fine = image.verdict <= Verdict::close;
    return fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} | {} |\n", cell_text(image.name),
                       fine ? std::string(to_string(image.verdict)) : fmt::format("**{}**", to_string(image.verdict)),
                       figure(image.error.max), figure(image.error.rmse), figure(image.flip.mean),
                       measured ? fmt::format("{:.4f}", image.ssim) : kNone,
                       measured ? count(double(image.error.over)) : kNone, cell_text(worst_pixel(image)),
                       cell_text(why));
}

/// Adds each text while it and what stands behind fit; returns how many did not.
std::size_t add_while_short(std::string& to, const std::vector<std::string>& texts, std::size_t longest) {
    std::size_t added = 0;
    for (const std::string& text : texts) {
        if (to.size() + text.size() > longest) break;
        to += text;
        ++added;
    }
    return texts.size() - added;
}

/// A fence that no run of backticks in the text ends.
std::string fence_for(const std::vector<std::string>& lines) {
    std::size_t longest = 2;
    for (const std::string& line : lines) {
        std::size_t run = 0;
        for (const char c : line) longest = std::max(longest, run = c == '`' ? run + 1 : 0);
    }
    return std::string(longest + 1, '`');
}

}  // namespace

std::string diff_set_markdown(const DiffSet& set, std::size_t longest) {
    const std::size_t same = set.count(Verdict::same), bad = set.images.size() - same - set.count(Verdict::close);
    std::string text = bad > 0 ? fmt::format("### {} of {} image{} differ{}\n\n", bad, set.images.size(),
                                             set.images.size() == 1 ? "" : "s", bad == 1 ? "s" : "")
                               : fmt::format("### No image of {} differs\n\n", set.images.size());
    std::vector<const DiffResult*> shown;
    for (const DiffResult& image : set.images)
        if (image.verdict != Verdict::same) shown.push_back(&image);
    std::stable_sort(shown.begin(), shown.end(),
                     [](const DiffResult* p, const DiffResult* q) { return p->verdict > q->verdict; });
    std::vector<std::string> rows, commands;
    for (const DiffResult* image : shown) {
        rows.push_back(table_row(*image));
        if (!image->accept.empty()) commands.push_back(image->accept + "\n");
    }
    const std::size_t around = std::min<std::size_t>(longest / 4, 1000);  // for heads, counts and fences
    std::size_t all_commands = 0;
    for (const std::string& command : commands) all_commands += command.size();
    const std::size_t for_commands = std::min(all_commands, longest / 3);
    if (!rows.empty()) {
        text +=
            "| image | verdict | largest difference | RMSE | FLIP | SSIM | pixels beyond | worst pixel | why |\n"
            "|---|---|--:|--:|--:|--:|--:|---|---|\n";
        if (const std::size_t left = add_while_short(text, rows, longest - std::min(longest, for_commands + around)))
            text += fmt::format("\n{} more images are not shown here.\n", left);
        text += "\n";
    }
    if (same > 0) text += fmt::format("{} the same.\n\n", same);
    if (!commands.empty()) {
        const std::string fence = fence_for(commands);
        text += fmt::format("To accept the change{}:\n\n{}sh\n", commands.size() == 1 ? "" : "s", fence);
        const std::size_t left = add_while_short(text, commands, longest - std::min(longest, around / 2));
        text += fence + "\n";
        if (left > 0) text += fmt::format("\n{} more commands: `umbra diff` prints all of them.\n", left);
    }
    return text;
}

}  // namespace umbra
