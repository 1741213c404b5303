// Records: what a description of members writes, reads and says in its schema.
#include "umbra/bench/base/record.h"

#include <gtest/gtest.h>

#include "umbra/core/base/error.h"
#include "umbra/tests/support/json_schema.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

struct Span {
    double from = kUnknown, to = kUnknown;
};
DESCRIBE(Span) {
    of.name("span", "both ends belong to it");
    MEMBERS(from, to);
}

struct Row {
    std::string name, kind;
    std::optional<std::string> note;
    std::uint64_t points = 0;
    std::vector<Span> spans;
    Members<Scalar> parameters;
    std::optional<Span> whole;
    bool cut = false;
    Json rest;
};
DESCRIBE(Row) {
    of.must(MEMBER(name), "as typed");
    of(MEMBER(kind), "", one_of({"hard", "soft"}));
    MEMBERS(note);
    of(MEMBER(points), "compared", at_least(2));
    MEMBERS(spans, parameters, whole);
    of.may(MEMBER(cut), "there where it is true");
    of.may(MEMBER(rest));
}

struct Table {
    int schema = kResultsSchema;
    Row row;
};
DESCRIBE(Table) {
    MEMBERS(schema);
    of.all(&R::row);
}

struct Reply {
    bool given = false;
    std::optional<double> value{};
    std::vector<double> at{};
    bool cut = false;
};
DESCRIBE(Reply) {
    of.where(&R::given, MEMBER(value));
    of.may(MEMBER(at), "", kThreeNumbers);
    of.may(MEMBER(cut), "", only(true));
}

Row a_row() {
    Row row{"a", "hard", {}, 7, {{1, 2}, {3, kUnknown}}, {}, Span{0, 0.5}, false, {}};
    row.parameters("size") = std::int64_t(3);
    row.parameters("mode") = std::string("pcf");
    row.parameters("bias") = 0.25;
    row.parameters("on")   = true;
    return row;
}

constexpr const char* kRow = R"({"name":"a","kind":"hard","note":null,"points":7,"spans":[{"from":1.0,"to":2.0},)"
                             R"({"from":3.0,"to":null}],"parameters":{"size":3,"mode":"pcf","bias":0.25,"on":true},)"
                             R"("whole":{"from":0.0,"to":0.5}})";

/// What a file with this text is read as.
template <class T>
T read_text(const std::string& text) {
    const TemporaryFolder folder;
    return from_record<T>(read_results(folder.write("r.json", text)));
}

std::string message_of(const std::string& text) {
    try {
        (void)read_text<Table>(text);
    } catch (const InputError& error) {
        const std::string message = error.what();
        return message.substr(message.find("r.json"));
    }
    return "read";
}

TEST(Record, WritesItsMembersInTheirOrder) { EXPECT_EQ(to_record(a_row()).dump(), kRow); }

TEST(Record, ReadsWhatItWrote) {
    Table table{kResultsSchema, a_row()};
    table.row.cut          = true;
    table.row.rest         = {1, "x"};
    table.row.note         = "n";
    const std::string text = to_record(table).dump();
    EXPECT_EQ(to_record(read_text<Table>(text)).dump(), text);
}

TEST(Record, WhatIsNotThereIsReadAsNothing) {
    const Table table = read_text<Table>(R"({"schema":2,"name":"b","whole":{}})");
    EXPECT_EQ(table.row.name, "b");
    EXPECT_EQ(table.row.points, 0u);
    EXPECT_FALSE(table.row.note.has_value());
    ASSERT_TRUE(table.row.whole.has_value());
    EXPECT_TRUE(std::isnan(table.row.whole->from));
}

TEST(Record, WrongTypesAreRefusedWithTheirPlace) {
    EXPECT_EQ(message_of(R"({"schema":2,"kind":"hard"})"), "r.json:/name: found nothing, expected a non-empty string");
    EXPECT_EQ(message_of(R"({"schema":2,"name":"b","kind":"hazy"})"),
              "r.json:/kind: found \"hazy\", expected \"hard\" or \"soft\"");
    EXPECT_EQ(message_of(R"({"schema":2,"name":"b","points":2.5})"),
              "r.json:/points: found 2.5, expected a whole number, 0 or more");
    EXPECT_EQ(message_of(R"({"schema":2,"name":"b","points":1})"), "r.json:/points: found 1, expected at least 2");
    EXPECT_EQ(message_of(R"({"schema":2,"name":"b","points":-3})"), "r.json:/points: found -3, expected at least 2");
    EXPECT_EQ(message_of(R"({"schema":2,"name":"b","spans":[{},{"to":"x"}]})"),
              "r.json:/spans/1/to: found \"x\", expected a number");
    EXPECT_EQ(message_of(R"({"schema":2,"name":"b","whole":3})"), "r.json:/whole: found 3, expected an object");
    EXPECT_EQ(message_of(R"({"schema":2,"name":"b","parameters":{"p":[]}})"),
              "r.json:/parameters/p: found an array, expected a string, a number, true or false");
}

TEST(Record, MembersThatDependOnAFlagMayBeNull) {
    EXPECT_EQ(to_record(Reply{}).dump(), "{}");
    EXPECT_EQ(to_record(Reply{.given = true}).dump(), R"({"value":null})");
    for (const char* text : {R"({"schema":2})", R"({"schema":2,"value":null})", R"({"schema":2,"value":1.5})"}) {
        const Reply reply = read_text<Reply>(text);
        EXPECT_EQ(reply.given, std::string_view(text).find("value") != std::string_view::npos) << text;
        EXPECT_EQ(reply.value.has_value(), std::string_view(text).find("1.5") != std::string_view::npos) << text;
    }
}

TEST(Record, OneValueAndSoManyItems) {
    const Json schema = schema_of<Reply>("replies");
    for (const auto& [text, right] : {std::pair{R"({"at":[1,2,3],"cut":true})", true},
                                      {R"({"at":[1,2]})", false},
                                      {R"({"at":[1,2,3,4]})", false},
                                      {R"({"cut":false})", false}}) {
        EXPECT_EQ(bool(fits(schema.dump(), text)), right) << text;
        std::string with_schema = text;
        with_schema.insert(1, "\"schema\":2,");
        if (right)
            EXPECT_EQ(read_text<Reply>(with_schema).at.size(), 3u);
        else
            EXPECT_THROW((void)read_text<Reply>(with_schema), InputError) << text;
    }
}

TEST(Record, ItsSchemaDescribesWhatItWrites) {
    const Json schema      = schema_of<Table>("rows");
    const auto valid       = [&](const std::string& text) { return fits(schema.dump(), text); };
    const std::string good = to_record(Table{kResultsSchema, a_row()}).dump();
    EXPECT_TRUE(valid(good));
    EXPECT_EQ(schema["definitions"]["span"]["description"], "both ends belong to it");
    EXPECT_EQ(schema["properties"]["name"]["description"], "as typed");
    const auto changed = [&](const std::string& from, const std::string& to) {
        std::string text = good;
        return text.replace(text.find(from), from.size(), to);
    };
    EXPECT_FALSE(valid(changed("\"hard\"", "\"hazy\"")));
    EXPECT_FALSE(valid(changed("\"points\":7", "\"points\":1")));
    EXPECT_FALSE(valid(changed("\"points\":7", "\"pints\":7")));
    EXPECT_FALSE(valid(changed("\"points\":7,", "")));
    EXPECT_FALSE(valid(changed("\"name\":\"a\"", "\"name\":\"\"")));
    EXPECT_FALSE(valid(changed("\"to\":2.0", "\"to\":\"2\"")));
}

}  // namespace
}  // namespace umbra
