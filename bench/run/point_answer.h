// Why a method answers as it does at one point, as a record and in words.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "umbra/bench/record/record.h"
#include "umbra/bench/run/at_work.h"

namespace umbra {

struct TriangleRecord {
    TriangleId triangle = kNoTriangle;
    std::string object{};
};
template <class Fields>
void describe(Fields& of, Is<TriangleRecord>) {
    of("triangle", &TriangleRecord::triangle, "");
    of("object", &TriangleRecord::object, "");
}

struct EvidenceRecord {
    std::string name{};
    Scalar value{};
    std::string unit{};
};
template <class Fields>
void describe(Fields& of, Is<EvidenceRecord>) {
    of("name", &EvidenceRecord::name, "");
    of("value", &EvidenceRecord::value, "");
    of.may("unit", &EvidenceRecord::unit, "");
}

/// A method's answer and its reason.
struct AnswerRecord {
    std::string method{}, not_served{}, failed{};
    std::optional<float> visibility{};
    std::string verdict{};
    std::optional<TriangleRecord> blocker{};
    std::optional<double> at{};
    std::vector<double> towards{};
    std::optional<double> margin{};
    std::string unit{};
    std::vector<EvidenceRecord> evidence{};
    std::vector<std::vector<double>> texel{}, samples{}, silhouette{};
    std::string difference{};
    bool answered = false;

    /// The number of that name; nothing where there is none.
    [[nodiscard]] std::optional<double> number(std::string_view name) const;
};
template <class Fields>
void describe(Fields& of, Is<AnswerRecord>) {
    of("method", &AnswerRecord::method, "");
    of.may("not_served", &AnswerRecord::not_served, "why it does not serve the scene");
    of.may("visibility", &AnswerRecord::visibility, "S");
    of.where(&AnswerRecord::answered, "verdict", &AnswerRecord::verdict, "");
    of.where(&AnswerRecord::answered, "blocker", &AnswerRecord::blocker, "the triangle that blocks");
    of.where(&AnswerRecord::answered, "at", &AnswerRecord::at, "where it does, from 0 at the point to 1 at the light");
    of.where(&AnswerRecord::answered, "towards", &AnswerRecord::towards, "the place that the segment goes to");
    of.where(&AnswerRecord::answered, "margin", &AnswerRecord::margin, "how far the answer is from being another");
    of.where(&AnswerRecord::answered, "unit", &AnswerRecord::unit, "of the margin");
    of.where(&AnswerRecord::answered, "evidence", &AnswerRecord::evidence, "");
    of.may("texel", &AnswerRecord::texel, "corners of the map's texel on the plane of the point, world space");
    of.may("samples", &AnswerRecord::samples,
           "of an area light: x, y, z in world space, and 1 where the point sees it");
    of.may("silhouette", &AnswerRecord::silhouette,
           "edges that extrude the sides of the blocker's volumes: two positions, world space");
    of.may("difference", &AnswerRecord::difference, "from the truth, in words");
    of.may("failed", &AnswerRecord::failed, "the message of what it threw");
}

[[nodiscard]] TriangleRecord triangle_record(const Scene& scene, TriangleId t);

/// The answer of one method, which serves the scene, at point i of a picture, and its reason; what it throws is the
/// record's `failed`. Phases that have not run do so first. Drops what the method looks at.
[[nodiscard]] AnswerRecord answer_record(MethodAtWork& work, const PointBatch& picture, std::size_t i, LightId light);

/// Why no method is asked for the light at point i, which has a surface, a sentence; empty where methods are.
[[nodiscard]] std::string decided_in_words(const Scene& scene, const PointBatch& points, LightId light, std::size_t i);

/// The truth's answer at point i and this light: what is in the way, and how far that is from the point and the light.
[[nodiscard]] std::string truth_in_words(const AnswerRecord& truth, const Scene& scene, const PointBatch& points,
                                         std::size_t i, LightId light);

/// Sets `difference` of the method's answer where the truth's is another: a few sentences from the first difference of
/// their evidence, at point i and this light.
void add_difference(AnswerRecord& method, const AnswerRecord& truth, const Scene& scene, const PointBatch& points,
                    std::size_t i, LightId light);

/// "umbra, S 0; triangle 3 of box blocks at 0.4 of the way to the light; ..."
[[nodiscard]] std::string sentence(const AnswerRecord& answer);

}  // namespace umbra
