// tree: boxes in boxes around the surfaces of points, eight in each, in the order of memory.
//
// Points lie along a Hilbert curve, so eight consecutive ones are a leaf, eight leaves a node, and so on: a tree
// without a search. Node 0 is the root, the children of node i are 8 i to 8 i + 7, of which some are not there;
// leaves are the nodes from a power of eight on, in memory right behind the others, and the children of the first
// are slots 0 to 7. A node has the boxes around its children, of 8 bits a side of its own frame (after Ylitie,
// Karras, Laine, Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs, 2017):
//   words 0 - 2    where the frame begins
//   word  3        bits 0 - 7 exponent of a step, 8 - 15 which children are there, 16 - 30 from the first of
//                  them to the last, 5 bits an axis
//   words 4 - 9    of the first four children, a byte each: lowest x, y, z, highest x, y, z
//   words 10 - 15  the same of the others
#ifndef TREE_GLSL
#define TREE_GLSL
#include "stages/points.glsl"
#include "math.glsl"

#define TREE_STEPS 255.0

// The box around the surface of a point's polynomial: |m y - D| <= |M| b^2 in its trust ball, so that with a normal n
// of unit length it lies in a slab of that ball.
void patch_box(Polynomial p, out vec3 low, out vec3 high) {
    vec4 center_trust = p.center_trust, gradient_offset = p.gradient_offset, curvature = p.curvature;
    vec2 cross_terms = p.cross_terms;
    float b = center_trust.w * 1.001;
    float steepness = sqrt(dot3(gradient_offset.xyz, gradient_offset.xyz));
    float bend = sqrt(dot3(curvature.xyz, curvature.xyz)
        + 2.0 * (curvature.w * curvature.w + dot(cross_terms, cross_terms)));
    float inverse = 1.0 / max(steepness, 1e-30);
    vec3 n = gradient_offset.xyz * inverse;
    float offset = gradient_offset.w * inverse;
    float thickness = bend * b * b * inverse + 0.001 * b;
    vec3 across = sqrt(max(vec3(1.0) - n * n, vec3(0.0)));
    vec3 reach = b * across + thickness * abs(n);
    bool known = steepness > 1e-20 && abs(offset) < 1e30 && thickness < 1e30; // else the ball's
    vec3 rounding = 2.5e-7 * abs(center_trust.xyz);
    low = (center_trust.xyz + (known ? max(n * offset - reach, vec3(-b)) : vec3(-b))) - rounding;
    high = (center_trust.xyz + (known ? min(n * offset + reach, vec3(b)) : vec3(b))) + rounding;
}
#endif
