// least_squares: the weighted fit of g(x, y) = A x2 + B y2 + C xy + E x + F y + D (method, section 1).
//
// twin  crates/reference/src/least_squares.rs
// Unknowns in the order A B C E F D. LDL' without pivoting. A coefficient that a kind of
// polynomial lacks has its row and column replaced by the identity's, which gives the smaller
// system's bits.
#ifndef LEAST_SQUARES_GLSL
#define LEAST_SQUARES_GLSL
#include "stages/points.glsl"

#define UNKNOWNS 6
#define SINGULAR_PIVOT 1e-4 // of its diagonal entry

struct NormalEquations {
    float matrix[21]; // lower triangle, row by row
    float right[6];
};

NormalEquations no_samples() {
    float zero[21] = float[21](0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
                               0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    return NormalEquations(zero, float[6](0.0, 0.0, 0.0, 0.0, 0.0, 0.0));
}

void add_sample(inout NormalEquations eq, float x, float y, float f, float weight) {
    float xx = x * x, yy = y * y, xy = x * y;
    float wxx = weight * xx, wyy = weight * yy, wxy = weight * xy, wx = weight * x, wy = weight * y;
    eq.matrix[0] += wxx * xx; eq.right[0] += wxx * f;
    eq.matrix[1] += wyy * xx; eq.matrix[2] += wyy * yy; eq.right[1] += wyy * f;
    eq.matrix[3] += wxy * xx; eq.matrix[4] += wxy * yy; eq.matrix[5] += wxy * xy;
    eq.right[2] += wxy * f;
    eq.matrix[6] += wx * xx; eq.matrix[7] += wx * yy; eq.matrix[8] += wx * xy;
    eq.matrix[9] += wx * x; eq.right[3] += wx * f;
    eq.matrix[10] += wy * xx; eq.matrix[11] += wy * yy; eq.matrix[12] += wy * xy;
    eq.matrix[13] += wy * x; eq.matrix[14] += wy * y; eq.right[4] += wy * f;
    eq.matrix[15] += weight * xx; eq.matrix[16] += weight * yy; eq.matrix[17] += weight * xy;
    eq.matrix[18] += weight * x; eq.matrix[19] += weight * y; eq.matrix[20] += weight;
    eq.right[5] += weight * f;
}

// Entry of a lower triangle that is kept row by row.
#define AT(i, j) ((i) * ((i) + 1) / 2 + (j))
#define L(i, j) lower[AT(i, j)]

// What is left of a matrix entry once the first columns are taken out of it.
#define LEFT_0(i, j) eq.matrix[AT(i, j)]
#define LEFT_1(i, j) (LEFT_0(i, j) - L(i, 0) * L(j, 0) * pivot[0])
#define LEFT_2(i, j) (LEFT_1(i, j) - L(i, 1) * L(j, 1) * pivot[1])
#define LEFT_3(i, j) (LEFT_2(i, j) - L(i, 2) * L(j, 2) * pivot[2])
#define LEFT_4(i, j) (LEFT_3(i, j) - L(i, 3) * L(j, 3) * pivot[3])
#define LEFT_5(i, j) (LEFT_4(i, j) - L(i, 4) * L(j, 4) * pivot[4])

// Which coefficients a kind of polynomial has.
#define HAS_0 is_curved
#define HAS_1 is_curved
#define HAS_2 is_curved
#define HAS_3 is_full
#define HAS_4 is_full
#define HAS_5 true

#define PIVOT(j, LEFT) { \
    float d = LEFT(j, j); \
    bool good = d > SINGULAR_PIVOT * eq.matrix[AT(j, j)], has = HAS_##j; \
    regular = regular && (good || !has); \
    pivot[j] = has && good ? d : 1.0; \
}
#define BELOW(i, j, LEFT) L(i, j) = HAS_##j && HAS_##i ? LEFT(i, j) / pivot[j] : 0.0;

// Solves for the coefficients of one kind of polynomial; false where a pivot is singular. Written
// out: an array that is indexed by a loop lives in memory, one element a lane.
bool solve(NormalEquations eq, uint kind, out float solution[6]) {
    float lower[21];
    float pivot[6];
    bool regular = true, is_full = kind == FIT_FULL, is_curved = is_full || kind == FIT_INCOMPLETE;
    PIVOT(0, LEFT_0)
    BELOW(1, 0, LEFT_0) BELOW(2, 0, LEFT_0) BELOW(3, 0, LEFT_0) BELOW(4, 0, LEFT_0) BELOW(5, 0, LEFT_0)
    PIVOT(1, LEFT_1)
    BELOW(2, 1, LEFT_1) BELOW(3, 1, LEFT_1) BELOW(4, 1, LEFT_1) BELOW(5, 1, LEFT_1)
    PIVOT(2, LEFT_2)
    BELOW(3, 2, LEFT_2) BELOW(4, 2, LEFT_2) BELOW(5, 2, LEFT_2)
    PIVOT(3, LEFT_3)
    BELOW(4, 3, LEFT_3) BELOW(5, 3, LEFT_3)
    PIVOT(4, LEFT_4)
    BELOW(5, 4, LEFT_4)
    PIVOT(5, LEFT_5)

    float z[6];
    z[0] = is_curved ? eq.right[0] : 0.0;
    z[1] = is_curved ? eq.right[1] : 0.0;
    z[2] = is_curved ? eq.right[2] : 0.0;
    z[3] = is_full ? eq.right[3] : 0.0;
    z[4] = is_full ? eq.right[4] : 0.0;
    z[5] = eq.right[5];
    z[1] = z[1] - L(1, 0) * z[0];
    z[2] = z[2] - L(2, 0) * z[0] - L(2, 1) * z[1];
    z[3] = z[3] - L(3, 0) * z[0] - L(3, 1) * z[1] - L(3, 2) * z[2];
    z[4] = z[4] - L(4, 0) * z[0] - L(4, 1) * z[1] - L(4, 2) * z[2] - L(4, 3) * z[3];
    z[5] = z[5] - L(5, 0) * z[0] - L(5, 1) * z[1] - L(5, 2) * z[2] - L(5, 3) * z[3] - L(5, 4) * z[4];

    float c5 = z[5] / pivot[5];
    float c4 = z[4] / pivot[4] - L(5, 4) * c5;
    float c3 = z[3] / pivot[3] - L(4, 3) * c4 - L(5, 3) * c5;
    float c2 = z[2] / pivot[2] - L(3, 2) * c3 - L(4, 2) * c4 - L(5, 2) * c5;
    float c1 = z[1] / pivot[1] - L(2, 1) * c2 - L(3, 1) * c3 - L(4, 1) * c4 - L(5, 1) * c5;
    float c0 = z[0] / pivot[0] - L(1, 0) * c1 - L(2, 0) * c2 - L(3, 0) * c3 - L(4, 0) * c4 - L(5, 0) * c5;
    solution = float[6](c0, c1, c2, c3, c4, c5);
    return regular;
}
#undef AT
#undef L
#undef PIVOT
#undef BELOW
#undef HAS_0
#undef HAS_1
#undef HAS_2
#undef HAS_3
#undef HAS_4
#undef HAS_5
#endif
