// Whether JSON text fits a schema: RapidJSON has JSON Schema, which nlohmann-json lacks.
#pragma once

#include <gtest/gtest.h>
#include <rapidjson/document.h>
#include <rapidjson/schema.h>
#include <rapidjson/stringbuffer.h>

#include <fstream>
#include <iterator>
#include <string>

namespace umbra {

/// Success, or where the text breaks which rule of the schema.
inline testing::AssertionResult fits(const std::string& schema_text, const std::string& text) {
    rapidjson::Document schema_document, document;
    if (schema_document.Parse(schema_text.c_str()).HasParseError())
        return testing::AssertionFailure() << "the schema is not JSON";
    if (document.Parse(text.c_str()).HasParseError()) return testing::AssertionFailure() << "the text is not JSON";
    const rapidjson::SchemaDocument schema(schema_document);
    rapidjson::SchemaValidator valid(schema);
    if (document.Accept(valid)) return testing::AssertionSuccess();
    rapidjson::StringBuffer where;
    valid.GetInvalidDocumentPointer().StringifyUriFragment(where);
    return testing::AssertionFailure() << where.GetString() << ": " << valid.GetInvalidSchemaKeyword();
}

inline testing::AssertionResult fits_schema(const std::string& schema_file, const std::string& text) {
    std::ifstream in(schema_file);
    return fits({std::istreambuf_iterator<char>(in), {}}, text);
}

}  // namespace umbra
