// camera_trace: camera_rays, disc_trace or with TREE tree_trace, surface_hit and classify in one, for rays from the
// eye through the centres of pixels that nothing but surfaces meets (section 4 of the paper).
//
// reads   polynomials, objects, the lists of screen tiles; with TREE nodes
//         grid, cells, slots   the polynomials around a hit, where normals are blended
//         images, texels   the environment
// writes  film             every pixel
//         lit, lit_hits    as classify does, as are the next
//         scattering, next_marks
//         the ray state, hits   of rays that scatter
//         live             how many rays would need more work than they may spend: then nothing else counts, and
//                          the tile is traced pass by pass
// runs    one invocation per pixel of the tile
// twin    none of its own: it is camera_rays, disc_trace or tree_trace, surface_hit and classify in one
//
// A workgroup is one screen tile. A ray travels in registers from the eye to its pixel: no state is stored.
#version 460
#extension GL_GOOGLE_include_directive : require
#ifndef TREE
#extension GL_KHR_shader_subgroup_ballot : require
#define PACKETS
#endif
#define QUEUE // the ray state, and
#define TEXELS // lists as texels
#define STATE_WRITES
#include "stages/points.glsl"
#include "stages/scene.glsl"
#include "stages/discs.glsl"
#include "stages/rays.glsl"
#include "stages/wave.glsl"
#include "stages/film.glsl"
#ifdef TREE
#include "tree_walk.glsl"
#else
#include "disc_walk.glsl"
#endif
#include "direction.glsl"
#include "environment.glsl"
#include "index.glsl"
#include "objects.glsl"

layout(local_size_x = TILE_GROUP) in;
layout(std430, binding = LIVE) buffer Live { uint live; };
layout(std430, binding = FILM) buffer Film { FilmPixel film[]; };
layout(std430, binding = LIT_HITS) writeonly buffer LitHits { LitHit lit_hits[]; };
layout(std430, binding = HITS) writeonly buffer Hits { Hit hits[]; };
layout(push_constant) uniform Push { CameraTraceParams params; };

// Rays from the camera start outside everything here.
uint media_word(uint ray, uint word) {
    return 0u;
}
#include "camera.glsl"
#include "film.glsl"
#include "marks.glsl"
#include "way.glsl"
#include "material.glsl"
#include "meeting.glsl"

#ifdef PACKETS
#define PACKET_MARGIN 0.03125 // of a pixel: its place is rounded by less than a hundredth of one

// The packet of 4 x 2 pixels whose first that is.
Packet packet_from(uvec2 pixel) {
    vec2 first = place_in_view(params.tile_origin + pixel, vec2(-PACKET_MARGIN));
    vec2 last = place_in_view(params.tile_origin + pixel, vec2(3.0, 1.0) + PACKET_MARGIN);
    return Packet(normalize3(params.right - first.x * params.forward), normalize3(last.x * params.forward - params.right),
                  normalize3(params.up - last.y * params.forward), normalize3(first.y * params.forward - params.up));
}
#endif

void main() {
    uvec2 groups = (params.tile_size + 7u) / 8u;
    uvec2 group = uvec2(gl_WorkGroupID.x, spread(gl_WorkGroupID.y, groups.y));
    uint within = gl_LocalInvocationID.x;
    uvec2 pixel = group * 8u + pixel_within(within);
    uint at = (group.y * groups.x + group.x) * uint(TILE_GROUP) + within;
    bool outside = any(greaterThanEqual(pixel, params.tile_size));
    vec3 d = camera_direction(place_in_view(params.tile_origin + pixel, vec2(0.0)));
    Ray ray = new_ray(params.eye, d, NONE);
    ray.cell = outside ? NONE : ray.cell;
#ifdef TREE
    TreePlace place = before_root();
    bool alive = walk_tree(ray, place, params.tree, params.work, false, NONE);
#else
    begin_discs(ray);
    uvec2 tile = pixel / uint(DISC_TILE);
    Packet packet = packet_from(group * 8u + pixel_within(within & ~(PACKET - 1u)));
    walk_discs(ray, disc_range_at(tile.y * screen_tiles(params.tile_size).x + tile.x), params.ranks, params.work, packet);
    bool alive = ray.cell != NONE;
#endif
    if (alive) atomicAdd(live, 1u);
    if (outside) return;

    bool found = ray.hit_slot != NONE;
    Meeting met = Meeting(vec3(0.0), vec3(0.0), 0u, false);
    if (found) met = meeting_of(ray);
    Fate fate = no_fate();
    if (found) {
        uint way = way_through_point(ray.hit_slot, ray.origin, ray.direction, ray.hit_t);
        fate = fate_at(met.object, Media(0u, 0u), way, uint(CHANNELS_ALL));
    }
    bool is_lit = fate.lit && scene_has(SCENE_LIGHTS);
    if (scene_has(SCENE_LIGHTS) && scene_has(SCENE_LIT)) {
        if (is_lit) {
            lit_hits[at].position = met.position;
            lit_hits[at].slot = ray.hit_slot;
            lit_hits[at].normal = met.normal;
            if (scene_has(SCENE_GLOSSY)) lit_hits[at].view = packed_direction(d);
            mark_lit(at);
        }
    }
    if (scene_has(SCENE_SCATTERS)) {
        if (fate.sends) {
            mark_scattering(at, rays_on(fate, 0u, 0u, params.max_bounces));
            store_ray(at, ray);
            hits[at].position = met.position;
            hits[at].normal = met.normal;
        }
    }
    vec3 background = params.transparent != 0u ? vec3(0.0) : seen_at(params.background, d);
    vec3 behind = found ? vec3(0.0) : vec3(0.0) + background;
    write_first(pixel.y * params.tile_size.x + pixel.x, vec4(behind, found ? 1.0 : 0.0), !is_lit, found,
                vec4(met.position, ray.hit_t * dot3(d, params.forward)),
                vec4(met.normal, found ? float(met.object) : -1.0), uvec4(ray.tests, ray.cells, ray.hit_slot, 0u),
                vec3(found ? 1.0 : 0.0));
}
