// tree_trace: lets each live ray visit nodes of the tree, to its nearest hit.
//
// reads   the ray state, polynomials
//         nodes
//         live_rays        those that live, where few of a wave do
// writes  the ray state    in place
//         live             how many rays have not ended yet
//         marks            one bit for each of these, by its place in the list; must be zero before
// runs    one invocation per ray of the wave; dispatched until no ray lives
// twin    none: hits are those of any structure (crates/reference/src/grid_trace.rs)
//
// LEAVING as in structure.glsl.
#version 460
#extension GL_GOOGLE_include_directive : require
#define QUEUE
#define TEXELS
#define STATE_READS
#define STATE_WRITES
#include "stages/points.glsl"
#include "stages/tree.glsl"
#include "stages/rays.glsl"
#include "math.glsl"
#include "scene.glsl"
#include "tree_walk.glsl"
#include "structure.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(push_constant) uniform Push { TreeTraceParams params; };

void main() {
    uint place = list_index();
    if (place >= params.wave.ray_count) return;
    uint index = ray_at(place, params.wave.listed);
    Ray ray = load_ray(index);
    TreePlace at = before_root();
    if (ray.cell != RAY_STARTS) {
        uvec2 more = kept_words(index);
        at = TreePlace(ray.cell, uvec2(ray.cursor, more.x), more.y);
    }
    bool alive = walk_tree(ray, at, params.tree, params.wave.work, params.wave.any_hit != 0u, params.wave.passed);
    state_out[index].position.w = floatBitsToUint(ray.hit_t);
    state_out[index].direction.w = ray.cells;
    state_out[index].cell = uvec4(alive ? at.node : NONE, at.pending.x, ray.tests, ray.hit_slot);
    if (alive) {
        keep_words(index, uvec2(at.pending.y, at.backwards));
        count_live(place);
    }
}
