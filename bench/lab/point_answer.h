// Why a method answers as it does at one point, as a record and in words.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "umbra/bench/base/record.h"
#include "umbra/bench/lab/at_work.h"

namespace umbra {

struct TriangleRecord {
    TriangleId triangle = kNoTriangle;
    std::string object{};
};
DESCRIBE(TriangleRecord) { MEMBERS(triangle, object); }

struct EvidenceRecord {
    std::string name{};
    Scalar value{};
    std::string unit{};
};
DESCRIBE(EvidenceRecord) {
    MEMBERS(name, value);
    of.may(MEMBER(unit));
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
DESCRIBE(AnswerRecord) {
    MEMBERS(method);
    of.may(MEMBER(not_served), "why it does not serve the scene");
    of.may(MEMBER(visibility), "S");
    of.where(&R::answered, MEMBER(verdict));
    of.where(&R::answered, MEMBER(blocker), "the triangle that blocks");
    of.where(&R::answered, MEMBER(at), "where it does, from 0 at the point to 1 at the light");
    of.where(&R::answered, MEMBER(towards), "the place that the segment goes to");
    of.where(&R::answered, MEMBER(margin), "how far the answer is from being another");
    of.where(&R::answered, MEMBER(unit), "of the margin");
    of.where(&R::answered, MEMBER(evidence));
    of.may(MEMBER(texel), "corners of the map's texel on the plane of the point, world space");
    of.may(MEMBER(samples), "of an area light: x, y, z in world space, and 1 where the point sees it");
    of.may(MEMBER(silhouette), "edges that extrude the sides of the blocker's volumes: two positions, world space");
    of.may(MEMBER(difference), "from the truth, in words");
    of.may(MEMBER(failed), "the message of what it threw");
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
