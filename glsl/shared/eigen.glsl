// eigen: eigenvectors of a symmetric 3 x 3 matrix by cyclic Jacobi rotations.
//
// twin  crates/reference/src/eigen.rs
#ifndef EIGEN_GLSL
#define EIGEN_GLSL
#include "math.glsl"

#define JACOBI_SWEEPS 8

// One rotation that zeroes apq. r is the third axis; vp and vq are columns of the eigenvectors.
// An entry that is nothing beside the diagonal is left alone: rotating by it would only breed
// denormals, which drivers treat differently. Returns whether it turned.
bool jacobi_rotate(inout float app, inout float aqq, inout float apq, inout float apr,
                   inout float aqr, inout vec3 vp, inout vec3 vq) {
    bool turn = abs(apq) > 1e-12 * (abs(app) + abs(aqq));
    float theta = (aqq - app) / (2.0 * (turn ? apq : 1.0));
    float magnitude = 1.0 / (abs(theta) + sqrt(theta * theta + 1.0));
    float t = turn ? (theta < 0.0 ? -magnitude : magnitude) : 0.0;
    float c = 1.0 / sqrt(t * t + 1.0);
    float s = t * c;
    app = app - t * apq;
    aqq = aqq + t * apq;
    apq = turn ? 0.0 : apq;
    float pr = c * apr - s * aqr;
    aqr = s * apr + c * aqr;
    apr = pr;
    vec3 p = vp * c - vq * s;
    vq = vp * s + vq * c;
    vp = p;
    return turn;
}

// Eigenvalues, ascending (ties keep the order x, y, z), and the eigenvector of the smallest and
// of the largest. The matrix is given by its diagonal and by (xy, xz, yz).
void eigen_symmetric(vec3 diagonal, vec3 off, out vec3 values, out vec3 smallest, out vec3 largest) {
    float xx = diagonal.x, yy = diagonal.y, zz = diagonal.z;
    float xy = off.x, xz = off.y, yz = off.z;
    vec3 vx = vec3(1.0, 0.0, 0.0), vy = vec3(0.0, 1.0, 0.0), vz = vec3(0.0, 0.0, 1.0);
    // Once nothing turns, nothing will.
    bool turns = true;
    for (int sweep = 0; turns && sweep < JACOBI_SWEEPS; ++sweep) {
        bool turns_xy = jacobi_rotate(xx, yy, xy, xz, yz, vx, vy);
        bool turns_xz = jacobi_rotate(xx, zz, xz, xy, yz, vx, vz);
        bool turns_yz = jacobi_rotate(yy, zz, yz, xy, xz, vy, vz);
        turns = turns_xy || turns_xz || turns_yz;
    }
    bool y_first = yy < xx;
    float low = y_first ? yy : xx, high = y_first ? xx : yy;
    vec3 v_low = y_first ? vy : vx, v_high = y_first ? vx : vy;
    bool z_lowest = zz < low, z_highest = zz >= high;
    smallest = z_lowest ? vz : v_low;
    largest = z_highest ? vz : v_high;
    values = vec3(z_lowest ? zz : low, z_lowest ? low : (z_highest ? high : zz),
                  z_highest ? zz : high);
}
#endif
