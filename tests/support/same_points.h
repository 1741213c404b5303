// Whether two batches hold the same points, to the last bit.
#pragma once

#include <gtest/gtest.h>

#include "umbra/core/render/points.h"

namespace umbra {

inline void expect_same(const PointBatch& a, const PointBatch& b) {
    ASSERT_EQ(a.size(), b.size());
    EXPECT_EQ(a.triangle, b.triangle);
    EXPECT_EQ(a.u, b.u);
    EXPECT_EQ(a.v, b.v);
    EXPECT_EQ(a.px, b.px);
    EXPECT_EQ(a.py, b.py);
    EXPECT_EQ(a.pz, b.pz);
    EXPECT_EQ(a.nx, b.nx);
    EXPECT_EQ(a.ny, b.ny);
    EXPECT_EQ(a.nz, b.nz);
    EXPECT_EQ(a.flipped, b.flipped);
    ASSERT_EQ(a.facing.size(), b.facing.size());
    for (std::size_t j = 0; j < a.facing.size(); ++j) EXPECT_EQ(a.facing[j], b.facing[j]) << "light " << j;
}

}  // namespace umbra
