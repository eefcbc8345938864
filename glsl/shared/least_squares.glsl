// least_squares: the weighted fit of g(x, y) = A x2 + B y2 + C xy + E x + F y + D (method, section 1).
//
// twin  crates/reference/src/least_squares.rs
// Unknowns in the order A B C E F D. LDL' without pivoting. A coefficient that a kind of
// polynomial lacks has its row and column replaced by the identity's, which gives the smaller
// system's bits.
#ifndef LEAST_SQUARES_GLSL
#define LEAST_SQUARES_GLSL
#include "layout.glsl"

#define UNKNOWNS 6
#define SINGULAR_PIVOT 1e-4 // of its diagonal entry

struct NormalEquations {
    float matrix[21]; // lower triangle, row by row
    float right[6];
};

void add_sample(inout NormalEquations eq, float x, float y, float f, float weight) {
    float basis[6] = float[6](x * x, y * y, x * y, x, y, 1.0);
    int at = 0;
    for (int i = 0; i < UNKNOWNS; ++i) {
        float wi = weight * basis[i];
        for (int j = 0; j <= i; ++j) {
            eq.matrix[at] += wi * basis[j];
            ++at;
        }
        eq.right[i] += wi * f;
    }
}

bool has_coefficient(uint kind, int i) {
    return kind == FIT_FULL || i == 5 || (kind == FIT_INCOMPLETE && i < 3);
}

// Solves for the coefficients of one kind of polynomial; false where a pivot is singular.
bool solve(NormalEquations eq, uint kind, out float solution[6]) {
    float lower[21];
    float pivot[6];
    bool regular = true;
    for (int j = 0; j < UNKNOWNS; ++j) {
        int row_j = j * (j + 1) / 2;
        bool used = has_coefficient(kind, j);
        float diagonal = eq.matrix[row_j + j];
        float d = diagonal;
        for (int k = 0; k < j; ++k) d -= lower[row_j + k] * lower[row_j + k] * pivot[k];
        bool good = d > SINGULAR_PIVOT * diagonal;
        regular = regular && (good || !used);
        pivot[j] = used && good ? d : 1.0;
        for (int i = j + 1; i < UNKNOWNS; ++i) {
            int row_i = i * (i + 1) / 2;
            float a = eq.matrix[row_i + j];
            for (int k = 0; k < j; ++k) a -= lower[row_i + k] * lower[row_j + k] * pivot[k];
            lower[row_i + j] = used && has_coefficient(kind, i) ? a / pivot[j] : 0.0;
        }
    }
    for (int i = 0; i < UNKNOWNS; ++i) {
        int row_i = i * (i + 1) / 2;
        float z = has_coefficient(kind, i) ? eq.right[i] : 0.0;
        for (int k = 0; k < i; ++k) z -= lower[row_i + k] * solution[k];
        solution[i] = z;
    }
    for (int i = 0; i < UNKNOWNS; ++i) solution[i] /= pivot[i];
    for (int i = UNKNOWNS - 1; i >= 0; --i) {
        float z = solution[i];
        for (int k = i + 1; k < UNKNOWNS; ++k) z -= lower[k * (k + 1) / 2 + i] * solution[k];
        solution[i] = z;
    }
    return regular;
}
#endif
