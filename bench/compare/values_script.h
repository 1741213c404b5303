// values.js: S_j and classes of a comparison, for pages that are opened from disk and cannot read pictures back.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "umbra/bench/lab/outcome.h"
#include "umbra/bench/lab/results.h"

namespace umbra {

/// A script that calls umbraValues({schema, width, height, lights, classes, columns, faces, objects}). A plane is a PNG
/// as a data: URL, of one light: red is S_j, rounded to 1/255, green the index in `classes`, blue 255 where the method
/// answers. `faces` is one whose colours are triangle + 1 in 24 bits, 0 where there is no surface; `objects` are pairs
/// of name and number of triangles, in the order of the triangles.
class ValuesScript {
public:
    /// The column of a reference. `scene` and `points` must outlive this object.
    ValuesScript(const Scene& scene, const PointBatch& points, const MethodRun& reference);

    /// A method's column. `who` is its label on pages, `explained` is one a light. Where the method was compared with
    /// another reference than the main one, `truth` is that one's run, and stands in a column of its own.
    void add(const std::string& who, const MethodRun& run, std::span<const Explained> explained,
             const MethodRun* truth);

    /// Takes a method's column away, which has failed since; nothing where there is none.
    void remove(const std::string& who);

    [[nodiscard]] std::string text() const;

private:
    struct Column {
        std::string who, truth;
        std::vector<std::string> planes;
    };
    [[nodiscard]] std::vector<std::string> planes_of(const MethodRun& run, std::span<const Explained> explained) const;

    const Scene& scene_;
    const PointBatch& points_;
    std::vector<Column> columns_;
};

}  // namespace umbra
